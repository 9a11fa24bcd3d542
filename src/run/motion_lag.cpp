#include "run/motion_lag.h"

#include <algorithm>

#include "effects/roles.h"
#include "run/tuning.h"

namespace mortise::run {

MotionLag::MotionLag(const model::ModelInput& input) : holds_(input.scene.at("effects")) {
  const Params &effects = input.scene.at("effects"), *time = input.scene.find("time");
  const std::vector<std::string> inertia = effects::of_role(effects, effects::Role::inertia);
  if (!time || inertia.empty()) return;
  const Params *step = time->find("step"), *integrator = effects.at(inertia.front()).find("integrator");
  if (step && (!integrator || integrator->as_text() == "backward_euler")) step_ = step->as_number();
}

void MotionLag::state(const Snapshot& said, const std::vector<double>& points, const std::vector<MeasuredBody>& bodies) {
  const Snapshot::Values* velocity = said.of_points("velocity", 3);
  if (std::isnan(step_) || !velocity || velocity->empty()) return;
  const bool first = start_.empty();
  value_ = first ? NAN : 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const MeasuredBody& b = bodies[i];
    const Vec3 x = b.mean(points, points), v = b.mean(*velocity, points);
    if (first) {
      double size = 0;
      for (std::size_t k = b.first; k < b.first + b.count; ++k) size = std::max(size, 2 * (vector_at(points, k) - x).norm());
      start_.insert(start_.end(), {x[0], x[1], x[2]}), v0_.insert(v0_.end(), {v[0], v[1], v[2]});
      least_.push_back(tuning::kStill * size), far_.push_back(0);
      continue;
    }
    far_[i] = std::max(far_[i], (x - vector_at(start_, i)).norm());
    // Slides on the world are supported, across their axis.
    if (holds_.given(b.name) || (said.has("supports/" + b.name + "_x") && !holds_.held(b.name))) continue;
    const double e = 0.5 * step_ * (v - vector_at(v0_, i)).norm();
    if (e > 0) value_ = std::max(value_, e / std::max(far_[i] - e, least_[i]));
  }
}

void MotionLag::checkpoint(Archive& archive) {
  for (auto [name, values] : {std::pair{"lag.start", &start_}, {"lag.velocity", &v0_}, {"lag.least", &least_}, {"lag.far", &far_}})
    archive.io(name, *values);
  archive.io("lag.value", value_);
}

}  // namespace mortise::run
