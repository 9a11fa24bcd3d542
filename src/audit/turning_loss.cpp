#include "audit/turning_loss.h"

#include <algorithm>
#include <cmath>

#include "audit/tuning.h"
#include "audit/vector_at.h"

namespace mortise::audit {

namespace {

// It touches something and turns about as fast as it goes. What hangs on joints does that about them, too: of that only what goes where it touches
// more slowly than its middle does.
bool rolls(const MovingBody& b, double omega, const std::vector<double>& points) {
  if (!b.touches || omega * b.body.radius(b.x, points) <= tuning::kRolls * b.v.norm()) return false;
  return b.free || b.rigid().at(b.pressed).norm() < tuning::kRolls * b.v.norm();
}

// What carries it: the body that presses it most, where that goes as the scene says.
const MovingBody* carrier(const MovingBody& b, const std::vector<MovingBody>& bodies) {
  return b.free && b.touches && b.on && bodies[*b.on].given && bodies[*b.on].v.norm() > 0 ? &bodies[*b.on] : nullptr;
}

}  // namespace

TurningLoss::TurningLoss(const model::ModelInput& input) : integration_(integration_of(input.scene)) {
  if (!std::isnan(integration_.step)) sum_ = 0;
}

void TurningLoss::state(const std::vector<double>& points, const std::vector<MovingBody>& bodies, double lost) {
  of_first_ = of_second_ = given_first_ = given_second_ = 0;
  if (std::isnan(sum_) || bodies.empty()) return;
  for (std::vector<double>* v : {&turned_, &moved_, &lost_, &seen_, &lost_seen_}) v->resize(bodies.size());
  rolled_.resize(3 * bodies.size());
  for (std::vector<double>* v : {&lost_first_, &lost_second_}) v->assign(bodies.size(), 0.0);
  double rolling = 0, wheels = 0, hanging = 0;  // energies of what rolls by itself and on joints, and of all that may hang on those
  bool wheel = false;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const MovingBody& b = bodies[i];
    const double omega = b.w.norm(), phi = omega * integration_.step;
    const double first = std::min(2 * phi * phi, 1.0) * b.turns, second = std::min(std::pow(phi, 4) / (1 + 4 * phi * phi), 1.0) * b.turns;
    if (b.driven) given_first_ += first, given_second_ += second;
    if (b.given) continue;
    of_first_ += first, of_second_ += second;
    const double energy = b.turns + b.energy();
    if (!b.free) hanging += energy;
    const bool rolls = audit::rolls(b, omega, points);
    if (rolls) (b.free ? rolling : wheels) += energy;
    Vec3 angle = rolls && !b.free ? Vec3(at(rolled_, i) + integration_.step * b.w) : Vec3::Zero();
    std::copy_n(angle.data(), 3, rolled_.begin() + static_cast<std::ptrdiff_t>(3 * i));
    wheel = wheel || angle.norm() > tuning::kWheel;
    if (const MovingBody* by = carrier(b, bodies)) {
      lost_first_[i] = first, lost_second_[i] = second;
      seen_[i] = std::max(seen_[i], b.turns + b.energy_of(b.v - by->rigid().at(b.x)));
    } else if (seen_[i] > 0) {
      most_ = of_its_own(), seen_[i] = lost_seen_[i] = 0;
    }
    if (!b.spins || b.touches || b.stopped) {
      // What spins on a joint has its turning from what it touches: each time by itself.
      if (!b.free) most_ = of_its_own(), turned_[i] = moved_[i] = lost_[i] = 0;
      continue;
    }
    lost_first_[i] = first, lost_second_[i] = second;
    turned_[i] = std::max(turned_[i], b.turns), moved_[i] = std::max(moved_[i], energy);
  }
  if (wheels > 0) rolling += hanging;
  if (lost > tuning::kImpact * rolling) lost = 0;  // of an impact
  if (wheels == 0) before_wheel_ = 0;
  if (wheels > 0 && !wheel) {
    before_wheel_ += lost;
  } else {
    lost += before_wheel_, before_wheel_ = 0;
    of_first_ = std::max(of_first_, lost), of_second_ = std::max(of_second_, lost);
  }
}

void TurningLoss::step(bool first_order) {
  const bool second = integration_.second_order && !first_order;
  sum_ += second ? of_second_ : of_first_;
  given_ += second ? given_second_ : given_first_;
  const std::vector<double>& of_step = second ? lost_second_ : lost_first_;
  for (std::size_t i = 0; i < of_step.size(); ++i) (seen_[i] > 0 ? lost_seen_ : lost_)[i] += of_step[i];
}

double TurningLoss::of_its_own() const {
  double most = most_;
  for (std::size_t i = 0; i < lost_seen_.size(); ++i)
    if (seen_[i] > 0) most = std::max(most, lost_seen_[i] / seen_[i]);
  for (std::size_t i = 0; i < lost_.size(); ++i)
    if (turned_[i] > tuning::kTurns * moved_[i]) most = std::max(most, lost_[i] / turned_[i]);
  return most;
}

void TurningLoss::checkpoint(Archive& archive) {
  archive.io("turning", sum_);
  archive.io("turning.given", given_);
  archive.io("turning.most", most_);
  archive.io("turning.before_wheel", before_wheel_);
  archive.io("turning.rolled", rolled_);
  for (auto [name, v] : {std::pair{"turning.turned", &turned_},
                         {"turning.moved", &moved_},
                         {"turning.lost", &lost_},
                         {"turning.seen", &seen_},
                         {"turning.lost_seen", &lost_seen_}})
    archive.io(name, *v);
}

}  // namespace mortise::audit
