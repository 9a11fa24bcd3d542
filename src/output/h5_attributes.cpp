// Attributes, and datasets of one string.
#include "output/h5.h"

namespace mortise::output::h5 {
namespace {

Id text_type(const File& file) {
  Id type(file.check(H5Tcopy(H5T_C_S1), "make a string type"));
  H5Tset_size(type, H5T_VARIABLE);
  H5Tset_cset(type, H5T_CSET_UTF8);
  return type;
}

Id scalar_space(const File& file) { return Id(file.check(H5Screate(H5S_SCALAR), "make a dataspace")); }

}  // namespace

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
  Id attribute(file.check(H5Acreate2(object, name, H5T_STD_I64LE, space, H5P_DEFAULT, H5P_DEFAULT), std::string("write attribute ") + name));
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

void set_numbers(const File& file, hid_t object, const char* name, std::span<const double> values) {
  const std::string action = std::string("write attribute ") + name;
  const hsize_t size = values.size();
  Id space(file.check(H5Screate_simple(1, &size, nullptr), action));
  Id attribute(file.check(H5Acreate2(object, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT), action));
  file.check(H5Awrite(attribute, H5T_NATIVE_DOUBLE, values.data()), action);
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
  Id type = text_type(file), space = scalar_space(file), layout = new_layout(file, action);
  Id dataset(file.check(H5Dcreate2(parent, name, type, space, H5P_DEFAULT, layout, H5P_DEFAULT), action));
  file.check(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, &text), action);
  set_text(file, dataset, "unit", "1");
}

void remove(const File& file, hid_t parent, const char* name) { file.check(H5Ldelete(parent, name, H5P_DEFAULT), std::string("remove ") + name); }

void remove_attribute(const File& file, hid_t object, const char* name) {
  file.check(H5Adelete(object, name), std::string("remove attribute ") + name);
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

}  // namespace mortise::output::h5
