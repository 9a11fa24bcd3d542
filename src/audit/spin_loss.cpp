#include "audit/spin_loss.h"

#include <algorithm>
#include <cmath>

#include "audit/archived.h"
#include "audit/tuning.h"

namespace mortise::audit {

namespace {

// It turns about the direction in which one thing presses it that turns with far less of that.
bool spins_on(const MovingBody& b, const std::vector<MovingBody>& bodies) {
  if (!b.free || b.push.squaredNorm() == 0) return false;
  const double w = b.w.norm();
  const double along = b.on ? std::abs(bodies[*b.on].w.dot(b.push)) / b.push.norm() : 0;
  return b.across_push(b.w).norm() < tuning::kUpright * w && along < tuning::kUpright * w;
}

}  // namespace

void SpinLoss::state(const std::vector<MovingBody>& bodies) {
  if (std::isnan(integration_.step)) return;
  spins_.resize(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const MovingBody& b = bodies[i];
    Spin& spin = spins_[i];
    spin.first = spin.second = 0;
    if (b.given) continue;
    if (!(b.spins && !b.touches && !b.stopped) && !spins_on(b, bodies)) {
      if (!b.free) ended_ = std::max(ended_, spin.share()), spin = {};
      continue;
    }
    const double omega = b.w.norm(), phi = omega * integration_.step;
    const LostInTurning lost = lost_in_turning(phi);
    spin.first = lost.first * omega * omega, spin.second = lost.second * omega * omega;
    spin.most = std::max(spin.most, omega * omega), spin.angle += phi;
    spin.turned = std::max(spin.turned, b.turns), spin.moved = std::max(spin.moved, b.turns + b.energy());
  }
}

void SpinLoss::step(bool first_order) {
  for (Spin& spin : spins_) spin.lost += integration_.second_order && !first_order ? spin.second : spin.first;
}

double SpinLoss::Spin::share() const {
  return most > 0 && (angle > tuning::kSpun || turned > tuning::kTurns * moved) ? std::min(lost / most, 1.0) : 0;
}

double SpinLoss::share() const {
  double most = ended_;
  for (const Spin& spin : spins_) most = std::max(most, spin.share());
  return most;
}

void SpinLoss::checkpoint(Archive& archive) {
  archive_all(archive, "spin.bodies", spins_);
  archive.io("spin.ended", ended_);
}

}  // namespace mortise::audit
