#include "audit/rim_error.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "audit/entries.h"
#include "audit/tuning.h"
#include "audit/vector_at.h"
#include "base/disjoint_sets.h"
#include "geometry/bounds.h"

namespace mortise::audit {

RimError::RimError(const model::ModelInput& input) {
  std::set<std::string> loaded;
  for (const Params& load : entries(input.scene.at("effects"), "pressure_load")) loaded.insert(load.text("body"));
  const auto soft = [](const model::BodyInput& body) { return body.type == model::BodyType::soft; };
  if (std::none_of(input.bodies.begin(), input.bodies.end(), soft)) return;
  std::size_t number = 0;
  Index first = 0;
  for (const model::BodyInput& in : input.bodies) {
    if (in.type == model::BodyType::half_space) continue;
    loaded_.push_back(loaded.count(in.name) > 0);
    const auto normal = [&](const Triangle& t) -> Vec3 {
      return (in.nodes[t.v[1]] - in.nodes[t.v[0]]).cross(in.nodes[t.v[2]] - in.nodes[t.v[0]]).normalized();
    };
    std::map<std::pair<Index, Index>, const Triangle*> open;  // edges that one triangle is known of
    for (const Triangle& t : in.triangles)
      for (int k = 0; k < 3; ++k) {
        const Index a = t.v[k], b = t.v[(k + 1) % 3], tip = t.v[(k + 2) % 3];
        const auto [other, is_first] = open.try_emplace(std::minmax(a, b), &t);
        if (is_first) continue;
        const Vec3 n = normal(*other->second);
        if (n.dot(normal(t)) < tuning::kSmooth && n.dot(in.nodes[tip] - in.nodes[a]) < 0) edges_.push_back({number, first + a, first + b});
      }
    ++number, first += static_cast<Index>(in.nodes.size());
  }
}

std::map<std::size_t, double> RimError::of(const ContactPatch& surface, const ContactPatch::Fields& f, const std::vector<std::size_t>& group) const {
  if (f.displacement.size() != 3 * surface.rest().size()) return {};
  const std::vector<ContactPatch::Node> nodes = surface.covered(f);
  const auto now = [&](std::size_t i) -> Vec3 { return surface.rest()[i] + at(f.displacement, i); };
  std::vector<long> number(surface.rest().size(), -1);
  for (std::size_t k = 0; k < nodes.size(); ++k) number[nodes[k].point] = static_cast<long>(k);
  DisjointSets joined(nodes.size());
  for (std::size_t k = 0; k < nodes.size(); ++k)
    for (const Index j : nodes[k].ring)
      if (number[j] >= 0) joined.join(k, static_cast<std::size_t>(number[j]));
  struct Patch {
    double force = 0, area = 0, widened = 0;  // [N], [m^2]
  };
  std::map<std::size_t, Patch> patches;
  std::vector<double> size;  // of the mesh at nodes [m]
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    Patch& patch = patches[joined.of(k)];
    patch.force += at(f.force, nodes[k].point).norm();
    patch.area += (nodes[k].inside ? 1 : 0.5) * nodes[k].area;
    size.push_back(std::sqrt(nodes[k].area));
  }
  // The last nodes of patches, and the way along their end there: across that to what is covered.
  struct Last {
    std::size_t node;
    Vec3 at, along;
  };
  std::vector<Last> rim;
  geometry::Bounds beside;  // outside of which no edge counts
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    if (nodes[k].inside || size[k] == 0 || loaded_[surface.body(nodes[k].point)]) continue;
    const Vec3 x = now(nodes[k].point), reach = Vec3::Constant(tuning::kBeside * size[k]);
    Vec3 inward = Vec3::Zero();
    for (const Index j : nodes[k].ring) inward += (number[j] >= 0 ? 1 : -1) * (now(j) - x);
    rim.push_back({k, x, nodes[k].normal.cross(inward).normalized()});
    beside.include(x - reach), beside.include(x + reach);
  }
  // The one of another body that is nearest to a point of an edge, in sizes of the mesh.
  const auto nearest = [&](const Vec3& x, std::size_t body) {
    std::pair<const Last*, double> out{nullptr, tuning::kBeside};
    if (!beside.holds(x)) return out.first;
    for (const Last& last : rim) {
      if (surface.body(nodes[last.node].point) == body) continue;
      const double away = (last.at - x).norm() / size[last.node];
      if (away < out.second) out = {&last, away};
    }
    return out.first;
  };
  const double finest = size.empty() ? 0 : *std::min_element(size.begin(), size.end());
  for (const SharpEdge& edge : edges_) {
    if (rim.empty()) break;
    const Vec3 a = now(edge.a), along = now(edge.b) - a;
    const int pieces = finest > 0 ? static_cast<int>(std::min(std::ceil(2 * along.norm() / finest), tuning::kPieces)) : 0;
    for (int i = 0; i < pieces; ++i)
      if (const Last* last = nearest(a + (i + 0.5) / pieces * along, edge.body))
        patches[joined.of(last->node)].widened += size[last->node] * std::abs(last->along.dot(along)) / pieces;
  }
  const auto group_of = [&](std::size_t k) { return group[surface.body(nodes[k].point)]; };
  std::map<std::size_t, double> strongest, out;
  for (const auto& [k, patch] : patches) {
    double& most = strongest[group_of(k)];
    most = std::max(most, patch.force);
  }
  for (const auto& [k, patch] : patches) {
    const std::size_t of = group_of(k);
    if (patch.force < tuning::kPart * strongest[of] || !(patch.area > 0)) continue;
    out[of] = std::max(out[of], tuning::kWidened * patch.widened / (2 * patch.area));
  }
  return out;
}

}  // namespace mortise::audit
