#include "importers/robot/gait.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "importers/robot/solid.h"

namespace mortise::importers {
namespace {

struct Leg {
  std::size_t upper, lower;  // axes
  Vec3 foot;
};

// The pad that a limb ends in, or its lowest point.
Vec3 foot_of(const Machine& m, std::size_t body) {
  for (const Pad& p : m.pads)
    if (p.body == body) return p.shape.at.t;
  const Body& b = m.bodies[body];
  Vec3 out = b.at.t;
  double lowest = INFINITY;
  for (const Shape& s : b.shapes) {
    const auto [lo, hi] = bounds(s, b.at * s.at);
    if (lo[2] < lowest) lowest = lo[2], out = Vec3(0.5 * (lo[0] + hi[0]), 0.5 * (lo[1] + hi[1]), lo[2]);
  }
  return out;
}

// Two parallel hinges with motors, one on the other, at the end of a limb, that swing it forward and are bent.
std::vector<Leg> legs_of(const Machine& m) {
  const auto turns = [](const Axis& a) {
    return a.type == Joint::Type::revolute && a.mimics < 0 && !a.passive && std::abs(a.direction[0]) < kAcross && std::abs(a.direction[2]) < kAcross;
  };
  std::vector<Leg> out;
  for (std::size_t l = 0; l < m.axes.size(); ++l) {
    const Axis& lower = m.axes[l];
    const auto hangs = [&](const Axis& a) { return a.to == static_cast<std::ptrdiff_t>(lower.body); };
    if (!turns(lower) || lower.to < 0 || std::any_of(m.axes.begin(), m.axes.end(), hangs)) continue;
    for (std::size_t u = 0; u < m.axes.size(); ++u) {
      const Axis& upper = m.axes[u];
      if (static_cast<std::ptrdiff_t>(upper.body) != lower.to || !turns(upper) || upper.direction.cross(lower.direction).norm() > kParallelLeg)
        continue;
      const Vec3 foot = foot_of(m, lower.body), thigh = lower.place - upper.place, shank = foot - lower.place;
      const auto flat = [&](const Vec3& v) -> Vec3 { return v - v.dot(upper.direction) * upper.direction; };
      if (flat(thigh).cross(flat(shank)).norm() > kBent * thigh.norm() * shank.norm()) out.push_back({u, l, foot});
    }
  }
  return out;
}

// Share of a cycle by which a leg is ahead.
double phase_of(const std::string& gait, bool front, bool left) {
  if (gait == "trot") return front == left ? 0 : 0.5;
  if (gait == "pace") return left ? 0 : 0.5;
  if (gait == "bound") return front ? 0 : 0.5;
  return (front ? 0.75 : 0) + (left ? 0 : 0.5) - (front && !left ? 1 : 0);  // walk: hind left, front left, hind right, front right
}

double two_digits(double x) { return std::stod(fmt::format("{:.2g}", x)); }

}  // namespace

void walk(Machine& m, const GaitOptions& o) {
  std::vector<Leg> legs = legs_of(m);
  const auto refuse = [&](const std::string& why) { throw Error(Exit::usage, o.asked + o.type + ": " + why); };
  if (legs.size() != 4)
    refuse("the robot has " + std::to_string(legs.size()) +
           " legs, and four are needed; a leg is two parallel hinges with motors across x, the lower one the last of its limb, and stands bent");
  Vec3 middle = Vec3::Zero();
  double height = 0;
  for (const Leg& l : legs) middle += 0.25 * l.foot, height += 0.25 * (m.axes[l.upper].place[2] - l.foot[2]);
  if (!(height > 0)) refuse("its feet are above its hips");
  int seen[4] = {};
  for (const Leg& l : legs) {
    const bool front = l.foot[0] > middle[0], left = l.foot[1] > middle[1];
    ++seen[2 * front + left];
    for (const std::size_t a : {l.upper, l.lower}) m.axes[a].step = Axis::Step{l.upper, l.lower, l.foot, phase_of(o.type, front, left)};
  }
  if (std::any_of(seen, seen + 4, [](int n) { return n != 1; })) refuse("its feet are not two before two, along x");
  m.gait = Machine::Gait{o.period.value_or(two_digits(kPeriod * std::sqrt(height / 9.81))), o.stride.value_or(two_digits(kStride * height)),
                         o.clearance.value_or(two_digits(kClearance * height)), o.duty.value_or(o.type == "walk" ? kWalkDuty : kTrotDuty)};
}

}  // namespace mortise::importers
