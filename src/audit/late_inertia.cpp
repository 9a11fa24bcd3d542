#include "audit/late_inertia.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "audit/archived.h"
#include "audit/least_of_last.h"
#include "audit/tuning.h"

namespace mortise::audit {

namespace {

using Vector = Eigen::Map<Vec3>;

// Forces on what hangs together.
struct Loads {
  Vec3 inertia = Vec3::Zero(), push = Vec3::Zero(), friction = Vec3::Zero();
  double pressed = 0, rubbed = 0;     // without regard to direction
  bool driven = false, soft = false;  // held or driven; something soft touches
};

}  // namespace

void LateInertia::Side::see(double R) { late = std::max(late, least_of_last(last, R)); }

void LateInertia::state(const Snapshot& said, const std::vector<MovingBody>& bodies) {
  if (std::isnan(integration_.step) || bodies.empty()) return;
  const bool second = integration_.second_order;
  if (states_++ < (second ? 3 : 1)) return;  // accelerations are known from then on
  const Snapshot::Values* friction = said.of_points("friction_force", 3);
  std::map<std::size_t, Loads> loads;
  for (const MovingBody& b : bodies) {
    if (b.given) continue;
    Loads& of = loads[b.group];
    of.inertia += b.body.mass() * b.a, of.push += b.push, of.pressed += b.push.norm();
    of.driven = of.driven || b.held || !b.swings;
    of.soft = of.soft || (b.touches && (b.body.soft() || (b.on && bodies[*b.on].body.soft())));
    if (!friction || friction->empty()) continue;
    const Vec3 rubbed = b.body.sum(*friction);
    of.rubbed += rubbed.norm(), of.friction += rubbed;
  }
  groups_.resize(bodies.size());
  for (const auto& [number, of] : loads) {
    Group& group = groups_[number];
    if (!of.driven || !(of.pressed > 0)) {
      group.states = 0;
      continue;
    }
    Vector P1(group.P[0]), P2(group.P[1]), Q1(group.Q[0]), Q2(group.Q[1]);
    const bool known = group.states >= (second ? 2 : 1);
    const bool one_sided = of.push.norm() > of.pressed / 2;
    const Vec3 n = of.push.normalized(), Q = of.inertia - of.friction;
    const auto along = [&](const Vec3& d) { return !of.soft ? 0.0 : one_sided ? std::abs(d.dot(n)) : d.norm(); };
    const auto across = [&](const Vec3& d) { return one_sided && of.rubbed > 0 ? (d - d.dot(n) * n).norm() : 0.0; };
    group.along.see(!known ? 0 : second ? 2.0 / 3 * along(of.inertia - 2 * P1 + P2) : along(of.inertia - P1));
    group.across.see(!known ? 0 : second ? 2.0 / 3 * across(Q - 2 * Q1 + Q2) : std::numbers::pi * across(of.inertia - P1));
    group.along.force = std::max(group.along.force, of.pressed);
    group.across.force = std::max({group.across.force, of.rubbed, tuning::kAcross * of.pressed, across(of.inertia)});
    P2 = P1, P1 = of.inertia, Q2 = Q1, Q1 = Q, ++group.states;
  }
}

// Accelerations of BDF2 are none of such a step, nor of the next.
void LateInertia::step(bool first_order) {
  if (first_order && integration_.second_order)
    for (Group& group : groups_) group.states = 0;
}

double LateInertia::share() const {
  double most = NAN;
  for (const Group& group : groups_) most = std::fmax(most, std::fmax(group.along.share(), group.across.share()));
  return most;
}

void LateInertia::checkpoint(Archive& archive) {
  archive_all(archive, "late_inertia.groups", groups_);
  archive.io("late_inertia.states", states_);
}

}  // namespace mortise::audit
