#include "audit/turning_loss.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "audit/archived.h"
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
  return b.free && b.touches && b.on && bodies[*b.on].given ? &bodies[*b.on] : nullptr;
}

}  // namespace

TurningLoss::TurningLoss(const model::ModelInput& input) : integration_(integration_of(input.scene)), gravity_(gravity_of(input.scene)) {}

// Islands that have met have had what either had.
void TurningLoss::join(const std::vector<MovingBody>& bodies) {
  islands_.state(bodies);
  of_island_.resize(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    Island &of = of_island_[islands_.of(i)], &own = of_island_[i];
    of.first = of.second = 0;
    of.motored = of.motored > 0 || (!bodies[i].given && !bodies[i].swings);
    if (&of == &own) continue;
    of.sum += own.sum, of.before_wheel += own.before_wheel;
    of.most = std::max(of.most, own.most), of.fed = std::max(of.fed, own.fed), of.motored = std::max(of.motored, own.motored);
    own = {};
  }
}

// What islands have, and whether it may come from elsewhere.
void TurningLoss::measure(const std::vector<MovingBody>& bodies, const State& now) {
  struct Energy {
    double moves = 0, raised = 0, stored = 0, least = 0;
  };
  std::vector<Energy> has(bodies.size());
  const bool starts = weight_.empty();
  weight_.resize(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const MovingBody& b = bodies[i];
    if (b.given) continue;
    const auto goes_there = [&](std::size_t other) { return bodies[other].rigid().at(b.x).norm() > 0; };
    const double weight = -b.body.mass() * gravity_.dot(b.x);
    if (starts) weight_[i] = weight;
    Energy& of = has[islands_.of(i)];
    of.moves += b.energy() + b.turns, of.raised += weight - weight_[i], of.stored += now.elastic[i], of.least += now.least[i];
    const bool fed = b.body.soft() ? b.led : (b.on && bodies[*b.on].given && goes_there(*b.on)) || (b.carrier && goes_there(*b.carrier));
    if (fed) of_island_[islands_.of(i)].fed = 1;
  }
  for (std::size_t i = 0; i < has.size(); ++i)
    of_island_[i].most = std::max({of_island_[i].most, has[i].moves, std::abs(has[i].raised), has[i].stored, has[i].least});
  work_ = std::max(work_, std::abs(now.work));
}

void TurningLoss::state(const std::vector<double>& points, const std::vector<MovingBody>& bodies, const State& now) {
  given_first_ = given_second_ = 0;
  if (std::isnan(integration_.step) || bodies.empty()) return;
  join(bodies);
  measure(bodies, now);
  for (std::vector<double>* v : {&seen_, &lost_seen_, &lifted_}) v->resize(bodies.size());
  rolled_.resize(3 * bodies.size());
  for (std::vector<double>* v : {&lost_first_, &lost_second_}) v->assign(bodies.size(), 0.0);
  // Energies of what rolls by itself and on joints, and of all that may hang on those; of changes of velocity.
  struct Rolling {
    double freely = 0, wheels = 0, hanging = 0, changes = 0;
    bool wheel = false;
  };
  std::vector<Rolling> rolling(bodies.size());
  double changes = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const MovingBody& b = bodies[i];
    const double omega = b.w.norm();
    const LostInTurning lost = lost_in_turning(omega * integration_.step);
    const double first = lost.first * b.turns, second = lost.second * b.turns;
    if (b.driven) given_first_ += first, given_second_ += second;
    if (b.given) continue;
    Island& island = of_island_[islands_.of(i)];
    Rolling& of = rolling[islands_.of(i)];
    island.first += first, island.second += second;
    of.changes += now.own.change(i), changes += now.own.change(i);
    const double energy = b.turns + b.energy();
    if (!b.free) of.hanging += energy;
    const bool rolls = audit::rolls(b, omega, points);
    if (rolls) (b.free ? of.freely : of.wheels) += energy;
    Vec3 angle = rolls && !b.free ? Vec3(at(rolled_, i) + integration_.step * b.w) : Vec3::Zero();
    std::copy_n(angle.data(), 3, rolled_.begin() + static_cast<std::ptrdiff_t>(3 * i));
    of.wheel = of.wheel || angle.norm() > tuning::kWheel;
    if (const MovingBody* by = carrier(b, bodies)) {
      lost_first_[i] = first, lost_second_[i] = second;
      const double weight = -b.body.mass() * gravity_.dot(b.x - by->x);
      if (!(seen_[i] > 0)) lifted_[i] = weight;
      seen_[i] = std::max({seen_[i], b.turns + b.energy_of(b.v - by->rigid().at(b.x)), std::abs(weight - lifted_[i])});
    } else if (seen_[i] > 0) {
      most_ = of_carried(), seen_[i] = lost_seen_[i] = 0;
    }
  }
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Rolling& of = rolling[i];
    Island& island = of_island_[i];
    const double rolls = of.freely + of.wheels + (of.wheels > 0 ? of.hanging : 0);
    double lost = changes > 0 ? now.lost * (of.changes / changes) : 0;
    if (lost > tuning::kImpact * rolls) lost = 0;  // of an impact
    if (of.wheels == 0) island.before_wheel = 0;
    if (of.wheels > 0 && !of.wheel) {
      island.before_wheel += lost;
    } else {
      lost += std::exchange(island.before_wheel, 0);
      island.first = std::max(island.first, lost), island.second = std::max(island.second, lost);
    }
  }
}

void TurningLoss::step(bool first_order) {
  const bool second = integration_.second_order && !first_order;
  for (Island& island : of_island_) island.sum += second ? island.second : island.first;
  given_ += second ? given_second_ : given_first_;
  const std::vector<double>& of_step = second ? lost_second_ : lost_first_;
  for (std::size_t i = 0; i < of_step.size(); ++i)
    if (seen_[i] > 0) lost_seen_[i] += of_step[i];
}

double TurningLoss::sum() const {
  double sum = std::isnan(integration_.step) ? NAN : 0;
  for (const Island& island : of_island_) sum += island.sum;
  return sum;
}

double TurningLoss::of_carried() const {
  double most = most_;
  for (std::size_t i = 0; i < lost_seen_.size(); ++i)
    if (seen_[i] > 0) most = std::max(most, lost_seen_[i] / seen_[i]);
  return most;
}

double TurningLoss::of_its_own() const {
  double most = of_carried();
  for (const Island& island : of_island_)
    if (const double had = std::max(island.most, island.fed > 0 ? work_ : 0); had > 0 && !(island.motored > 0))
      most = std::max(most, island.sum / had);
  return most;
}

void TurningLoss::checkpoint(Archive& archive) {
  islands_.checkpoint(archive);
  archive_all(archive, "turning.islands", of_island_);
  archive.io("turning.weight", weight_);
  archive.io("turning.work", work_);
  archive.io("turning.given", given_);
  archive.io("turning.most", most_);
  archive.io("turning.rolled", rolled_);
  for (auto [name, v] : {std::pair{"turning.seen", &seen_}, {"turning.lost_seen", &lost_seen_}, {"turning.lifted", &lifted_}}) archive.io(name, *v);
}

}  // namespace mortise::audit
