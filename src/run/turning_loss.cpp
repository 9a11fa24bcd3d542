#include "run/turning_loss.h"

#include <algorithm>
#include <cmath>

#include "effects/roles.h"
#include "run/tuning.h"

namespace mortise::run {

TurningLoss::TurningLoss(const model::ModelInput& input) : holds_(input.scene.at("effects")), free_(input) {
  const Params &effects = input.scene.at("effects"), *time = input.scene.find("time");
  const std::vector<std::string> inertia = effects::of_role(effects, effects::Role::inertia);
  const Params* step = time ? time->find("step") : nullptr;
  if (!step || inertia.empty()) return;
  const Params* integrator = effects.at(inertia.front()).find("integrator");
  step_ = step->as_number(), sum_ = 0;
  second_order_ = integrator && integrator->as_text() == "bdf2";
}

// It touches something, and turns about as fast as it goes; what it lost is no impact.
bool TurningLoss::rolls(const MeasuredBody& body, double omega, const Snapshot& said, const std::vector<double>& points) const {
  const Snapshot::Values* force = said.of_points("contact_force", 3);
  if (!force || force->empty() || !touches(body, *force)) return false;
  const Vec3 x = body.mean(points, points);
  double size = 0;
  for (std::size_t i = body.first; i < body.first + body.count; ++i) size = std::max(size, (vector_at(points, i) - x).norm());
  return omega * size > tuning::kRolls * body.mean(*said.of_points("velocity", 3), points).norm();
}

void TurningLoss::state(const Snapshot& said, const std::vector<double>& points, const std::vector<MeasuredBody>& bodies, double lost) {
  const Snapshot::Values* velocity = said.of_points("velocity", 3);
  of_first_ = of_second_ = 0;
  if (std::isnan(sum_) || !velocity || velocity->empty()) return;
  double rolling = 0;  // energy of what rolls
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const MeasuredBody& b = bodies[i];
    if (holds_.given(b.name)) continue;
    const double omega = b.spin(*velocity, points).norm(), phi = omega * step_, energy = b.turning_energy(*velocity, points);
    of_first_ += std::min(2 * phi * phi, 1.0) * energy;
    of_second_ += std::min(tuning::kTurnSecondOrder * std::pow(phi, 4), 1.0) * energy;
    if (free_.free(i) && rolls(b, omega, said, points)) rolling += energy + 0.5 * b.mass() * b.mean(*velocity, points).squaredNorm();
  }
  if (lost > tuning::kImpact * rolling) return;
  of_first_ = std::max(of_first_, lost), of_second_ = std::max(of_second_, lost);
}

void TurningLoss::step(bool first_order) { sum_ += second_order_ && !first_order ? of_second_ : of_first_; }

void TurningLoss::checkpoint(Archive& archive) { archive.io("turning", sum_); }

}  // namespace mortise::run
