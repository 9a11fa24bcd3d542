#include "output/h5_driver.h"

#include <cstdlib>
#include <cstring>
#include <new>

#include "base/error.h"

namespace mortise::output::h5 {
namespace {

struct Handle {
  H5FD_t base;  // HDF5's part comes first
  Backing* backing;
  haddr_t allocated;  // end of what HDF5 has given out
};

Handle& own(H5FD_t* file) { return *reinterpret_cast<Handle*>(file); }
const Handle& own(const H5FD_t* file) { return *reinterpret_cast<const Handle*>(file); }

// No exception may pass through HDF5.
template <class F>
herr_t noted(Backing& backing, F&& work) {
  try {
    work();
    return 0;
  } catch (const std::exception& e) {
    if (backing.failure.empty()) backing.failure = e.what();
    return -1;
  }
}

hid_t driver();

H5FD_t* open_file(const char*, unsigned, hid_t access, haddr_t) {
  const void* info = H5Pget_driver_info(access);
  if (info == nullptr) return nullptr;
  auto* handle = static_cast<Handle*>(std::calloc(1, sizeof(Handle)));
  if (handle != nullptr) std::memcpy(&handle->backing, info, sizeof(Backing*));
  return reinterpret_cast<H5FD_t*>(handle);
}

herr_t close_file(H5FD_t* file) {
  std::free(file);
  return 0;
}

int compare(const H5FD_t* a, const H5FD_t* b) {
  const std::less<const Backing*> less;
  return less(own(a).backing, own(b).backing) ? -1 : less(own(b).backing, own(a).backing) ? 1 : 0;
}

herr_t query(const H5FD_t*, unsigned long* flags) {
  if (flags) *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE | H5FD_FEAT_AGGREGATE_SMALLDATA;
  return 0;
}

haddr_t allocated(const H5FD_t* file, H5FD_mem_t) { return own(file).allocated; }
herr_t allocate(H5FD_t* file, H5FD_mem_t, haddr_t end) {
  own(file).allocated = end;
  return 0;
}
haddr_t size(const H5FD_t* file, H5FD_mem_t) { return own(file).backing->file.end(); }

herr_t read_bytes(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t at, std::size_t count, void* bytes) {
  Backing& b = *own(file).backing;
  return noted(b, [&] { b.file.read(at, static_cast<char*>(bytes), count); });
}

// A failed write counts as done for HDF5; File::check_backing() tells us.
herr_t write_bytes(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t at, std::size_t count, const void* bytes) {
  Backing& b = *own(file).backing;
  if (b.failure.empty()) noted(b, [&] { b.file.write(at, static_cast<const char*>(bytes), count); });
  return 0;
}

herr_t truncate(H5FD_t* file, hid_t, hbool_t) {
  own(file).backing->file.set_end(own(file).allocated);
  return 0;
}

H5FD_class_t description() {
  H5FD_class_t c = {};
#if H5_VERSION_GE(1, 13, 2)
  c.version = H5FD_CLASS_VERSION;
  c.value = static_cast<H5FD_class_value_t>(511);  // the last number that The HDF Group leaves to everyone
#endif
  c.name = "mortise";
  c.maxaddr = (haddr_t{1} << 62) - 1;
  c.fc_degree = H5F_CLOSE_STRONG;
  c.fapl_size = sizeof(Backing*);
  c.open = open_file, c.close = close_file, c.cmp = compare, c.query = query;
  c.get_eoa = allocated, c.set_eoa = allocate, c.get_eof = size;
  c.read = read_bytes, c.write = write_bytes, c.truncate = truncate;
  const H5FD_mem_t lists[] = H5FD_FLMAP_DICHOTOMY;
  std::memcpy(c.fl_map, lists, sizeof c.fl_map);
  return c;
}

hid_t driver() {
  static const H5FD_class_t c = description();
  static const hid_t id = H5FDregister(&c);
  return id;
}

}  // namespace

herr_t use_backing(hid_t access, Backing& backing) {
  Backing* info = &backing;
  const hid_t id = driver();
  return id < 0 ? -1 : H5Pset_driver(access, id, &info);
}

}  // namespace mortise::output::h5
