#include "run/swing_loss.h"

#include <algorithm>

#include "run/archived.h"
#include "run/tuning.h"
#include "run/vector_at.h"

namespace mortise::run {

namespace {

// What a group is seen from.
geometry::RigidVelocity seen_from(const std::vector<MovingBody>& bodies, std::size_t group) {
  geometry::RigidVelocity out;
  double mass = 0;
  int count = 0;
  for (const MovingBody& b : bodies) {
    if (b.group != group) continue;
    if (b.carrier) return {bodies[*b.carrier].x, bodies[*b.carrier].v, bodies[*b.carrier].w};
    mass += b.body.mass(), out.v += b.body.mass() * b.v, ++count;
  }
  if (count == 1) return {};
  out.v /= mass;
  return out;
}

bool may_swing(const MovingBody& b) { return b.swings && !b.free && !b.damped && !b.body.soft(); }

// v, w, v', w' of a body.
using Speeds = Eigen::Matrix<double, 12, 1>;

Speeds speeds_at(const std::vector<double>& of, std::size_t i) { return Eigen::Map<const Speeds>(of.data() + Speeds::SizeAtCompileTime * i); }

double energy(const MovingBody& b, const Speeds& by) {
  return std::min(b.energy_of(by.segment<3>(0)) + b.turning_of(by.segment<3>(3)), b.energy_of(by.segment<3>(6)) + b.turning_of(by.segment<3>(9)));
}

// The least of a new value and the last ones, which it is one of from then on.
template <std::size_t n>
double least(double (&last)[n], double now) {
  std::rotate(last, last + 1, last + n);
  last[n - 1] = now;
  return *std::min_element(last, last + n);
}

}  // namespace

void SwingLoss::state(const std::vector<double>& points, const std::vector<MovingBody>& bodies) {
  swings_.resize(bodies.size()), changes_.resize(bodies.size()), way_.resize(3 * bodies.size());
  for (Swing& s : swings_) s.first = s.second = 0;
  std::vector<double> moved(bodies.size(), 0.0);
  std::vector<double> now(Speeds::SizeAtCompileTime * bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const MovingBody& b = bodies[i];
    if (!may_swing(b)) continue;
    Swing& s = swings_[b.group];
    const geometry::RigidVelocity from = seen_from(bodies, b.group);
    const Vec3 v = b.v - from.at(b.x), w = b.w - from.w;
    Speeds speeds;
    speeds << b.v, b.w, v, w;
    std::copy_n(speeds.data(), speeds.size(), now.begin() + speeds.size() * static_cast<std::ptrdiff_t>(i));
    moved[b.group] += b.energy_of(v) + b.turning_of(w);
    const Vec3 way = at(way_, i) + integration_.step * v;
    std::copy_n(way.data(), 3, way_.begin() + static_cast<std::ptrdiff_t>(3 * i));
    if (s.far == 0 && way.norm() > tuning::kStill * b.body.radius(b.x, points)) s.far = 1;
    if (last_.empty()) continue;
    const double first = 2 * least(changes_[i].first, energy(b, speeds - speeds_at(last_, i)));
    const double second = before_.empty() ? 0 : least(changes_[i].second, energy(b, speeds - 2 * speeds_at(last_, i) + speeds_at(before_, i)));
    if (!b.touches && !b.stopped) s.first += first, s.second += second;
  }
  for (std::size_t i = 0; i < bodies.size(); ++i) swings_[i].moved = std::max(swings_[i].moved, moved[i]);
  before_ = std::move(last_), last_ = std::move(now);
}

void SwingLoss::step(bool first_order) {
  for (Swing& s : swings_) s.sum += integration_.second_order && !first_order ? s.second : s.first;
}

double SwingLoss::share() const {
  double most = 0;
  for (const Swing& s : swings_)
    if (s.far > 0 && s.moved > 0) most = std::max(most, s.sum / s.moved);
  return most;
}

void SwingLoss::checkpoint(Archive& archive) {
  archive_all(archive, "swing.swings", swings_);
  archive_all(archive, "swing.changes", changes_);
  for (auto [name, of] : {std::pair{"swing.last", &last_}, {"swing.before", &before_}, {"swing.way", &way_}}) archive.io(name, *of);
}

}  // namespace mortise::run
