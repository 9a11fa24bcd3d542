#include "audit/own_energy.h"

#include "audit/vector_at.h"

namespace mortise::audit {

OwnEnergy::OwnEnergy(const model::ModelInput& input) : gravity_(gravity_of(input.scene)), second_order_(integration_of(input.scene).second_order) {
  if (const double h = integration_of(input.scene).step; h > 0) fall_ = h * gravity_;
}

void OwnEnergy::state(const std::vector<MovingBody>& bodies) {
  const double before = kinetic_ + weight_;
  const bool starts = std::isnan(first_);
  kinetic_ = weight_ = lost_ = 0;
  std::vector<double> moved = velocities(bodies);
  changes_.assign(bodies.size(), 0.0);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const MovingBody& b = bodies[i];
    if (!moved_.empty()) changes_[i] = b.energy_of(b.v - at(moved_, 2 * i)) + b.turning_of(b.w - at(moved_, 2 * i + 1));
    if (!b.given || b.body.soft()) continue;
    kinetic_ += b.energy() + b.turns, weight_ -= b.body.mass() * gravity_.dot(b.x);
    lost_ += changes_[i];
  }
  moved_ = std::move(moved);
  if (starts) first_ = weight_;
  work_ = starts ? 0 : kinetic_ + weight_ - before + lost();
}

void OwnEnergy::checkpoint(Archive& archive) {
  for (auto [name, value] : {std::pair{"own.kinetic", &kinetic_}, {"own.weight", &weight_}, {"own.first", &first_}}) archive.io(name, *value);
  archive.io("own.moved", moved_);
}

}  // namespace mortise::audit
