#pragma once
// Thin owners of HDF5 objects. Every failing call throws Error(Exit::file): "<path>: cannot <action>: <reason>", where the reason
// is the system's ("No space left on device") when there is one.
#include <hdf5.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "output/chunk.h"
#include "output/h5_driver.h"

namespace mortise::output::h5 {

// Owns one HDF5 identifier (group, dataset, space, type, property list, attribute).
class Id {
 public:
  Id() = default;
  explicit Id(hid_t id) : id_(id) {}
  Id(Id&& other) noexcept : id_(std::exchange(other.id_, -1)) {}
  Id& operator=(Id&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  ~Id() {
    if (id_ >= 0) H5Idec_ref(id_);
  }
  operator hid_t() const { return id_; }

 private:
  hid_t id_ = -1;
};

// rehearse: as write, but nothing reaches the disk.
enum class Mode { create, read, write, rehearse };

class File {
 public:
  // Files on disk go through h5_driver.h: what is written shows only, and then as a whole, when flush() or close() returns.
  File(const std::string& path, Mode mode);
  // Opens a file from its bytes in memory; `path` serves for messages only (HDF5 refuses images under the name of a real file).
  static File from_image(const std::string& path, std::string_view bytes);
  // A file in memory only; image() gives its bytes.
  static File in_memory(const std::string& path);
  File(File&& other) noexcept : path_(std::move(other.path_)), id_(std::exchange(other.id_, -1)), backing_(std::move(other.backing_)) {}
  File& operator=(File&&) = delete;
  ~File();  // without close(): what was not flushed is dropped

  const std::string& path() const { return path_; }
  hid_t id() const { return id_; }
  // Everything that HDF5 holds back goes to the file below, which keeps it from the disk until it is committed.
  void settle();
  // Commits: survives a kill of the process and a power cut.
  void flush();
  void close();
  // Closes without what was not flushed.
  void abandon() noexcept;
  void rename(const std::string& path);
  std::string image();

  // `ok` is what an HDF5 call returned; negative means that it failed. Failed writes show here too.
  template <class R>
  R check(R ok, std::string_view action) const {
    if (ok < 0) fail(action);
    check_backing();
    return ok;
  }
  [[noreturn]] void fail(std::string_view action) const;

 private:
  File(std::string path, hid_t id) : path_(std::move(path)), id_(id) {}
  void check_backing() const;
  std::string path_;
  hid_t id_ = -1;
  std::unique_ptr<Backing> backing_;  // null: in memory
};

Id make_group(const File& file, hid_t parent, const std::string& name);

// Creation properties of a dataset that does not keep the second in which it was made: equal runs give equal bytes.
Id new_layout(const File& file, const std::string& action);
Id open_group(const File& file, hid_t parent, const std::string& name);
bool exists(const File& file, hid_t parent, const std::string& name);
std::vector<std::string> members(const File& file, hid_t group);  // sorted by name
bool is_group(const File& file, hid_t parent, const std::string& name);

// Attributes: text is variable-length UTF-8, which Python reads as str.
void set_text(const File& file, hid_t object, const char* name, std::string_view value);
void set_fixed_ascii(const File& file, hid_t object, const char* name, std::string_view value);
void set_integers(const File& file, hid_t object, const char* name, std::span<const std::int64_t> values);  // 1-D
void set_integer(const File& file, hid_t object, const char* name, std::int64_t value);                     // scalar, may exist
void set_number(const File& file, hid_t object, const char* name, double value);                            // scalar
void set_numbers(const File& file, hid_t object, const char* name, std::span<const double> values);
std::string get_text(const File& file, hid_t object, const char* name);
std::int64_t get_integer(const File& file, hid_t object, const char* name);
std::vector<std::int64_t> get_integers(const File& file, hid_t object, const char* name);
double get_number(const File& file, hid_t object, const char* name);

// A dataset that holds one string.
void write_text(const File& file, hid_t parent, const char* name, std::string_view value);
// Takes away what is written anew.
void remove(const File& file, hid_t parent, const char* name);
void remove_attribute(const File& file, hid_t object, const char* name);
std::string read_text(const File& file, hid_t parent, const char* name);

template <class T>
hid_t native();
template <>
inline hid_t native<float>() {
  return H5T_NATIVE_FLOAT;
}
template <>
inline hid_t native<double>() {
  return H5T_NATIVE_DOUBLE;
}
template <>
inline hid_t native<std::int64_t>() {
  return H5T_NATIVE_INT64;
}
template <>
inline hid_t native<std::int32_t>() {
  return H5T_NATIVE_INT32;
}
template <>
inline hid_t native<std::uint8_t>() {
  return H5T_NATIVE_UINT8;
}

// A dataset of shape (rows) or (rows, components) that grows and shrinks along its rows.
class Table {
 public:
  struct Spec {
    hid_t type = -1;      // in the file
    int components = 1;   // 1: one-dimensional
    bool column = false;  // with one component: shape (rows, 1) instead of (rows)
    hsize_t chunk_rows = 256;
    bool compress = false;  // as chunk.h does
    bool nan_fill = false;  // rows never written read as NaN and take no space
    std::string unit = "1";
    std::string description{};  // attribute; none where it is empty
  };
  Table() = default;
  static Table create(const File& file, hid_t parent, const std::string& name, const Spec& spec);
  static Table open(const File& file, hid_t parent, const std::string& name);

  hid_t id() const { return id_; }
  // Closed until it is used again: whenever HDF5 writes or closes a file, it looks at all datasets that are open in any.
  void rest() { id_ = Id(); }
  hsize_t rows() const { return rows_; }
  int components() const { return components_; }
  bool single() const { return single_; }  // stored as 32-bit floats
  const std::string& name() const { return name_; }
  std::string unit(const File& file) const { return get_text(file, id_, "unit"); }

  void resize(const File& file, hsize_t rows);
  // Rows [first, first + values.size()/components), growing the table if need be.
  template <class T>
  void write(const File& file, hsize_t first, std::span<const T> values) {
    write(file, first, values.size() / components_, native<T>(), values.data());
  }
  // Doubles in whatever float precision the table has.
  void write_real(const File& file, hsize_t first, std::span<const double> values);
  // A compressed table can also be given whole chunks (chunk.h): of so many rows (0: it cannot), from a row on that begins one.
  hsize_t whole() const { return whole_; }
  Raw raw(std::span<const double> values) const;
  void write_chunk(const File& file, hsize_t first, std::span<const std::byte> chunk);
  template <class T>
  std::vector<T> read(const File& file, hsize_t first, hsize_t count) const {
    std::vector<T> out(count * components_);
    read(file, first, count, native<T>(), out.data());
    return out;
  }

 private:
  void write(const File& file, hsize_t first, hsize_t count, hid_t type, const void* values);
  void read(const File& file, hsize_t first, hsize_t count, hid_t type, void* values) const;
  void keep_path(const File& file);
  hid_t opened(const File& file) const;
  mutable Id id_;
  std::string name_, path_;  // path_: in the file
  hsize_t rows_ = 0, whole_ = 0;
  int components_ = 1, rank_ = 1;
  bool single_ = false;
};

}  // namespace mortise::output::h5
