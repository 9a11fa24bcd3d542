#include "base/snapshot.h"

#include <cmath>

namespace mortise {
namespace {

void assign(Snapshot::Values& to, std::string_view unit, int components, std::span<const double> values) {
  to.unit = unit, to.components = components;
  to.assign(values.begin(), values.end());
}

std::string full(std::string_view group, std::string_view name) { return std::string(group) + "/" + std::string(name); }

}  // namespace

double Snapshot::at(const std::string& name) const {
  const auto it = number.find(name);
  return it == number.end() ? NAN : it->second;
}

const Snapshot::Values* Snapshot::of_points(const std::string& name, int components) const {
  const auto it = point.find(name);
  return it == point.end() || it->second.components != components ? nullptr : &it->second;
}

std::map<std::string, std::vector<double>> Snapshot::drawable() const {
  std::map<std::string, std::vector<double>> out;
  for (const auto& [name, v] : point)
    if (v.components == 1 || v.components == 3) out[name] = v;
  return out;
}

void Snapshot::points(std::string_view name, std::string_view unit, int components, std::span<const double> values) {
  order_.push_back({Kind::point, {}, std::string(name), {}});
  assign(point[std::string(name)], unit, components, values);
}

void Snapshot::cells(std::string_view name, std::string_view unit, int components, std::span<const double> values) {
  order_.push_back({Kind::cell, {}, std::string(name), {}});
  assign(cell[std::string(name)], unit, components, values);
}

void Snapshot::rows(std::string_view group, std::string_view name, std::string_view unit, int components, std::span<const double> values) {
  order_.push_back({Kind::row, std::string(group), std::string(name), {}});
  assign(row[full(group, name)], unit, components, values);
}

void Snapshot::scalar(std::string_view group, std::string_view name, std::string_view unit, double value) {
  order_.push_back({Kind::number, std::string(group), std::string(name), std::string(unit)});
  number[full(group, name)] = value;
}

void Snapshot::report(FieldSink& to) const {
  for (const auto& [kind, group, name, unit] : order_) {
    if (kind == Kind::number) {
      to.scalar(group, name, unit, number.at(full(group, name)));
      continue;
    }
    const Values& v = kind == Kind::point ? point.at(name) : kind == Kind::cell ? cell.at(name) : row.at(full(group, name));
    if (kind == Kind::point) to.points(name, v.unit, v.components, v);
    if (kind == Kind::cell) to.cells(name, v.unit, v.components, v);
    if (kind == Kind::row) to.rows(group, name, v.unit, v.components, v);
  }
}

}  // namespace mortise
