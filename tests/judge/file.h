#pragma once
// A field file, read by HDF5 alone.
#include <hdf5.h>

#include <stdexcept>
#include <string>
#include <vector>

namespace judge {

class File {
 public:
  explicit File(const char* path) : id_(H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT)) {
    if (id_ < 0) throw std::runtime_error("cannot open the file");
  }
  ~File() { H5Fclose(id_); }
  bool has(const std::string& path) const {
    for (std::size_t slash = path.find('/', 1); slash != std::string::npos; slash = path.find('/', slash + 1))
      if (H5Lexists(id_, path.substr(0, slash).c_str(), H5P_DEFAULT) <= 0) return false;
    return H5Lexists(id_, path.c_str(), H5P_DEFAULT) > 0;
  }
  hid_t id() const { return id_; }
  bool numeric(const std::string& path) const {
    const hid_t set = H5Dopen2(id_, path.c_str(), H5P_DEFAULT), type = H5Dget_type(set);
    const H5T_class_t kind = H5Tget_class(type);
    H5Tclose(type), H5Dclose(set);
    return kind == H5T_INTEGER || kind == H5T_FLOAT;
  }
  std::vector<double> numbers(const std::string& path) const {
    const hid_t set = H5Dopen2(id_, path.c_str(), H5P_DEFAULT);
    if (set < 0) throw std::runtime_error("no dataset " + path);
    const hid_t space = H5Dget_space(set);
    std::vector<double> out(H5Sget_simple_extent_npoints(space));
    const herr_t ok = H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, out.data());
    H5Sclose(space), H5Dclose(set);
    if (ok < 0) throw std::runtime_error("cannot read " + path);
    return out;
  }
  std::string text(const std::string& path) const {
    const hid_t set = H5Dopen2(id_, path.c_str(), H5P_DEFAULT);
    if (set < 0) throw std::runtime_error("no dataset " + path);
    const hid_t type = H5Dget_type(set);
    std::string out;
    if (H5Tis_variable_str(type) > 0) {
      char* p = nullptr;
      H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, &p);
      out = p ? p : "";
      H5free_memory(p);
    } else {
      out.resize(H5Tget_size(type));
      H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, out.data());
      out = out.c_str();
    }
    H5Tclose(type), H5Dclose(set);
    return out;
  }
  long frames() const {
    const hid_t group = H5Gopen2(id_, "/VTKHDF/Steps", H5P_DEFAULT), a = H5Aopen(group, "NSteps", H5P_DEFAULT);
    long n = 0;
    H5Aread(a, H5T_NATIVE_LONG, &n);
    H5Aclose(a), H5Gclose(group);
    return n;
  }

 private:
  hid_t id_;
};

}  // namespace judge
