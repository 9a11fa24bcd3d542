#include "output/column_file.h"

#include <hdf5.h>
#include <sys/stat.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/error.h"
#include "output/h5.h"
#include "output/tuning.h"

namespace mortise::output {
namespace {

using h5::File;
using h5::Id;

class Columns {
 public:
  explicit Columns(const std::string& path) : path_(path), file_(open(path)) {}

  Column read(const std::string& name) const {
    const std::size_t open = name.find('[');
    const bool part = open != std::string::npos && name.back() == ']';
    const std::string set = name.substr(0, part ? open : name.size()), which = part ? name.substr(open + 1, name.size() - open - 2) : "";
    if (!is_dataset(set)) throw wrong("has no dataset '" + set + "'; there are: " + listed());
    const Id data(file_.check(H5Dopen2(file_.id(), set.c_str(), H5P_DEFAULT), "read dataset " + set));
    const Id type(H5Dget_type(data)), space(H5Dget_space(data));
    const std::string called = "dataset '" + set + "' ";
    const H5T_class_t kind = H5Tget_class(type);
    if (kind != H5T_FLOAT && kind != H5T_INTEGER) throw wrong(called + "holds no numbers");
    const int rank = H5Sget_simple_extent_ndims(space);
    if (rank != 1 && rank != 2)
      throw wrong(called + "has " + std::to_string(std::max(rank, 0)) + " dimensions; it should have rows, or rows and columns");
    hsize_t size[2] = {0, 1};
    H5Sget_simple_extent_dims(space, size, nullptr);
    if (size[0] == 0) throw wrong(called + "has no rows");
    if (size[0] > tuning::kMostRows)
      throw wrong(called + "has " + std::to_string(size[0]) + " rows; it may have " + std::to_string(tuning::kMostRows));
    if (rank == 1 && part) throw wrong(called + "has one column: leave out [" + which + "]");
    hsize_t column = 0;
    if (rank == 2 && (part || size[1] != 1)) column = number_of(data, set, which, size[1]);

    Column out;
    out.at = path_ + ": dataset '" + name + "'";
    out.unit = unit_of(data, column, size[1]);
    out.values.resize(size[0]);
    const hsize_t from[2] = {0, column}, count[2] = {size[0], 1};
    H5Sselect_hyperslab(space, H5S_SELECT_SET, from, nullptr, count, nullptr);
    const Id rows(H5Screate_simple(1, size, nullptr));
    file_.check(H5Dread(data, H5T_NATIVE_DOUBLE, rows, space, H5P_DEFAULT, out.values.data()), "read dataset " + set);
    for (std::size_t i = 0; i < out.values.size(); ++i)
      if (!std::isfinite(out.values[i])) throw wrong("row " + std::to_string(i) + " (from 0) of dataset '" + name + "' is not a number");
    return out;
  }

 private:
  static File open(const std::string& path) {
    struct stat there {};
    if (stat(path.c_str(), &there) == 0 && S_ISREG(there.st_mode) && H5Fis_hdf5(path.c_str()) <= 0)
      throw Error(Exit::file, path + " is no HDF5 file");
    return File(path, h5::Mode::read);
  }
  Error wrong(const std::string& message) const { return Error(Exit::scene, path_ + " " + message); }

  // Every group on the way is there.
  bool is_dataset(const std::string& name) const {
    if (name.empty() || name == "/") return false;
    for (std::size_t end = name.find('/', 1);; end = name.find('/', end + 1)) {
      const std::string up_to = name.substr(0, end);
      if (!h5::exists(file_, file_.id(), up_to)) return false;
      if (end == std::string::npos) break;
      if (!h5::is_group(file_, file_.id(), up_to)) return false;
    }
    const Id object(H5Oopen(file_.id(), name.c_str(), H5P_DEFAULT));
    return H5Iget_type(object) == H5I_DATASET;
  }

  std::string listed() const {
    std::vector<std::string> all;
    gather("", all);
    if (all.empty()) return "none";
    std::string out;
    for (std::size_t i = 0; i < std::min(all.size(), tuning::kMostNamed); ++i) out += (i ? ", '" : "'") + all[i] + "'";
    return out + (all.size() > tuning::kMostNamed ? " and " + std::to_string(all.size() - tuning::kMostNamed) + " more" : "");
  }
  void gather(const std::string& group, std::vector<std::string>& all) const {
    const Id at = h5::open_group(file_, file_.id(), group.empty() ? "/" : group);
    for (const std::string& name : h5::members(file_, at)) {
      const std::string path = group.empty() ? name : group + "/" + name;
      if (is_dataset(path))
        all.push_back(path);
      else if (h5::is_group(file_, file_.id(), path))
        gather(path, all);
    }
  }

  hsize_t number_of(hid_t data, const std::string& set, const std::string& which, hsize_t columns) const {
    const std::vector<std::string> names = texts(data, "columns");
    const auto found = std::find(names.begin(), names.end(), which);
    if (found != names.end() && static_cast<hsize_t>(found - names.begin()) < columns) return static_cast<hsize_t>(found - names.begin());
    std::string there = "0 to " + std::to_string(columns - 1);
    for (const std::string& n : names) there += ", '" + n + "'";
    if (which.empty())
      throw wrong("dataset '" + set + "' has " + std::to_string(columns) + " columns: say which, '" + set + "[0]'; there are: " + there);
    unsigned long number = 0;
    const auto [end, code] = std::from_chars(which.data(), which.data() + which.size(), number);
    if (code != std::errc{} || end != which.data() + which.size() || number >= columns)
      throw wrong("dataset '" + set + "' has no column '" + which + "'; there are: " + there);
    return number;
  }

  std::string unit_of(hid_t data, hsize_t column, hsize_t columns) const {
    for (const char* name : {"unit", "units"}) {
      const std::vector<std::string> all = texts(data, name);
      if (all.size() == 1) return all[0];
      if (all.size() == columns) return all[column];
    }
    return "";
  }

  // An attribute of one text or several; none where there is no such.
  std::vector<std::string> texts(hid_t data, const char* name) const {
    if (H5Aexists(data, name) <= 0) return {};
    const Id attribute(file_.check(H5Aopen(data, name, H5P_DEFAULT), "read an attribute")), type(H5Aget_type(attribute)),
        space(H5Aget_space(attribute));
    if (H5Tget_class(type) != H5T_STRING) return {};
    const hssize_t n = H5Sget_simple_extent_npoints(space);
    std::vector<std::string> out;
    if (n <= 0) return out;
    if (H5Tis_variable_str(type) > 0) {
      std::vector<char*> text(static_cast<std::size_t>(n), nullptr);
      file_.check(H5Aread(attribute, type, text.data()), "read an attribute");
      for (const char* t : text) out.emplace_back(t ? t : "");
      H5Dvlen_reclaim(type, space, H5P_DEFAULT, text.data());
      return out;
    }
    const std::size_t size = H5Tget_size(type);
    std::string all(size * static_cast<std::size_t>(n), '\0');
    file_.check(H5Aread(attribute, type, all.data()), "read an attribute");
    for (hssize_t i = 0; i < n; ++i) {
      std::string one = all.substr(static_cast<std::size_t>(i) * size, size);
      one.erase(std::find(one.begin(), one.end(), '\0'), one.end());
      one.erase(one.find_last_not_of(' ') + 1);
      out.push_back(std::move(one));
    }
    return out;
  }

  std::string path_;
  File file_;
};

}  // namespace

Column read_column(const std::string& path, const std::string& name) { return Columns(path).read(name); }

}  // namespace mortise::output
