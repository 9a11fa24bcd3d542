#pragma once
// What effects report and save, by environment: arrays over all points, cells or blocks of the model cut into those of each.
#include <string_view>
#include <vector>

#include "base/archive.h"
#include "base/field_sinks.h"
#include "model/model.h"

namespace mortise::effects {

// Of `first`, one more than environments, in elements: where environments begin in values of which every element has so many.
inline std::vector<std::size_t> in_values(const std::vector<Index>& first, int per_element = 1) {
  std::vector<std::size_t> out;
  for (Index f : first) out.push_back(static_cast<std::size_t>(f) * static_cast<std::size_t>(per_element));
  return out;
}

// Environments begin where elements of theirs do: env of every element, ascending.
inline std::vector<std::size_t> firsts(const std::vector<Index>& env_of_element, Index envs, int per_element = 1) {
  std::vector<std::size_t> out(static_cast<std::size_t>(envs) + 1, 0);
  for (Index e : env_of_element) out[static_cast<std::size_t>(e) + 1] += static_cast<std::size_t>(per_element);
  for (std::size_t e = 1; e < out.size(); ++e) out[e] += out[e - 1];
  return out;
}

// One value of every environment.
inline std::vector<std::size_t> one_each(Index envs) {
  std::vector<std::size_t> out;
  for (Index e = 0; e <= envs; ++e) out.push_back(static_cast<std::size_t>(e));
  return out;
}

inline void report_points(const FieldSinks& sinks, const model::Model& model, std::string_view name, std::string_view unit, int components,
                          std::span<const double> values) {
  const std::vector<std::size_t> first = in_values(model.env_points, components);
  for (Index e = 0; e < sinks.size(); ++e)
    if (sinks.wanted(e)) sinks[e].points(name, unit, components, values.subspan(first[e], first[e + 1] - first[e]));
}

inline void report_cells(const FieldSinks& sinks, const model::Model& model, std::string_view name, std::string_view unit, int components,
                         std::span<const double> values) {
  const std::vector<std::size_t> first = in_values(model.env_cells, components);
  for (Index e = 0; e < sinks.size(); ++e)
    if (sinks.wanted(e)) sinks[e].cells(name, unit, components, values.subspan(first[e], first[e + 1] - first[e]));
}

// 3-vectors of which environments begin at `first`.
inline void io(Archive& archive, std::string_view name, device::Buffer<Vec3>& buffer, const std::vector<Index>& first) {
  std::vector<Vec3> host = buffer.download();
  std::vector<double> flat(3 * host.size());
  for (std::size_t i = 0; i < host.size(); ++i)
    for (int a = 0; a < 3; ++a) flat[3 * i + a] = host[i][a];
  archive.io(name, flat, in_values(first, 3));
  if (!archive.loading()) return;
  if (flat.size() != 3 * host.size()) throw Error(Exit::file, "the checkpoint holds '" + std::string(name) + "' of another size than the scene");
  for (std::size_t i = 0; i < host.size(); ++i) host[i] = Vec3(flat[3 * i], flat[3 * i + 1], flat[3 * i + 2]);
  buffer.upload(host);
}

}  // namespace mortise::effects
