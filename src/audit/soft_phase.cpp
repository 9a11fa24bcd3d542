#include "audit/soft_phase.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "audit/archived.h"
#include "audit/entries.h"
#include "effects/roles.h"

namespace mortise::audit {

namespace {

// Bodies on which something does work.
std::set<std::string> worked_on(const Params& effects) {
  std::set<std::string> out;
  std::vector<std::string> lists = effects::of_role(effects, effects::Role::load);
  lists.insert(lists.end(), {"pin", "joint", "bond", "tie"});
  for (const std::string& list : lists) {
    if (const Params* of = effects.find(list); !of || of->kind() != Params::Kind::list) continue;  // gravity pulls at all for ever
    for (const Params& p : entries(effects, list.c_str())) {
      if (list == "pin" && !p.has("motion")) continue;
      for (const char* key : {"body", "to"})
        if (p.has(key)) out.insert(p.text(key));
    }
  }
  return out;
}

}  // namespace

SoftPhase::SoftPhase(const model::ModelInput& input) : integration_(integration_of(input.scene)) {
  const std::set<std::string> worked = worked_on(input.scene.at("effects"));
  for (const model::BodyInput& body : input.bodies)
    if (body.type != model::BodyType::half_space) swings_.push_back({body.type == model::BodyType::soft && worked.count(body.name) == 0 ? 1.0 : 0.0});
}

void SoftPhase::state(const Snapshot& said, const std::vector<double>& points, const std::vector<MovingBody>& bodies) {
  const Snapshot::Values *velocity = said.of_points("velocity", 3), *displacement = said.of_points("displacement", 3);
  if (!integration_.second_order || bodies.empty() || !velocity || !displacement) return;
  const std::vector<double> v(velocity->begin(), velocity->end()), u(displacement->begin(), displacement->end());
  value_ = NAN;
  sum_.resize(u.size());
  for (std::size_t i = 0; i < u.size(); ++i) sum_[i] += u[i];
  ++states_;
  const double h = integration_.step, time = states_ * h;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const MeasuredBody& body = bodies[i].body;
    Swing& swing = swings_[i];
    if (bodies[i].touches) swing.alone = 0;
    if (swing.alone == 0) continue;
    const double moves = body.kinetic_energy(v, points);
    swing.v += moves, swing.u += body.kinetic_energy(u, points);
    const double spread = swing.u - body.kinetic_energy(sum_, points) / states_;
    if (!(spread > 0)) continue;
    const double omega = std::sqrt(swing.v / spread);
    if (omega * time < 2 * M_PI) continue;
    std::vector<double> away = u;
    for (std::size_t k = 3 * body.first; k < 3 * (body.first + body.count); ++k) away[k] -= sum_[k] / states_;
    const double now = moves + omega * omega * body.kinetic_energy(away, points);
    swing.largest = std::max(swing.largest, now);
    value_ = std::fmax(value_, std::min(h * h * omega * omega * omega * time / 3, 1.0) * std::sqrt(now / swing.largest));
  }
}

void SoftPhase::checkpoint(Archive& archive) {
  archive_all(archive, "soft_phase.swings", swings_);
  archive.io("soft_phase.sum", sum_);
  archive.io("soft_phase.states", states_);
  archive.io("soft_phase.value", value_);
}

}  // namespace mortise::audit
