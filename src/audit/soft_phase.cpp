#include "audit/soft_phase.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "audit/archived.h"
#include "audit/entries.h"

namespace mortise::audit {

SoftPhase::SoftPhase(const model::ModelInput& input) : integration_(integration_of(input.scene)) {
  const Params& effects = input.scene.at("effects");
  std::set<std::string> moved = worked_on(effects);
  for (const char* list : {"joint", "bond", "tie"})
    for (const Params& p : entries(effects, list))
      for (const char* key : {"body", "to"})
        if (p.has(key)) moved.insert(p.text(key));
  for (const model::BodyInput& body : input.bodies)
    if (body.type != model::BodyType::half_space) swings_.push_back({body.type == model::BodyType::soft && moved.count(body.name) == 0 ? 1.0 : 0.0});
}

void SoftPhase::state(const Snapshot& said, const std::vector<double>& points, const std::vector<MovingBody>& bodies) {
  if (!integration_.second_order || bodies.empty()) return;
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (bodies[i].touches) swings_[i].alone = 0;
  value_ = NAN;
  if (std::none_of(swings_.begin(), swings_.end(), [](const Swing& s) { return s.alone != 0; })) return;
  const Snapshot::Values *velocity = said.of_points("velocity", 3), *displacement = said.of_points("displacement", 3);
  if (!velocity || !displacement) return;
  const std::vector<double> v(velocity->begin(), velocity->end()), u(displacement->begin(), displacement->end());
  sum_.resize(u.size());
  std::vector<double> away = u;
  ++states_;
  for (std::size_t i = 0; i < u.size(); ++i) sum_[i] += u[i], away[i] -= sum_[i] / states_;
  const double h = integration_.step, time = states_ * h;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const MeasuredBody& body = bodies[i].body;
    Swing& swing = swings_[i];
    if (swing.alone == 0) continue;
    const double moves = body.kinetic_energy(v, points);
    swing.v += moves, swing.u += body.kinetic_energy(u, points);
    const double spread = swing.u - body.kinetic_energy(sum_, points) / states_;
    if (!(spread > 0)) continue;
    const double omega = std::sqrt(swing.v / spread);
    if (omega * time < 2 * M_PI) continue;
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
