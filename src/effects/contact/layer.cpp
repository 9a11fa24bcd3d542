#include "effects/contact/layer.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

namespace mortise::effects::contact {
namespace {

constexpr double kFine = 0.1;      // share of edges
constexpr double kOfExtent = 0.1;  // triangles of stiff bodies are as large as their faces

void gather(const Params& p, std::set<std::string>& names) {
  if (p.kind() == Params::Kind::text) names.insert(p.as_text());
  if (p.kind() == Params::Kind::list)
    for (const Params& item : p.items()) gather(item, names);
  if (p.kind() == Params::Kind::table)
    for (const auto& [key, value] : p.entries()) gather(value, names);
}

// Bodies that the effect acts on.
std::vector<const model::BodyInput*> bodies_of(const Params& effect, const model::ModelInput& input) {
  std::set<std::string> names;
  if (const Params* pairs = effect.find("pairs")) gather(*pairs, names);
  std::vector<const model::BodyInput*> out;
  for (const model::BodyInput& body : input.bodies)
    if (!body.triangles.empty() && (names.empty() || names.count(body.name))) out.push_back(&body);
  return out;
}

double fine_edge(const model::BodyInput& body) {
  std::vector<double> length;
  for (const Triangle& t : body.triangles)
    for (int k = 0; k < 3; ++k) length.push_back((body.nodes[t.v[k]] - body.nodes[t.v[(k + 1) % 3]]).norm());
  const auto at = length.begin() + static_cast<std::ptrdiff_t>(kFine * static_cast<double>(length.size()));
  std::nth_element(length.begin(), at, length.end());
  if (body.type == model::BodyType::soft) return *at;
  Vec3 lo = body.nodes.front(), hi = lo;
  for (const Vec3& x : body.nodes) lo = lo.cwiseMin(x), hi = hi.cwiseMax(x);
  const double extent = (hi - lo).minCoeff();
  return extent > 0 ? std::min(*at, kOfExtent * extent) : *at;
}

}  // namespace

double support_radius(const Params& effect, const model::ModelInput& input) {
  if (const Params* d_hat = effect.find("d_hat")) return d_hat->as_number();
  double soft = INFINITY, stiff = INFINITY;
  for (const model::BodyInput* body : bodies_of(effect, input)) {
    double& finest = body->type == model::BodyType::soft ? soft : stiff;
    finest = std::min(finest, fine_edge(*body));
  }
  const double finest = std::isfinite(soft) ? soft : stiff;
  return kThickness * (std::isfinite(finest) ? finest : 1);
}

Param support_radius_param(const std::string& what) {
  return param::positive(param::automatic(param::number("d_hat", Unit::length, "0.1 mm", 0, what + "; auto, or without it, a hundredth of the finest mesh in contact")));
}

double stiffness(const Params& effect, const model::ModelInput& input) {
  if (const Params* kappa = effect.find("stiffness")) return kappa->as_number();
  double most = 0;
  for (const model::BodyInput* body : bodies_of(effect, input))
    if (body->type == model::BodyType::soft) most = std::max(most, 1 / compliance(body->material.number("youngs_modulus"), body->material.number("poisson_ratio")));
  return most > 0 ? most : kRigid;
}

}  // namespace mortise::effects::contact
