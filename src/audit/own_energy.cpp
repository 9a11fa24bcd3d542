#include "audit/own_energy.h"

#include "audit/archived.h"
#include "audit/vector_at.h"

namespace mortise::audit {

OwnEnergy::OwnEnergy(const model::ModelInput& input)
    : gravity_(gravity_of(input.scene)), second_order_(integration_of(input.scene).second_order), step_(integration_of(input.scene).step) {
  if (step_ > 0) fall_ = step_ * gravity_;
}

void OwnEnergy::state(const std::vector<MovingBody>& bodies) {
  const double before = kinetic_ + weight_;
  const bool starts = std::isnan(first_);
  kinetic_ = weight_ = lost_ = untold_ = 0;
  std::vector<double> moved = velocities(bodies);
  changes_.assign(bodies.size(), 0.0);
  driven_.resize(second_order_ ? bodies.size() : 0);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const MovingBody& b = bodies[i];
    if (!moved_.empty()) changes_[i] = b.energy_of(b.v - at(moved_, 2 * i)) + b.turning_of(b.w - at(moved_, 2 * i + 1));
    if (!b.given || b.body.soft()) continue;
    kinetic_ += b.energy() + b.turns, weight_ -= b.body.mass() * gravity_.dot(b.x);
    lost_ += changes_[i];
    if (!second_order_) continue;
    Driven& last = driven_[i];
    using Vector = Eigen::Map<Vec3>;
    const Vec3 force = b.body.mass() * b.a, torque = b.w.squaredNorm() > 0 ? Vec3(2 * b.turns / b.w.squaredNorm() * b.alpha) : Vec3::Zero();
    if (!moved_.empty()) {
      const Vec3 turned = 0.5 * step_ * (b.w + at(moved_, 2 * i + 1));
      untold_ += b.energy() + b.turns - last.energy - 0.5 * (force + Vector(last.force)).dot(b.x - Vector(last.x)) -
                 0.5 * (torque + Vector(last.torque)).dot(turned);
    }
    last.energy = b.energy() + b.turns, Vector(last.x) = b.x, Vector(last.force) = force, Vector(last.torque) = torque;
  }
  moved_ = std::move(moved);
  if (starts) first_ = weight_;
  work_ = starts ? 0 : kinetic_ + weight_ - before + lost();
}

void OwnEnergy::checkpoint(Archive& archive) {
  for (auto [name, value] : {std::pair{"own.kinetic", &kinetic_}, {"own.weight", &weight_}, {"own.first", &first_}}) archive.io(name, *value);
  archive.io("own.moved", moved_);
  archive_all(archive, "own.driven", driven_);
}

}  // namespace mortise::audit
