#include "run/vibration_loss.h"

#include <algorithm>

namespace mortise::run {

namespace {

// Of a field of velocities, or of changes of them.
double energy_of(const std::vector<double>& velocity, const std::vector<double>& points, const std::vector<MovingBody>& bodies) {
  const bool soft = std::any_of(bodies.begin(), bodies.end(), [](const MovingBody& b) { return b.body.soft() && b.touches; });
  double sum = 0;
  for (const MovingBody& b : bodies)
    if (b.body.soft() || (b.swings && (b.touches ? soft : !b.free))) sum += b.body.kinetic_energy(velocity, points);
  return sum;
}

}  // namespace

void VibrationLoss::state(const Snapshot& said, const std::vector<double>& points, const std::vector<MovingBody>& bodies, double stored,
                          double brought) {
  of_first_ = of_second_ = 0;
  if (bodies.empty()) return;
  brought_ += 2 * brought;
  const Snapshot::Values& v = *said.of_points("velocity", 3);
  std::vector<double> change(v.begin(), v.end());
  stored_ = std::max(stored_, stored), moved_ = std::max(moved_, energy_of(change, points, bodies));
  if (!v1_.empty()) {
    for (std::size_t i = 0; i < v.size(); ++i) change[i] = v[i] - v1_[i];
    of_first_ = 2 * energy_of(change, points, bodies);
  }
  if (integration_.second_order && !v0_.empty()) {
    for (std::size_t i = 0; i < v.size(); ++i) change[i] -= v1_[i] - v0_[i];
    of_second_ = energy_of(change, points, bodies);
  }
  v0_ = std::move(v1_);
  v1_.assign(v.begin(), v.end());
}

void VibrationLoss::step(bool first_order, bool counts) {
  const double loss = integration_.second_order && !first_order ? of_second_ : of_first_, struck = std::min(loss, brought_);
  brought_ -= struck;
  if (counts) sum_ += loss - struck;
}

void VibrationLoss::checkpoint(Archive& archive) {
  archive.io("vibration.v1", v1_);
  archive.io("vibration.v0", v0_);
  for (auto [name, value] : {std::pair{"brought", &brought_}, {"sum", &sum_}, {"stored", &stored_}, {"moved", &moved_}})
    archive.io(std::string("vibration.") + name, *value);
}

}  // namespace mortise::run
