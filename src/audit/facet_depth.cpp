#include "audit/facet_depth.h"

#include <algorithm>
#include <map>
#include <numbers>

#include "audit/measured_body.h"
#include "audit/shape_defect.h"
#include "geometry/placement.h"

namespace mortise::audit {

FacetDepth::FacetDepth(const model::ModelInput& input) {
  for (const model::BodyInput& in : input.bodies) {
    if (in.type == model::BodyType::half_space) continue;
    Body& b = bodies_.emplace_back();
    const Params* shape = in.params.find("shape");
    const double exact = shape ? round_volume(*shape) : 0;
    if (!(exact > 0) || (in.params.has("curved") && in.params.flag("curved"))) continue;
    double area = 0;
    if (const Params* cylinder = shape->find("cylinder")) {
      area = 2 * std::numbers::pi * cylinder->number("radius") * cylinder->number("height");
      b.axis = geometry::Placement(in.params).R.col(2);
    } else {
      for (const Triangle& t : in.triangles) {
        const Vec3& a = in.nodes[t.v[0]];
        area += 0.5 * (in.nodes[t.v[1]] - a).cross(in.nodes[t.v[2]] - a).norm();
      }
    }
    b.depth = std::max(exact - MeasuredBody(in, 0).rest_volume(), 0.0) / area;
  }
}

bool FacetDepth::any() const {
  return std::any_of(bodies_.begin(), bodies_.end(), [](const Body& b) { return b.depth > 0; });
}

double FacetDepth::depth(std::size_t body, const Vec3& force, const LayerError& layer, const LayerError::Fields& fields) const {
  if (body >= bodies_.size() || bodies_[body].depth == 0) return 0;
  const Body& b = bodies_[body];
  if (b.axis.isZero(0) || force.isZero(0)) return b.depth;
  return b.depth * force.normalized().cross(layer.motion(body, fields).R * b.axis).norm();
}

LayerError::Samples FacetDepth::of(LayerError::Samples s, const LayerError& layer, const LayerError::Fields& fields) const {
  std::map<std::pair<std::size_t, std::size_t>, double> depths;
  const auto pair_of = [](const std::vector<double>& bodies, std::size_t i) {
    return std::pair(static_cast<std::size_t>(bodies[2 * i]), static_cast<std::size_t>(bodies[2 * i + 1]));
  };
  for (std::size_t i = 0; 2 * i + 1 < s.pair_bodies.size() && 3 * i + 2 < s.pair_force.size(); ++i) {
    const auto pair = pair_of(s.pair_bodies, i);
    const Vec3 force(s.pair_force[3 * i], s.pair_force[3 * i + 1], s.pair_force[3 * i + 2]);
    depths[std::minmax(pair.first, pair.second)] = depth(pair.first, force, layer, fields) + depth(pair.second, force, layer, fields);
  }
  for (std::size_t i = 0; i < s.gap.size(); ++i) {
    const auto pair = pair_of(s.bodies, i);
    const auto it = depths.find(std::minmax(pair.first, pair.second));
    s.gap[i] = it == depths.end() ? 0 : it->second;
  }
  return s;
}

}  // namespace mortise::audit
