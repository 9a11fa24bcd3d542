#include "audit/bounce_loss.h"

#include <algorithm>
#include <cmath>

#include "audit/archived.h"
#include "audit/tuning.h"
#include "audit/vector_at.h"

namespace mortise::audit {

namespace {

// What hangs together.
struct Group {
  double moves = 0, turns = 0;   // energy of motion of the centres, and of turning [J]
  double changed = 0;            // energy of its change of velocity [J]
  double mass = 0;               // [kg]
  Vec3 momentum = Vec3::Zero();  // [kg m/s]
  bool touches = false, given = false, swings = true;
};

std::vector<Group> groups_of(const std::vector<MovingBody>& bodies, const OwnEnergy& own) {
  std::vector<Group> out(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const MovingBody& b = bodies[i];
    Group& g = out[b.group];
    g.moves += b.energy(), g.turns += b.turns, g.changed += own.change(i);
    g.mass += b.body.mass(), g.momentum += b.body.mass() * b.v;
    g.touches = g.touches || b.touches || b.stopped, g.given = g.given || b.given, g.swings = g.swings && b.swings;
  }
  return out;
}

// Least energy of motion of a group, as seen from the world or from another body [J].
double moved_beside(const std::vector<MovingBody>& bodies, std::size_t group, const Group& g) {
  double least = g.moves;
  for (const MovingBody& b : bodies)
    if (b.group != group) least = std::min(least, g.moves - b.v.dot(g.momentum) + 0.5 * g.mass * b.v.squaredNorm());
  return g.turns + std::max(least, 0.0);
}

}  // namespace

double BounceLoss::struck(const std::vector<MovingBody>& bodies, std::size_t group, const Vec3& fall) const {
  const Contact& c = contacts_[group];
  double changed = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const MovingBody& b = bodies[i];
    if (b.group != group) continue;
    const Vec3 weight = b.free ? Vec3(c.steps * fall) : Vec3::Zero(), dv = b.v - at(flew_, 2 * i) - weight;
    if (weight.norm() > tuning::kWeight * dv.norm()) return 0;
    changed += b.energy_of(dv) + b.turning_of(b.w - at(flew_, 2 * i + 1));
  }
  const double r = changed > 0 ? std::min(c.own / changed, 1.0) : 0;
  return (1 + r) * (1 + r) / 4 * changed;
}

// What of the motion in flight went against what presses it now, where that is; a body that comes to slide brings next to nothing.
double BounceLoss::against(const std::vector<MovingBody>& bodies, std::size_t group) const {
  double most = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const MovingBody& b = bodies[i];
    if (b.group != group || !(b.touches || b.stopped)) continue;
    const Vec3 u = geometry::RigidVelocity{b.x, at(flew_, 2 * i), at(flew_, 2 * i + 1)}.at(b.pressed);
    const double along = u.dot(b.push), all = u.squaredNorm() * b.push.squaredNorm();
    most = std::max(most, b.touches && all > 0 ? along * along / all : 1.0);
  }
  return most;
}

void BounceLoss::state(const std::vector<MovingBody>& bodies, double lost, const OwnEnergy& own) {
  if (bodies.empty()) return;
  if (contacts_.empty()) contacts_.resize(bodies.size()), flew_.resize(6 * bodies.size());
  const std::vector<Group> groups = groups_of(bodies, own);
  const bool soft = soft_touches(bodies);
  double changed = 0, ended = 0, flies = 0, impact = 0;
  for (const Group& g : groups)
    if (!g.given) changed += g.changed;
  brought_ = 0;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const Group& g = groups[i];
    if (bodies[i].group != i || g.given) continue;
    Contact& c = contacts_[i];
    const double energy = bodies[i].free ? g.moves : g.moves + g.turns;  // what is free turns as it likes
    // Half of what a vibration loses is that of its changes of velocity (vibration_loss.h).
    const double part = changed > 0 ? std::min(lost * g.changed / changed, 2 * g.changed) : 0;
    c.moved = std::max(c.moved, moved_beside(bodies, i, g));
    if (c.steps > 0) c.lost += lost, c.own += part;  // in the step that ends a contact, too
    if (!g.touches) {
      const bool rested = c.slow >= tuning::kRested && c.slow >= tuning::kRestedShare * c.steps;
      if (g.swings && c.steps > 0 && !rested) {
        const double most = struck(bodies, i, own.fall());
        c.most = std::max(c.most, most);
        (c.soft > 0 ? c.bounced : c.doubted) += std::min({c.own, most, c.soft > 0 ? most : g.moves + g.turns});
        if (c.soft > 0)
          ended = std::max(ended, std::min(c.lost, c.before));
        else
          flies += g.moves + g.turns, impact = std::max(impact, c.lost);
      }
      c.steps = -1, c.before = energy;
      continue;
    }
    if (c.steps < 0) c.steps = c.slow = c.lost = c.soft = c.own = 0, brought_ += against(bodies, i) * c.before;
    if (std::isnan(c.before)) continue;
    if (++c.steps == 1) c.lost += lost, c.own += part;
    if (soft) c.soft = 1;
    if (energy < tuning::kSlow * c.before) ++c.slow;
  }
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (groups[bodies[i].group].touches) continue;
    std::copy_n(bodies[i].v.data(), 3, flew_.begin() + static_cast<std::ptrdiff_t>(6 * i));
    std::copy_n(bodies[i].w.data(), 3, flew_.begin() + static_cast<std::ptrdiff_t>(6 * i + 3));
  }
  sum_ += ended, stiff_ += std::min(flies, impact);
}

double BounceLoss::own() const { return own(&Contact::bounced, tuning::kSeen); }
double BounceLoss::own_stiff() const { return own(&Contact::doubted, tuning::kSeenStiff); }

double BounceLoss::own(double Contact::*of, double seen) const {
  double share = 0;
  for (const Contact& c : contacts_)
    if (c.most > seen * c.moved) share = std::max(share, c.*of / c.most);
  return std::min(share, 1.0);
}

void BounceLoss::checkpoint(Archive& archive) {
  archive_all(archive, "bounce.contacts", contacts_);
  archive.io("bounce.flew", flew_);
  archive.io("bounce.sum", sum_);
  archive.io("bounce.stiff", stiff_);
}

}  // namespace mortise::audit
