#include "run/turning_loss.h"

#include <algorithm>
#include <cmath>

#include "run/tuning.h"

namespace mortise::run {

namespace {

// It touches something, and turns about as fast as it goes; what it lost is no impact.
bool rolls(const MovingBody& b, double omega, const std::vector<double>& points) {
  return b.free && b.touches && omega * b.body.radius(b.x, points) > tuning::kRolls * b.v.norm();
}

}  // namespace

TurningLoss::TurningLoss(const model::ModelInput& input) : integration_(integration_of(input.scene)) {
  if (!std::isnan(integration_.step)) sum_ = 0;
}

void TurningLoss::state(const Snapshot& said, const std::vector<double>& points, const std::vector<MovingBody>& bodies, double lost) {
  of_first_ = of_second_ = 0;
  if (std::isnan(sum_) || bodies.empty()) return;
  const Snapshot::Values& velocity = *said.of_points("velocity", 3);
  double rolling = 0;  // energy of what rolls
  for (const MovingBody& b : bodies) {
    if (b.given) continue;
    const double omega = b.body.spin(velocity, points).norm(), phi = omega * integration_.step, energy = b.body.turning_energy(velocity, points);
    of_first_ += std::min(2 * phi * phi, 1.0) * energy;
    of_second_ += std::min(std::pow(phi, 4) / (1 + 4 * phi * phi), 1.0) * energy;
    if (rolls(b, omega, points)) rolling += energy + b.energy();
  }
  if (lost > tuning::kImpact * rolling) return;
  of_first_ = std::max(of_first_, lost), of_second_ = std::max(of_second_, lost);
}

void TurningLoss::step(bool first_order) { sum_ += integration_.second_order && !first_order ? of_second_ : of_first_; }

void TurningLoss::checkpoint(Archive& archive) { archive.io("turning", sum_); }

}  // namespace mortise::run
