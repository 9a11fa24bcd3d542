#include "audit/swing_phase.h"

#include <algorithm>
#include <cmath>

#include "audit/tuning.h"

namespace mortise::audit {

void SwingPhase::state(const std::vector<MovingBody>& bodies) {
  if (!integration_.second_order || bodies.empty()) return;
  const double h = integration_.step;
  swings_.resize(bodies.size());
  value_ = NAN;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const MovingBody& body = bodies[i];
    Swing& swing = swings_[i];
    if (body.body.soft() || !body.swings || body.free) continue;
    if (states_ > tuning::kBegins && !body.touches && !body.stopped) {
      const Vec3 v = 0.5 * (swing.v + body.v);
      swing.turned += (body.a - swing.a).dot(v), swing.moved += v.squaredNorm() * h, swing.time += h;
      swing.spun += body.w.squaredNorm() * v.squaredNorm() * h;
    }
    swing.v = body.v, swing.a = body.a;
    if (!(swing.turned < 0)) continue;
    const double omega = std::sqrt(-swing.turned / swing.moved), now = body.v.squaredNorm() + body.a.squaredNorm() / (omega * omega);
    swing.largest = std::max(swing.largest, now);
    const double phase = (omega * omega + swing.spun / swing.moved) * h * h * omega * swing.time / 3;
    value_ = std::fmax(value_, std::min(phase, 1.0) * std::sqrt(now / swing.largest));
  }
  ++states_;
}

void SwingPhase::checkpoint(Archive& archive) {
  std::vector<double> values;
  for (const Swing& s : swings_) {
    values.insert(values.end(), s.v.data(), s.v.data() + 3), values.insert(values.end(), s.a.data(), s.a.data() + 3);
    for (const double v : {s.turned, s.moved, s.spun, s.time, s.largest}) values.push_back(v);
  }
  archive.io("swing_phase.swings", values);
  archive.io("swing_phase.states", states_);
  archive.io("swing_phase.value", value_);
  if (!archive.loading()) return;
  constexpr std::size_t kEach = 11;
  swings_.resize(values.size() / kEach);
  for (std::size_t i = 0; i < swings_.size(); ++i) {
    const double* v = values.data() + kEach * i;
    swings_[i] = {Vec3(v[0], v[1], v[2]), Vec3(v[3], v[4], v[5]), v[6], v[7], v[8], v[9], v[10]};
  }
}

}  // namespace mortise::audit
