#include "audit/to_and_fro_loss.h"

#include <algorithm>
#include <cmath>

#include "audit/archived.h"
#include "audit/least_of_last.h"
#include "audit/tuning.h"

namespace mortise::audit {

namespace {

using Vector = Eigen::Map<Vec3>;
using Squares = Eigen::Array3d;

// Of the changes along contact that are the lesser in all, by axis.
Squares lesser(const MovingBody& b, const Vec3& one, const Vec3& other) {
  const Squares a = b.along_contact(one).array().square(), c = b.along_contact(other).array().square();
  return a.sum() < c.sum() ? a : c;
}

// D by axis, no more in all than in the steps before.
void take(const Squares& D, double (&lasts)[3], double (&out)[3]) {
  const double all = D.sum(), least = least_of_last(lasts, all);
  for (int k = 0; k < 3; ++k) out[k] = all > 0 ? D[k] * (least / all) : 0;
}

}  // namespace

bool ToAndFroLoss::counts(const MovingBody& b, const std::vector<MovingBody>& bodies, double slowest) {
  const MovingBody* on = b.on ? &bodies[*b.on] : nullptr;
  const bool shaken = on && on->given && on->rigid().at(b.pressed).norm() > slowest;
  return b.free && b.touches && !b.body.soft() && !(on && on->body.soft()) && !shaken;
}

void ToAndFroLoss::state(const std::vector<double>& points, const std::vector<MovingBody>& bodies) {
  if (std::isnan(integration_.step)) return;
  bodies_.resize(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const MovingBody& b = bodies[i];
    Body& of = bodies_[i];
    std::fill_n(of.first, 3, 0.0), std::fill_n(of.second, 3, 0.0);
    if (of.radius == 0) of.radius = b.body.radius(b.x, points);
    if (!counts(b, bodies, tuning::kShakes * of.radius / integration_.step)) {
      of.states = 0;
      continue;
    }
    const Vec3 v = b.v, seen = b.on ? Vec3(b.v - bodies[*b.on].rigid().at(b.pressed)) : b.v;
    const double m = b.body.mass();
    const Vector v1(of.v[0]), v2(of.v[1]), seen1(of.seen[0]), seen2(of.seen[1]);
    if (of.states == 0) std::fill_n(&of.lasts[0][0], 6, 0.0);
    if (of.states >= 1) take(m / 2 * lesser(b, v - v1, seen - seen1), of.lasts[0], of.first);
    if (of.states >= 2) take(m / 4 * lesser(b, v - 2 * v1 + v2, seen - 2 * seen1 + seen2), of.lasts[1], of.second);
    for (int k = 0; k < 3; ++k) {
      of.to[k] = std::max(of.to[k], seen[k]), of.fro[k] = std::max(of.fro[k], -seen[k]);
      of.way[k] += integration_.step * seen[k];
      of.most[k] = std::max(of.most[k], of.way[k]), of.least[k] = std::min(of.least[k], of.way[k]);
    }
    of.moved = std::max(of.moved, std::min(b.energy(), b.energy_of(seen)));
    std::copy_n(of.v[0], 3, of.v[1]), std::copy_n(of.seen[0], 3, of.seen[1]);
    Vector(of.v[0]) = v, Vector(of.seen[0]) = seen;
    ++of.states;
  }
}

void ToAndFroLoss::step(bool first_order) {
  for (Body& of : bodies_)
    for (int k = 0; k < 3; ++k) of.sum[k] += (integration_.second_order && !first_order ? of.second : of.first)[k];
}

double ToAndFroLoss::Body::share() const {
  double lost = 0;
  for (int k = 0; k < 3; ++k)
    if (most[k] - least[k] > tuning::kToAndFro * radius && fro[k] > 0 && to[k] > 0)
      lost += std::min(fro[k], to[k]) / std::max(fro[k], to[k]) * sum[k];
  return moved > 0 ? std::min(lost / moved, 1.0) : 0;
}

double ToAndFroLoss::share() const {
  double most = 0;
  for (const Body& of : bodies_) most = std::max(most, of.share());
  return most;
}

void ToAndFroLoss::checkpoint(Archive& archive) { archive_all(archive, "to_and_fro", bodies_); }

}  // namespace mortise::audit
