#include "run/layer_error.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "effects/tie_name.h"
#include "run/measured_body.h"
#include "run/tuning.h"
#include "run/vector_at.h"

namespace mortise::run {

namespace {

std::vector<Params> entries(const Params& effects, const char* effect) {
  const Params* list = effects.find(effect);
  return list ? list->items() : std::vector<Params>();
}

// Bodies that go, or are held, as the scene says: pinned somewhere, or all of whose motion joints and drives give from such a body or from the world.
std::set<std::string> held_bodies(const Params& effects) {
  std::set<std::string> held, given;  // given: joints of which nothing is left free
  for (const Params& pin : entries(effects, "pin"))
    if (!pin.has("release")) held.insert(pin.text("body"));
  for (const Params& drive : entries(effects, "drive"))
    if (drive.text("mode") == "kinematic") given.insert(drive.text("joint"));
  const auto is_held = [&](const std::string* body) { return !body || held.count(*body); };
  for (std::size_t before = ~0UL; before != held.size() + given.size();) {
    before = held.size() + given.size();
    for (const Params& joint : entries(effects, "joint")) {
      const Params *to = joint.find("to"), *mimic = joint.find("mimic");
      const std::string &body = joint.text("body"), *other = to ? &to->as_text() : nullptr, name = effects::tie_name(joint);
      if (joint.text("type") == "fixed" || (mimic && given.count(mimic->text("joint")))) given.insert(name);
      if (!given.count(name)) continue;
      if (is_held(other)) held.insert(body);
      if (other && is_held(&body)) held.insert(*other);
    }
    for (const Params& bond : entries(effects, "bond"))
      if (is_held(&bond.text("to"))) held.insert(bond.text("body"));
  }
  return held;
}

}  // namespace

LayerError::LayerError(const model::ModelInput& input) {
  const std::set<std::string> held = held_bodies(input.scene.at("effects"));
  std::size_t first = 0;
  for (const model::BodyInput& in : input.bodies) {
    if (in.type == model::BodyType::half_space) continue;
    bodies_.push_back({first, in.nodes.size(), in.type == model::BodyType::soft, held.count(in.name) > 0});
    first += in.nodes.size();
  }
}

double LayerError::indentation(std::size_t body, const Fields& f) const {
  if (body >= bodies_.size()) return 0;  // a half-space
  const Body& b = bodies_[body];
  if (!b.held) return -1;
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
  if (body >= bodies_.size() || !bodies_[body].soft) return 1;
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
