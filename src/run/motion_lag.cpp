#include "run/motion_lag.h"

#include <algorithm>
#include <cmath>

#include "run/tuning.h"

namespace mortise::run {

MotionLag::MotionLag(const model::ModelInput& input) {
  const Integration integration = integration_of(input.scene);
  if (!integration.second_order) step_ = integration.step;
}

void MotionLag::state(const std::vector<double>& points, const std::vector<MovingBody>& bodies) {
  if (std::isnan(step_) || bodies.empty()) return;
  const bool first = start_.empty();
  if (!first) ++steps_;
  value_ = first ? NAN : 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Vec3 &x = bodies[i].x, &v = bodies[i].v;
    if (first) {
      start_.insert(start_.end(), {x[0], x[1], x[2]}), v0_.insert(v0_.end(), {v[0], v[1], v[2]});
      least_.push_back(tuning::kStill * 2 * bodies[i].body.radius(x, points)), far_.push_back(0), a0_.push_back(0);
      continue;
    }
    far_[i] = std::max(far_[i], (x - vector_at(start_, i)).norm());
    if (bodies[i].led) continue;
    const double gained = (v - vector_at(v0_, i)).norm();
    if (steps_ == 1) a0_[i] = gained / step_;
    const double e = 0.5 * step_ * (gained + std::max(gained - a0_[i] * step_ * static_cast<double>(steps_), 0.0));
    if (e > 0) value_ = std::max(value_, e / std::max(far_[i] - e, least_[i]));
  }
}

void MotionLag::checkpoint(Archive& archive) {
  for (auto [name, values] : {std::pair{"lag.start", &start_}, {"lag.velocity", &v0_}, {"lag.least", &least_}, {"lag.far", &far_}, {"lag.a0", &a0_}})
    archive.io(name, *values);
  archive.io("lag.steps", steps_);
  archive.io("lag.value", value_);
}

}  // namespace mortise::run
