// Datasets that grow along their rows.
#include <algorithm>
#include <limits>

#include "base/error.h"
#include "output/h5.h"
#include "output/tuning.h"

namespace mortise::output::h5 {
namespace {

// Rows of a chunk that compress() makes as the dataset's filters do; 0 of others.
hsize_t compressed_rows(const File& file, hid_t dataset, int rank) {
  Id layout(file.check(H5Dget_create_plist(dataset), "read a layout"));
  hsize_t chunk[2] = {0, 1};
  if (H5Pget_layout(layout) != H5D_CHUNKED || H5Pget_chunk(layout, rank, chunk) != rank || H5Pget_nfilters(layout) != 2) return 0;
  unsigned flags = 0, level = 0;
  std::size_t parameters = 0;
  if (H5Pget_filter2(layout, 0, &flags, &parameters, nullptr, 0, nullptr, nullptr) != H5Z_FILTER_SHUFFLE) return 0;
  parameters = 1;
  return H5Pget_filter2(layout, 1, &flags, &parameters, &level, 0, nullptr, nullptr) == H5Z_FILTER_DEFLATE ? chunk[0] : 0;
}

}  // namespace

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
  const Id layout = new_layout(file, action);
  file.check(H5Pset_chunk(layout, table.rank_, chunk), action);
  if (spec.compress) {
    file.check(H5Pset_shuffle(layout), action);
    file.check(H5Pset_deflate(layout, tuning::kDeflate), action);
    table.whole_ = chunk[0];
  }
  if (spec.nan_fill) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    file.check(H5Pset_fill_value(layout, H5T_NATIVE_DOUBLE, &nan), action);
  }
  table.id_ = Id(file.check(H5Dcreate2(parent, name.c_str(), spec.type, space, H5P_DEFAULT, layout, H5P_DEFAULT), action));
  table.keep_path(file);
  set_text(file, table.id_, "unit", spec.unit);
  if (!spec.description.empty()) set_text(file, table.id_, "description", spec.description);
  return table;
}

Table Table::open(const File& file, hid_t parent, const std::string& name) {
  const std::string action = "read " + name;
  Table table;
  table.name_ = name;
  table.id_ = Id(file.check(H5Dopen2(parent, name.c_str(), H5P_DEFAULT), action));
  table.keep_path(file);
  Id space(file.check(H5Dget_space(table.id_), action)), type(file.check(H5Dget_type(table.id_), action));
  hsize_t size[2] = {0, 1};
  table.rank_ = file.check(H5Sget_simple_extent_ndims(space), action);
  if (table.rank_ < 1 || table.rank_ > 2) throw Error(Exit::file, file.path() + ": " + name + " is not a table");
  file.check(H5Sget_simple_extent_dims(space, size, nullptr), action);
  table.rows_ = size[0];
  table.components_ = static_cast<int>(size[1]);
  table.single_ = H5Tequal(type, H5T_IEEE_F32LE) > 0;
  table.whole_ = compressed_rows(file, table.id_, table.rank_);
  return table;
}

void Table::keep_path(const File& file) {
  const ssize_t length = file.check(H5Iget_name(id_, nullptr, 0), "name " + name_);
  path_.resize(static_cast<std::size_t>(length));
  file.check(H5Iget_name(id_, path_.data(), path_.size() + 1), "name " + name_);
}

hid_t Table::opened(const File& file) const {
  if (id_ < 0) id_ = Id(file.check(H5Dopen2(file.id(), path_.c_str(), H5P_DEFAULT), "open " + name_));
  return id_;
}

void Table::resize(const File& file, hsize_t rows) {
  if (rows == rows_) return;
  const hsize_t size[2] = {rows, static_cast<hsize_t>(components_)};
  file.check(H5Dset_extent(opened(file), size), "resize " + name_);
  rows_ = rows;
}

void Table::write_real(const File& file, hsize_t first, std::span<const double> values) {
  if (!single_) return write<double>(file, first, values);
  // Converted here: HDF5 converts in pieces, which would compress every chunk several times.
  const std::vector<float> narrow(values.begin(), values.end());
  write<float>(file, first, narrow);
}

Raw Table::raw(std::span<const double> values) const {
  const std::size_t size = single_ ? sizeof(float) : sizeof(double);
  Raw out{std::vector<std::byte>(values.size() * size), size};
  if (single_)
    std::copy(values.begin(), values.end(), reinterpret_cast<float*>(out.bytes.data()));
  else
    std::copy(values.begin(), values.end(), reinterpret_cast<double*>(out.bytes.data()));
  return out;
}

void Table::write_chunk(const File& file, hsize_t first, std::span<const std::byte> bytes) {
  const hsize_t at[2] = {first, 0};
  if (first + whole_ > rows_) resize(file, first + whole_);
  file.check(H5Dwrite_chunk(opened(file), H5P_DEFAULT, 0, at, bytes.size(), bytes.data()), "write " + name_);
}

void Table::write(const File& file, hsize_t first, hsize_t count, hid_t type, const void* values) {
  if (first + count > rows_) resize(file, first + count);
  if (count == 0) return;
  const std::string action = "write " + name_;
  const hsize_t start[2] = {first, 0}, size[2] = {count, static_cast<hsize_t>(components_)};
  Id target(file.check(H5Dget_space(opened(file)), action)), source(file.check(H5Screate_simple(rank_, size, nullptr), action));
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
  Id source(file.check(H5Dget_space(opened(file)), action)), target(file.check(H5Screate_simple(rank_, size, nullptr), action));
  file.check(H5Sselect_hyperslab(source, H5S_SELECT_SET, start, nullptr, size, nullptr), action);
  file.check(H5Dread(id_, type, target, source, H5P_DEFAULT, values), action);
}

}  // namespace mortise::output::h5
