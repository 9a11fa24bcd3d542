#include "run/layer_error.h"

#include <algorithm>
#include <cmath>

#include "run/measured_body.h"
#include "run/tuning.h"
#include "run/vector_at.h"

namespace mortise::run {

LayerError::LayerError(const model::ModelInput& input) {
  const Params &effects = input.scene.at("effects"), *pins = effects.find("pin"), *bonds = effects.find("bond");
  const auto is_pinned = [&](const std::string& name) {
    return pins && std::any_of(pins->items().begin(), pins->items().end(), [&](const Params& pin) { return pin.text("body") == name; });
  };
  std::size_t first = 0;
  for (const model::BodyInput& in : input.bodies) {
    if (in.type == model::BodyType::half_space) continue;
    bool pinned = is_pinned(in.name);
    if (bonds)
      for (const Params& bond : bonds->items()) pinned |= bond.text("body") == in.name && is_pinned(bond.text("to"));
    bodies_.push_back({first, in.nodes.size(), in.type == model::BodyType::soft, pinned});
    first += in.nodes.size();
  }
}

double LayerError::indentation(std::size_t body, const Fields& f) const {
  if (body >= bodies_.size()) return 0;  // a half-space
  const Body& b = bodies_[body];
  if (!b.pinned) return -1;
  if (!b.soft) return 0;
  Vec3 base = Vec3::Zero();
  double held = 0, farthest = 0;
  for (std::size_t i = b.first; i < b.first + b.count; ++i)
    if (!at(f.support, i).isZero(0)) base += at(f.displacement, i), held += 1;
  if (held == 0) return -1;
  base /= held;
  for (std::size_t i = b.first; i < b.first + b.count; ++i)
    if (f.pressure[i] > 0) farthest = std::max(farthest, (at(f.displacement, i) - base).norm());
  return farthest;
}

double LayerError::borne(std::size_t body, const Fields& f) const {
  if (body >= bodies_.size()) return 1;
  Vec3 contact = Vec3::Zero(), support = Vec3::Zero();
  double all = 0;
  for (std::size_t i = bodies_[body].first; i < bodies_[body].first + bodies_[body].count; ++i)
    contact += at(f.contact, i), support += at(f.support, i), all += at(f.contact, i).norm();
  if (!(contact.norm() > tuning::kOneWay * all)) return 1;
  return std::clamp(-support.dot(contact) / contact.squaredNorm(), 0.0, 1.0);
}

double LayerError::of(const Samples& s, const Fields& f) const {
  if (f.support.size() != f.displacement.size() || f.contact.size() != f.displacement.size() || 3 * f.pressure.size() != f.displacement.size())
    return NAN;
  struct Pair {
    double force = 0, gap = 0;
  };
  std::map<std::pair<std::size_t, std::size_t>, Pair> pairs;
  for (std::size_t i = 0; i < s.force.size(); ++i) {
    Pair& pair = pairs[std::minmax(static_cast<std::size_t>(s.bodies[2 * i]), static_cast<std::size_t>(s.bodies[2 * i + 1]))];
    pair.force += s.force[i], pair.gap += s.force[i] * s.gap[i];
  }
  double worst = NAN;
  for (const auto& [bodies, pair] : pairs) {
    const double one = indentation(bodies.first, f), other = indentation(bodies.second, f);
    if (!(pair.force > 0 && one >= 0 && other >= 0 && one + other > 0)) continue;
    const double fraction = std::max(0.0, 2 * std::min(borne(bodies.first, f), borne(bodies.second, f)) - 1);
    worst = std::fmax(worst, fraction * pair.gap / pair.force / (one + other));
  }
  return worst;
}

}  // namespace mortise::run
