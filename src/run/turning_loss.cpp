#include "run/turning_loss.h"

#include <algorithm>
#include <cmath>

#include "effects/roles.h"
#include "run/tuning.h"

namespace mortise::run {

TurningLoss::TurningLoss(const model::ModelInput& input) : holds_(input.scene.at("effects")) {
  const Params &effects = input.scene.at("effects"), *time = input.scene.find("time");
  const std::vector<std::string> inertia = effects::of_role(effects, effects::Role::inertia);
  const Params* step = time ? time->find("step") : nullptr;
  if (!step || inertia.empty()) return;
  const Params* integrator = effects.at(inertia.front()).find("integrator");
  step_ = step->as_number(), sum_ = 0;
  second_order_ = integrator && integrator->as_text() == "bdf2";
}

void TurningLoss::state(const Snapshot& said, const std::vector<double>& points, const std::vector<MeasuredBody>& bodies) {
  const Snapshot::Values* velocity = said.of_points("velocity", 3);
  of_first_ = of_second_ = 0;
  if (std::isnan(sum_) || !velocity || velocity->empty()) return;
  for (const MeasuredBody& b : bodies) {
    if (holds_.given(b.name)) continue;
    const double phi = b.spin(*velocity, points).norm() * step_, energy = b.turning_energy(*velocity, points);
    of_first_ += std::min(2 * phi * phi, 1.0) * energy;
    of_second_ += std::min(tuning::kTurnSecondOrder * std::pow(phi, 4), 1.0) * energy;
  }
}

void TurningLoss::step(bool first_order) { sum_ += second_order_ && !first_order ? of_second_ : of_first_; }

void TurningLoss::checkpoint(Archive& archive) { archive.io("turning", sum_); }

}  // namespace mortise::run
