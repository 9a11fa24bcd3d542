#include "output/h5.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

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
      (void)cut;                                                            // a file that is too long does no harm
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

}  // namespace mortise::output::h5
