#include "output/h5.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <limits>

#include "base/error.h"

namespace mortise::output::h5 {
namespace {

// HDF5 would print its error stack; we put it into the message instead. The setting is per thread.
void silence() {
  thread_local const herr_t done = H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  (void)done;
}

// The system's message if any record of the error stack has one, else the innermost record.
struct Reason {
  std::string innermost, system;
};

herr_t collect(unsigned, const H5E_error2_t* record, void* out) {
  auto& reason = *static_cast<Reason*>(out);
  const std::string text = record->desc != nullptr ? record->desc : "";
  const std::string mark = "error message = '";
  if (reason.innermost.empty()) reason.innermost = text;
  if (const auto at = text.find(mark); at != std::string::npos && reason.system.empty()) {
    const auto begin = at + mark.size();
    reason.system = text.substr(begin, text.find('\'', begin) - begin);
  }
  return 0;
}

std::string reason_of_failure() {
  Reason reason;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, collect, &reason);  // upward: innermost first
  H5Eclear2(H5E_DEFAULT);
  if (!reason.system.empty()) return reason.system;
  if (reason.innermost.find("signature not found") != std::string::npos) return "not an HDF5 file";
  return reason.innermost.empty() ? "HDF5 gives no reason" : reason.innermost;
}

Id text_type(const File& file) {
  Id type(file.check(H5Tcopy(H5T_C_S1), "make a string type"));
  H5Tset_size(type, H5T_VARIABLE);
  H5Tset_cset(type, H5T_CSET_UTF8);
  return type;
}

Id scalar_space(const File& file) { return Id(file.check(H5Screate(H5S_SCALAR), "make a dataspace")); }

}  // namespace

File::File(const std::string& path, Mode mode) : path_(path) {
  silence();
  Id access(check(H5Pcreate(H5P_FILE_ACCESS), "set up HDF5"));
  check(H5Pset_fclose_degree(access, H5F_CLOSE_STRONG), "set up HDF5");  // closing the file closes what is open in it
  if (mode != Mode::read) {
    // No chunk cache: every write reaches the operating system at once, so a full disk shows in the call that caused it.
    check(H5Pset_cache(access, 0, 1, 0, 1.0), "set up HDF5");
  }
  if (mode == Mode::create) {
    id_ = check(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access), "create");
  } else {
    id_ = check(H5Fopen(path.c_str(), mode == Mode::read ? H5F_ACC_RDONLY : H5F_ACC_RDWR, access), "open");
  }
  on_disk_ = mode != Mode::read;
  if (mode == Mode::write) flushed_ = reserved_ = size();
}

File File::in_memory(const std::string& path) {
  silence();
  File file(path, hid_t(-1));
  Id access(file.check(H5Pcreate(H5P_FILE_ACCESS), "set up HDF5"));
  file.check(H5Pset_fapl_core(access, 1 << 20, false), "set up HDF5");
  file.id_ = file.check(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access), "create");
  return file;
}

File File::from_image(const std::string& path, std::string_view bytes) {
  silence();
  File file(path, hid_t(-1));
  Id access(file.check(H5Pcreate(H5P_FILE_ACCESS), "set up HDF5"));
  file.check(H5Pset_fapl_core(access, 1 << 20, false), "set up HDF5");
  file.check(H5Pset_file_image(access, const_cast<char*>(bytes.data()), bytes.size()), "read");  // HDF5 copies
  file.id_ = file.check(H5Fopen((path + " (in memory)").c_str(), H5F_ACC_RDONLY, access), "open");
  return file;
}

std::string File::image() {
  check(H5Fflush(id_, H5F_SCOPE_GLOBAL), "write");
  const ssize_t size = check(H5Fget_file_image(id_, nullptr, 0), "write");
  std::string bytes(static_cast<std::size_t>(size), '\0');
  check(H5Fget_file_image(id_, bytes.data(), bytes.size()), "write");
  return bytes;
}

File::~File() {
  if (id_ >= 0) H5Fclose(id_);
}

int File::descriptor() const {
  void* handle = nullptr;
  check(H5Fget_vfd_handle(id_, H5P_DEFAULT, &handle), "write");
  return *static_cast<int*>(handle);
}

hsize_t File::size() const {
  hsize_t bytes = 0;
  check(H5Fget_filesize(id_, &bytes), "write");
  return bytes;
}

// HDF5 1.10 crashes when the disk fills up under its chunk writer, and a flush that fails half-way leaves metadata of data that
// are not there. So the space is taken from the file system before HDF5 is asked to write into it.
void File::reserve(hsize_t bytes) const {
  if (!on_disk_) return;
  constexpr hsize_t metadata = 64 * 1024;  // what HDF5 may write beside the data
  const hsize_t end = size() + bytes + metadata;
  if (end <= reserved_) return;
  const int reason = ::posix_fallocate(descriptor(), static_cast<off_t>(reserved_), static_cast<off_t>(end - reserved_));
  if (reason != 0 && reason != EINVAL && reason != EOPNOTSUPP) {
    throw Error(Exit::file, path_ + ": cannot write: " + std::strerror(reason));
  }
  reserved_ = end;
}

void File::flush() {
  reserve(0);
  check(H5Fflush(id_, H5F_SCOPE_GLOBAL), "write");
  flushed_ = size();
}

void File::close() {
  if (id_ < 0) return;
  flush();
  check(H5Fclose(std::exchange(id_, -1)), "close");
  // What was reserved and not used.
  if (::truncate(path_.c_str(), static_cast<off_t>(flushed_)) != 0) {
    throw Error(Exit::file, path_ + ": cannot write: " + std::strerror(errno));
  }
}

void File::abandon() noexcept {
  if (id_ < 0) return;
  void* handle = nullptr;
  if (H5Fget_vfd_handle(id_, H5P_DEFAULT, &handle) >= 0) {
    const int fd = *static_cast<int*>(handle);
    // A sparse stand-in in memory: HDF5 closes in peace and what it writes is dropped.
    if (const int sink = ::memfd_create("abandoned", MFD_CLOEXEC); sink >= 0) {
      const bool cut = ::ftruncate(fd, static_cast<off_t>(flushed_)) == 0;  // behind the last flush there is nothing of use
      (void)cut;                                                           // a file that is too long does no harm
      ::dup2(sink, fd);
      ::close(sink);
    }
  }
  H5Fclose(std::exchange(id_, -1));
  H5Eclear2(H5E_DEFAULT);
}

void File::fail(std::string_view action) const {
  throw Error(Exit::file, path_ + ": cannot " + std::string(action) + ": " + reason_of_failure());
}

Id make_group(const File& file, hid_t parent, const std::string& name) {
  return Id(file.check(H5Gcreate2(parent, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), "create group " + name));
}

Id open_group(const File& file, hid_t parent, const std::string& name) {
  return Id(file.check(H5Gopen2(parent, name.c_str(), H5P_DEFAULT), "read group " + name));
}

bool exists(const File& file, hid_t parent, const std::string& name) {
  return file.check(H5Lexists(parent, name.c_str(), H5P_DEFAULT), "look for " + name) > 0;
}

std::vector<std::string> members(const File& file, hid_t group) {
  std::vector<std::string> names;
  const auto visit = [](hid_t, const char* name, const H5L_info_t*, void* out) -> herr_t {
    static_cast<std::vector<std::string>*>(out)->emplace_back(name);
    return 0;
  };
  file.check(H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, nullptr, visit, &names), "list a group");
  return names;
}

bool is_group(const File& file, hid_t parent, const std::string& name) {
  Id object(file.check(H5Oopen(parent, name.c_str(), H5P_DEFAULT), "read " + name));
  return H5Iget_type(object) == H5I_GROUP;
}

void set_text(const File& file, hid_t object, const char* name, std::string_view value) {
  const std::string copy(value);
  const char* text = copy.c_str();
  Id type = text_type(file), space = scalar_space(file);
  Id attribute(file.check(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), std::string("write attribute ") + name));
  file.check(H5Awrite(attribute, type, &text), std::string("write attribute ") + name);
}

void set_fixed_ascii(const File& file, hid_t object, const char* name, std::string_view value) {
  Id type(file.check(H5Tcopy(H5T_C_S1), "make a string type")), space = scalar_space(file);
  H5Tset_size(type, value.size());
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  Id attribute(file.check(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), std::string("write attribute ") + name));
  file.check(H5Awrite(attribute, type, value.data()), std::string("write attribute ") + name);
}

void set_integers(const File& file, hid_t object, const char* name, std::span<const std::int64_t> values) {
  const hsize_t size = values.size();
  Id space(file.check(H5Screate_simple(1, &size, nullptr), "make a dataspace"));
  Id attribute(
      file.check(H5Acreate2(object, name, H5T_STD_I64LE, space, H5P_DEFAULT, H5P_DEFAULT), std::string("write attribute ") + name));
  file.check(H5Awrite(attribute, H5T_NATIVE_INT64, values.data()), std::string("write attribute ") + name);
}

void set_integer(const File& file, hid_t object, const char* name, std::int64_t value) {
  const std::string action = std::string("write attribute ") + name;
  Id attribute;
  if (file.check(H5Aexists(object, name), action) > 0) {
    attribute = Id(file.check(H5Aopen(object, name, H5P_DEFAULT), action));
  } else {
    Id space = scalar_space(file);
    attribute = Id(file.check(H5Acreate2(object, name, H5T_STD_I64LE, space, H5P_DEFAULT, H5P_DEFAULT), action));
  }
  file.check(H5Awrite(attribute, H5T_NATIVE_INT64, &value), action);
}

void set_number(const File& file, hid_t object, const char* name, double value) {
  const std::string action = std::string("write attribute ") + name;
  Id space = scalar_space(file);
  Id attribute(file.check(H5Acreate2(object, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT), action));
  file.check(H5Awrite(attribute, H5T_NATIVE_DOUBLE, &value), action);
}

std::string get_text(const File& file, hid_t object, const char* name) {
  const std::string action = std::string("read attribute ") + name;
  Id attribute(file.check(H5Aopen(object, name, H5P_DEFAULT), action));
  Id type = text_type(file);
  char* text = nullptr;
  file.check(H5Aread(attribute, type, &text), action);
  std::string value = text != nullptr ? text : "";
  H5free_memory(text);
  return value;
}

std::int64_t get_integer(const File& file, hid_t object, const char* name) {
  const std::string action = std::string("read attribute ") + name;
  Id attribute(file.check(H5Aopen(object, name, H5P_DEFAULT), action));
  std::int64_t value = 0;
  file.check(H5Aread(attribute, H5T_NATIVE_INT64, &value), action);
  return value;
}

std::vector<std::int64_t> get_integers(const File& file, hid_t object, const char* name) {
  const std::string action = std::string("read attribute ") + name;
  Id attribute(file.check(H5Aopen(object, name, H5P_DEFAULT), action));
  Id space(file.check(H5Aget_space(attribute), action));
  std::vector<std::int64_t> values(static_cast<std::size_t>(file.check(H5Sget_simple_extent_npoints(space), action)));
  file.check(H5Aread(attribute, H5T_NATIVE_INT64, values.data()), action);
  return values;
}

double get_number(const File& file, hid_t object, const char* name) {
  const std::string action = std::string("read attribute ") + name;
  Id attribute(file.check(H5Aopen(object, name, H5P_DEFAULT), action));
  double value = 0;
  file.check(H5Aread(attribute, H5T_NATIVE_DOUBLE, &value), action);
  return value;
}

void write_text(const File& file, hid_t parent, const char* name, std::string_view value) {
  const std::string copy(value), action = std::string("write ") + name;
  const char* text = copy.c_str();
  Id type = text_type(file), space = scalar_space(file);
  Id dataset(file.check(H5Dcreate2(parent, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), action));
  file.check(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, &text), action);
  set_text(file, dataset, "unit", "1");
}

std::string read_text(const File& file, hid_t parent, const char* name) {
  const std::string action = std::string("read ") + name;
  Id dataset(file.check(H5Dopen2(parent, name, H5P_DEFAULT), action));
  Id type = text_type(file);
  char* text = nullptr;
  file.check(H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, &text), action);
  std::string value = text != nullptr ? text : "";
  H5free_memory(text);
  return value;
}

Table Table::create(const File& file, hid_t parent, const std::string& name, const Spec& spec) {
  const std::string action = "create " + name;
  Table table;
  table.name_ = name;
  table.components_ = spec.components;
  table.rank_ = spec.components > 1 || spec.column ? 2 : 1;
  table.single_ = H5Tequal(spec.type, H5T_IEEE_F32LE) > 0;
  const hsize_t columns = static_cast<hsize_t>(spec.components);
  const hsize_t size[2] = {0, columns}, limit[2] = {H5S_UNLIMITED, columns};
  const hsize_t chunk[2] = {spec.chunk_rows > 0 ? spec.chunk_rows : 1, columns};
  Id space(file.check(H5Screate_simple(table.rank_, size, limit), action));
  Id layout(file.check(H5Pcreate(H5P_DATASET_CREATE), action));
  file.check(H5Pset_chunk(layout, table.rank_, chunk), action);
  file.check(H5Pset_obj_track_times(layout, false), action);  // equal runs give equal bytes
  if (spec.compress) {
    file.check(H5Pset_shuffle(layout), action);
    file.check(H5Pset_deflate(layout, 1), action);
  }
  if (spec.nan_fill) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    file.check(H5Pset_fill_value(layout, H5T_NATIVE_DOUBLE, &nan), action);
  }
  table.chunk_rows_ = chunk[0];
  table.id_ = Id(file.check(H5Dcreate2(parent, name.c_str(), spec.type, space, H5P_DEFAULT, layout, H5P_DEFAULT), action));
  set_text(file, table.id_, "unit", spec.unit);
  return table;
}

Table Table::open(const File& file, hid_t parent, const std::string& name) {
  const std::string action = "read " + name;
  Table table;
  table.name_ = name;
  table.id_ = Id(file.check(H5Dopen2(parent, name.c_str(), H5P_DEFAULT), action));
  Id space(file.check(H5Dget_space(table.id_), action)), type(file.check(H5Dget_type(table.id_), action));
  hsize_t size[2] = {0, 1};
  table.rank_ = file.check(H5Sget_simple_extent_ndims(space), action);
  if (table.rank_ < 1 || table.rank_ > 2) throw Error(Exit::file, file.path() + ": " + name + " is not a table");
  file.check(H5Sget_simple_extent_dims(space, size, nullptr), action);
  table.rows_ = size[0];
  table.components_ = static_cast<int>(size[1]);
  table.single_ = H5Tequal(type, H5T_IEEE_F32LE) > 0;
  Id layout(file.check(H5Dget_create_plist(table.id_), action));
  if (hsize_t chunk[2] = {0, 0}; H5Pget_layout(layout) == H5D_CHUNKED && H5Pget_chunk(layout, 2, chunk) > 0) table.chunk_rows_ = chunk[0];
  return table;
}

void Table::resize(const File& file, hsize_t rows) {
  if (rows == rows_) return;
  const hsize_t size[2] = {rows, static_cast<hsize_t>(components_)};
  file.check(H5Dset_extent(id_, size), "resize " + name_);
  rows_ = rows;
}

void Table::write_real(const File& file, hsize_t first, std::span<const double> values) {
  if (!single_) return write<double>(file, first, values);
  // Converted here: HDF5 converts in pieces, which would compress every chunk several times.
  const std::vector<float> narrow(values.begin(), values.end());
  write<float>(file, first, narrow);
}

void Table::write(const File& file, hsize_t first, hsize_t count, hid_t type, const void* values) {
  // Chunks are written whole, and compression may fail to make them smaller.
  const hsize_t chunks = count == 0 ? 0 : (first + count - 1) / chunk_rows_ - first / chunk_rows_ + 1;
  file.reserve(chunks * chunk_rows_ * static_cast<hsize_t>(components_) * (single_ ? sizeof(float) : sizeof(double)));
  if (first + count > rows_) resize(file, first + count);
  if (count == 0) return;
  const std::string action = "write " + name_;
  const hsize_t start[2] = {first, 0}, size[2] = {count, static_cast<hsize_t>(components_)};
  Id target(file.check(H5Dget_space(id_), action)), source(file.check(H5Screate_simple(rank_, size, nullptr), action));
  file.check(H5Sselect_hyperslab(target, H5S_SELECT_SET, start, nullptr, size, nullptr), action);
  file.check(H5Dwrite(id_, type, source, target, H5P_DEFAULT, values), action);
}

void Table::read(const File& file, hsize_t first, hsize_t count, hid_t type, void* values) const {
  const std::string action = "read " + name_;
  if (first + count > rows_) {
    throw Error(Exit::file, file.path() + ": " + name_ + " has " + std::to_string(rows_) + " rows, " + std::to_string(first + count) +
                                " are needed: the file is damaged");
  }
  if (count == 0) return;
  const hsize_t start[2] = {first, 0}, size[2] = {count, static_cast<hsize_t>(components_)};
  Id source(file.check(H5Dget_space(id_), action)), target(file.check(H5Screate_simple(rank_, size, nullptr), action));
  file.check(H5Sselect_hyperslab(source, H5S_SELECT_SET, start, nullptr, size, nullptr), action);
  file.check(H5Dread(id_, type, target, source, H5P_DEFAULT, values), action);
}

}  // namespace mortise::output::h5
