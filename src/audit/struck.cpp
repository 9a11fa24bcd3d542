#include "audit/struck.h"

#include <algorithm>
#include <cmath>

#include "audit/archived.h"
#include "audit/tuning.h"
#include "audit/vector_at.h"

namespace mortise::audit {

namespace {

// Energy of motion along n of what hangs together, for changes dv of the centres of its bodies and dw of how they turn; what is free turns as it
// likes.
template <class Change>
double moves(const std::vector<MovingBody>& bodies, std::size_t group, const Vec3& n, const Change& change) {
  double sum = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const MovingBody& b = bodies[i];
    if (b.group != group) continue;
    sum += 0.5 * b.body.mass() * std::pow(change(2 * i).dot(n), 2);
    if (!b.free) sum += b.turning_of(change(2 * i + 1));
  }
  return sum;
}

double stored(const std::vector<MovingBody>& bodies, std::size_t group, double on, const std::vector<double>& elastic) {
  double sum = on >= 0 ? elastic[static_cast<std::size_t>(on)] : 0;
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (bodies[i].group == group) sum += elastic[i];
  return sum;
}

}  // namespace

void Struck::begin(Strike& s, const std::vector<MovingBody>& bodies, std::size_t group, const Vec3& n) const {
  s = {.rises = 1, .largest = s.largest, .meant = s.meant, .then = s.then, .before_then = s.before_then};
  double most = 0;
  for (const MovingBody& b : bodies)
    if (b.group == group && b.push.norm() > most) most = b.push.norm(), s.on = b.on ? static_cast<double>(*b.on) : -1;
  const Vec3 there = s.on >= 0 ? Vec3(at(last_, 2 * static_cast<std::size_t>(s.on))) : Vec3::Zero();
  s.brought = moves(bodies, group, n, [&](std::size_t k) { return Vec3(at(last_, k) - (k % 2 == 0 ? there : Vec3::Zero())); });
  s.stored = stored(bodies, group, s.on, elastic_);
}

// The last state may have been one of a largest force.
void Struck::see_peak(Strike& s, double force, double energy) const {
  const double bends = 2 * s.then - s.before_then - force;
  if (integration_.second_order && energy > 0 && s.then > 0 && s.then == s.largest && s.then > force)
    s.meant = std::max(s.meant, s.then + tuning::kPeak * bends);
  s.before_then = s.then, s.then = force;
}

void Struck::state(const std::vector<MovingBody>& bodies, const std::vector<double>& elastic) {
  if (bodies.empty()) return;
  strikes_.resize(bodies.size());
  std::vector<double> now = velocities(bodies);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    Strike& s = strikes_[i];
    s.moves_first = s.moves_second = s.forces_first = s.forces_second = 0;
    Vec3 push = Vec3::Zero(), pulled = Vec3::Zero();
    bool touches = false, counts = bodies[i].group == i;
    for (const MovingBody& b : bodies) {
      if (b.group != i) continue;
      push += b.push, pulled += b.body.mass() * b.a;
      touches = touches || b.touches || b.stopped, counts = counts && !b.given && !b.damped;
    }
    if (!counts) continue;
    see_peak(s, touches ? push.norm() : 0, stored(bodies, i, s.on, elastic));
    if (!touches) {
      s.flew = 1, s.rises = 0;
      continue;
    }
    const double force = push.norm();
    s.largest = std::max(s.largest, force);
    if (!(force > 0)) continue;
    const Vec3 n = push / force;
    if (s.flew > 0) begin(s, bodies, i, n);
    if (!(s.rises > 0)) continue;
    const auto changed = [&](std::size_t k) { return Vec3(at(now, k) - at(last_, k)); };
    const auto bent = [&](std::size_t k) { return Vec3(changed(k) - (before_.empty() ? Vec3::Zero() : Vec3(at(last_, k) - at(before_, k)))); };
    s.moves_first = moves(bodies, i, n, changed), s.moves_second = 0.5 * moves(bodies, i, n, bent);
    s.forces_first = std::pow(force - s.last, 2), s.forces_second = 0.5 * std::pow(force - 2 * s.last + s.before, 2);
    s.force = force, s.pressed = std::clamp(force - pulled.dot(n), 0.0, force);
    s.energy = stored(bodies, i, s.on, elastic) - s.stored;
  }
  before_ = std::move(last_), last_ = std::move(now), elastic_ = elastic;
}

void Struck::step(bool first_order) {
  for (Strike& s : strikes_) {
    if (!(s.rises > 0)) continue;
    if (s.force < s.last) {
      s.rises = 0;
      continue;
    }
    const bool second = integration_.second_order && !first_order;
    s.moves += second ? s.moves_second : s.moves_first, s.forces += second ? s.forces_second : s.forces_first;
    s.before = s.last, s.last = s.force;
    if (!(s.energy > 0)) continue;
    const double k = s.force * s.force / (2 * s.energy), P = s.pressed;
    if (2 * k * s.brought > tuning::kBrings * P * P)
      s.meant = std::max(s.meant, P + std::sqrt(std::pow(s.force - P, 2) + 2 * k * s.moves + s.forces));
  }
}

double Struck::share() const {
  double most = NAN;
  for (const Strike& s : strikes_)
    if (s.meant > 0) most = std::fmax(most, std::max(1 - s.largest / s.meant, 0.0));
  return most;
}

void Struck::checkpoint(Archive& archive) {
  archive_all(archive, "struck.strikes", strikes_);
  for (auto [name, of] : {std::pair{"struck.last", &last_}, {"struck.before", &before_}, {"struck.elastic", &elastic_}}) archive.io(name, *of);
}

}  // namespace mortise::audit
