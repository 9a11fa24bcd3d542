#include "effects/contact/layer.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "effects/contact/named.h"
#include "effects/contact/start_gap.h"
#include "geometry/bounds.h"

namespace mortise::effects::contact {
namespace {

// Bodies of the environment that the effect acts on.
std::vector<const model::BodyInput*> bodies_of(const Params& effect, const model::ModelInput& input, Index env) {
  const Params* pairs = effect.find("pairs");
  const std::set<std::string> names = pairs ? named(*pairs) : std::set<std::string>();
  std::vector<const model::BodyInput*> out;
  for (const model::BodyInput& body : input.bodies)
    if (body.env == env && !body.triangles.empty() && (names.empty() || names.count(body.name))) out.push_back(&body);
  return out;
}

// The value that the share `below` of all fall short of; 0 of none.
double quantile(std::vector<double> v, double below) {
  if (v.empty()) return 0;
  const auto at = v.begin() + static_cast<std::ptrdiff_t>(below * static_cast<double>(v.size()));
  std::nth_element(v.begin(), at, v.end());
  return *at;
}

double fine_edge(const model::BodyInput& body) {
  std::vector<double> length;
  for (const Triangle& t : body.triangles)
    for (int k = 0; k < 3; ++k) length.push_back((body.nodes[t.v[k]] - body.nodes[t.v[(k + 1) % 3]]).norm());
  const double edge = quantile(std::move(length), tuning::kFine);
  if (body.type == model::BodyType::soft) return edge;
  const double extent = geometry::bounds_of(body.nodes).size().minCoeff();
  return extent > 0 ? std::min(edge, tuning::kOfExtent * extent) : edge;
}

// The circle around an equilateral triangle of edge w on a sphere of radius R is w^2/(6 R) deep, and theta = w/(sqrt(3) R).
double facet_depth(const model::BodyInput& body) {
  std::map<std::pair<Index, Index>, Vec3> first;  // normal of the first triangle at an edge
  std::vector<double> depth;
  for (const Triangle& t : body.triangles) {
    const Vec3 n = (body.nodes[t.v[1]] - body.nodes[t.v[0]]).cross(body.nodes[t.v[2]] - body.nodes[t.v[0]]).normalized();
    for (int k = 0; k < 3; ++k) {
      const Index a = t.v[k], b = t.v[(k + 1) % 3];
      const auto [other, alone] = first.try_emplace({std::min(a, b), std::max(a, b)}, n);
      if (alone) continue;
      const double theta = std::atan2(n.cross(other->second).norm(), n.dot(other->second));
      if (theta < tuning::kSmooth) depth.push_back((body.nodes[a] - body.nodes[b]).norm() * theta / std::sqrt(12.0));
    }
  }
  return quantile(std::move(depth), 1 - tuning::kFine);
}

}  // namespace

double support_radius(const Params& effect, const model::ModelInput& input, Index env) {
  if (const Params* d_hat = effect.find("d_hat")) return d_hat->as_number();
  double soft = INFINITY, stiff = INFINITY, facets = 0;
  const std::vector<const model::BodyInput*> bodies = bodies_of(effect, input, env);
  for (const model::BodyInput* body : bodies) {
    double& finest = body->type == model::BodyType::soft ? soft : stiff;
    finest = std::min(finest, fine_edge(*body));
    facets = std::max(facets, facet_depth(*body));
  }
  const double edge = std::isfinite(soft) ? soft : std::isfinite(stiff) ? stiff : 1;
  const double thin = std::max(tuning::kThinnest * edge, start_gap(effect, input, bodies, env, tuning::kThickness * edge));
  return std::clamp(tuning::kOverFacets * facets, thin, tuning::kThickest * edge);
}

std::vector<double> support_radii(const Params& effect, const model::ModelInput& input, Index envs) {
  std::vector<double> out;
  for (Index e = 0; e < envs; ++e) out.push_back(support_radius(input.effect_of(effect, e), input, e));
  return out;
}

Param support_radius_param(const std::string& what) {
  return param::positive(
      param::automatic(param::number("d_hat", Unit::length, "0.1 mm", 0,
                                     what + "; auto, or without it, a hundredth of the finest mesh in contact, of soft bodies if "
                                            "there are any, less where bodies begin nearer to each other, and no less than twice the "
                                            "depth of the facets of round ones")));
}

double stiffness(const Params& effect, const model::ModelInput& input, Index env) {
  if (const Params* kappa = effect.find("stiffness")) return kappa->as_number();
  double largest = 0;
  for (const model::BodyInput* body : bodies_of(effect, input, env))
    if (body->type == model::BodyType::soft)
      largest = std::max(largest, 1 / compliance(body->material.number("youngs_modulus"), body->material.number("poisson_ratio")));
  return largest > 0 ? largest : tuning::kRigid;
}

}  // namespace mortise::effects::contact
