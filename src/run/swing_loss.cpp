#include "run/swing_loss.h"

#include <algorithm>

#include "run/tuning.h"
#include "run/vector_at.h"

namespace mortise::run {

namespace {

// What a group is seen from.
geometry::RigidVelocity seen_from(const std::vector<MovingBody>& bodies, std::size_t group) {
  geometry::RigidVelocity out;
  double mass = 0;
  bool held = false;
  for (const MovingBody& b : bodies) {
    if (b.group != group) continue;
    if (b.carrier) return {bodies[*b.carrier].x, bodies[*b.carrier].v, bodies[*b.carrier].w};
    held = held || b.held;
    mass += b.body.mass(), out.v += b.body.mass() * b.v;
  }
  if (held) return {};
  out.v /= mass;
  return out;
}

bool may_swing(const MovingBody& b) { return b.swings && !b.free && !b.damped && !b.body.soft(); }

}  // namespace

double SwingLoss::changed(const MovingBody& b, const Speeds& by) const {
  return std::min(b.energy_of(by.segment<3>(0)) + b.turning_of(by.segment<3>(3)), b.energy_of(by.segment<3>(6)) + b.turning_of(by.segment<3>(9)));
}

void SwingLoss::state(const std::vector<double>& points, const std::vector<MovingBody>& bodies) {
  swings_.resize(bodies.size()), way_.resize(3 * bodies.size());
  std::vector<bool> touches(bodies.size(), false);
  for (const MovingBody& b : bodies)
    if (b.touches || b.stopped) touches[b.group] = true;
  for (Swing& s : swings_) s.first = s.second = 0;
  std::vector<double> moved(bodies.size(), 0.0);
  std::vector<Speeds> now(bodies.size(), Speeds::Zero());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const MovingBody& b = bodies[i];
    if (!may_swing(b)) continue;
    Swing& s = swings_[b.group];
    const geometry::RigidVelocity from = seen_from(bodies, b.group);
    const Vec3 v = b.v - from.at(b.x), w = b.w - from.w;
    now[i] << b.v, b.w, v, w;
    moved[b.group] += b.energy_of(v) + b.turning_of(w);
    const Vec3 way = at(way_, i) + integration_.step * v;
    std::copy_n(way.data(), 3, way_.begin() + static_cast<std::ptrdiff_t>(3 * i));
    if (s.far == 0 && way.norm() > tuning::kSwings * radius_of_group(bodies, b, points)) s.far = 1;
    if (touches[b.group] || last_.empty()) continue;
    s.first += 2 * changed(b, now[i] - last_[i]);
    if (!before_.empty()) s.second += changed(b, now[i] - 2 * last_[i] + before_[i]);
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
  std::vector<double> swings;
  for (const Swing& s : swings_) swings.insert(swings.end(), {s.sum, s.moved, s.far});
  archive.io("swing.sums", swings);
  archive.io("swing.way", way_);
  for (auto [name, speeds] : {std::pair{"swing.last", &last_}, {"swing.before", &before_}}) {
    std::vector<double> flat;
    for (const Speeds& s : *speeds) flat.insert(flat.end(), s.data(), s.data() + s.size());
    archive.io(name, flat);
    if (!archive.loading()) continue;
    speeds->resize(flat.size() / Speeds::SizeAtCompileTime);
    for (std::size_t i = 0; i < speeds->size(); ++i) (*speeds)[i] = Eigen::Map<const Speeds>(flat.data() + Speeds::SizeAtCompileTime * i);
  }
  if (!archive.loading()) return;
  swings_.assign(swings.size() / 3, {});
  for (std::size_t i = 0; i < swings_.size(); ++i) swings_[i] = {swings[3 * i], 0, 0, swings[3 * i + 1], swings[3 * i + 2]};
}

}  // namespace mortise::run
