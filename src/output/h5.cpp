#include "output/h5.h"

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
  using Access = PagedFile::Access;
  backing_ = std::make_unique<Backing>(path, mode == Mode::create ? Access::create : mode == Mode::write ? Access::write : Access::read);
  Id access(check(H5Pcreate(H5P_FILE_ACCESS), "set up HDF5"));
  check(use_backing(access, *backing_), "set up HDF5");
  check(H5Pset_fclose_degree(access, H5F_CLOSE_STRONG), "set up HDF5");  // closing the file closes what is open in it
  // No chunk cache: every write reaches the file below at once, so a full disk shows in the call that caused it.
  if (mode != Mode::read) check(H5Pset_cache(access, 0, 1, 0, 1.0), "set up HDF5");
  if (mode == Mode::create) {
    id_ = check(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access), "create");
  } else {
    id_ = check(H5Fopen(path.c_str(), mode == Mode::read ? H5F_ACC_RDONLY : H5F_ACC_RDWR, access), "open");
  }
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

File::~File() { abandon(); }

void File::check_backing() const {
  if (backing_ && !backing_->failure.empty()) throw Error(Exit::file, backing_->failure);
}

void File::settle() { check(H5Fflush(id_, H5F_SCOPE_GLOBAL), "write"); }

void File::flush() {
  settle();
  backing_->file.commit();
}

void File::close() {
  if (id_ < 0) return;
  check(H5Fclose(std::exchange(id_, -1)), "close");
  backing_->file.commit();
  backing_->file.remove_journal();
}

void File::abandon() noexcept {
  if (id_ < 0) return;
  if (backing_) backing_->file.forget();
  H5Fclose(std::exchange(id_, -1));
  H5Eclear2(H5E_DEFAULT);
}

void File::rename(const std::string& path) {
  backing_->file.rename(path);
  path_ = path;
}

void File::fail(std::string_view action) const {
  check_backing();
  throw Error(Exit::file, path_ + ": cannot " + std::string(action) + ": " + reason_of_failure());
}

Id make_group(const File& file, hid_t parent, const std::string& name) {
  return Id(file.check(H5Gcreate2(parent, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), "create group " + name));
}

Id new_layout(const File& file, const std::string& action) {
  Id layout(file.check(H5Pcreate(H5P_DATASET_CREATE), action));
  file.check(H5Pset_obj_track_times(layout, false), action);
  return layout;
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
