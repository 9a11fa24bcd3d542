#include "audit/swing_loss.h"

#include <algorithm>

#include "audit/archived.h"
#include "audit/least_of_last.h"
#include "audit/tuning.h"
#include "audit/vector_at.h"
#include "model/held_points.h"

namespace mortise::audit {

namespace {

// values + times * others
std::vector<double> sum_of(std::vector<double> values, double times, const std::vector<double>& others) {
  for (std::size_t i = 0; i < values.size(); ++i) values[i] += times * others[i];
  return values;
}

}  // namespace

SwingLoss::SwingLoss(const model::ModelInput& input) : integration_(integration_of(input.scene)), held_(model::held_points(input)) {
  std::size_t points = 0, bodies = 0;
  for (const model::BodyInput& b : input.bodies) {
    if (b.type == model::BodyType::half_space) continue;
    points += b.nodes.size(), ++bodies;
  }
  changes_.resize(bodies), swings_.resize(2 * bodies);
  way_.resize(3 * points);
}

bool SwingLoss::counts(const MovingBody& b) const {
  return b.body.soft() ? swings_[b.swings_with].touched == 0 : (b.swings || b.swings_on) && !b.free && !b.damped;
}

geometry::RigidVelocity SwingLoss::seen_from(const std::vector<MovingBody>& bodies, std::size_t body, const std::vector<double>& points,
                                             const std::vector<double>& velocity) const {
  const MovingBody& b = bodies[body];
  if (b.body.soft()) {
    std::vector<Vec3> x, v;
    for (std::size_t p = b.body.first; p < b.body.first + b.body.count; ++p)
      if (held_[p]) x.push_back(at(points, p)), v.push_back(at(velocity, p));
    return geometry::fixes_a_frame(x) ? geometry::nearest_velocity(x, v) : b.rigid();
  }
  if (b.swings_on) return bodies[*b.swings_on].rigid();
  if (b.carrier) return bodies[*b.carrier].rigid();
  geometry::RigidVelocity out;
  double mass = 0;
  int count = 0;
  for (const MovingBody& other : bodies)
    if (other.group == b.group) mass += other.body.mass(), out.v += other.body.mass() * other.v, ++count;
  if (count == 1) return {};
  out.v /= mass;
  return out;
}

SwingLoss::Velocities SwingLoss::velocities(const Snapshot& said, const std::vector<double>& points, const std::vector<MovingBody>& bodies) const {
  const Snapshot::Values& v = *said.of_points("velocity", 3);
  Velocities out{{v.begin(), v.end()}, {v.begin(), v.end()}};
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const MovingBody& b = bodies[i];
    if (!counts(b)) continue;
    const geometry::RigidVelocity from = seen_from(bodies, i, points, out.v);
    for (std::size_t p = b.body.first; p < b.body.first + b.body.count; ++p) Eigen::Map<Vec3>(out.seen.data() + 3 * p) -= from.at(at(points, p));
  }
  return out;
}

void SwingLoss::look_how_far(const MovingBody& b, const std::vector<double>& seen, const std::vector<double>& points, Swing& swing) {
  const double far = tuning::kStill * b.body.radius(b.x, points);
  for (std::size_t p = b.body.first; p < b.body.first + b.body.count; ++p) {
    Eigen::Map<Vec3> way(way_.data() + 3 * p);
    way += integration_.step * at(seen, p);
    if (way.norm() > far) swing.far = 1;
  }
}

void SwingLoss::state(const Snapshot& said, const std::vector<double>& points, const std::vector<MovingBody>& bodies,
                      const std::vector<double>& elastic) {
  for (Swing& s : swings_) s.first = s.second = 0;
  for (const MovingBody& b : bodies)
    if (b.touches && b.body.soft()) swings_[b.swings_with].touched = 1;
  if (std::none_of(bodies.begin(), bodies.end(), [this](const MovingBody& b) { return counts(b); })) return;
  Velocities now = velocities(said, points, bodies);
  std::vector<double> moved(swings_.size(), 0.0);
  std::vector<std::vector<double>> changes, second;  // of v and v'
  if (!last_.v.empty()) changes = {sum_of(now.v, -1, last_.v), sum_of(now.seen, -1, last_.seen)};
  if (!before_.v.empty())
    second = {sum_of(sum_of(changes[0], -1, last_.v), 1, before_.v), sum_of(sum_of(changes[1], -1, last_.seen), 1, before_.seen)};
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const MovingBody& b = bodies[i];
    if (!counts(b)) continue;
    const auto energy = [&](const std::vector<std::vector<double>>& of) {
      return of.empty() ? 0 : std::min(b.body.kinetic_energy(of[0], points), b.body.kinetic_energy(of[1], points));
    };
    Swing& s = swings_[b.swings_with];
    s.stored = std::max(s.stored, elastic[i]);
    if (changes.empty()) continue;  // at the start nobody knows how fast carriers are
    moved[b.swings_with] += std::min(b.body.kinetic_energy(now.v, points), b.body.kinetic_energy(now.seen, points));
    look_how_far(b, now.seen, points, s);
    const double of_first = 2 * least_of_last(changes_[i].first, energy(changes)), of_second = least_of_last(changes_[i].second, energy(second));
    if (!b.touches && !b.stopped) s.first += of_first, s.second += of_second;
  }
  for (std::size_t i = 0; i < swings_.size(); ++i) swings_[i].moved = std::max(swings_[i].moved, moved[i]);
  before_ = std::move(last_), last_ = std::move(now);
}

void SwingLoss::step(bool first_order) {
  for (Swing& s : swings_) s.sum += integration_.second_order && !first_order ? s.second : s.first;
}

double SwingLoss::share() const {
  double most = 0;
  for (const Swing& s : swings_)
    if (s.far > 0 && s.moved > 0) most = std::max(most, s.sum / std::max(s.moved, tuning::kShownBySwing * s.stored));
  return most;
}

void SwingLoss::checkpoint(Archive& archive) {
  archive_all(archive, "swing.swings", swings_);
  archive_all(archive, "swing.changes", changes_);
  for (auto [name, of] : {std::pair{"swing.v", &last_.v},
                          {"swing.seen", &last_.seen},
                          {"swing.v_before", &before_.v},
                          {"swing.seen_before", &before_.seen},
                          {"swing.way", &way_}})
    archive.io(name, *of);
}

}  // namespace mortise::audit
