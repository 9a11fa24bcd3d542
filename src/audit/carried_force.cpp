#include "audit/carried_force.h"

#include <algorithm>
#include <cmath>

#include "audit/archived.h"
#include "audit/tuning.h"
#include "audit/vector_at.h"

namespace mortise::audit {

namespace {

using Vector = Eigen::Map<Vec3>;

// What goes as the scene says and carries a stiff body by something that gives and that no motor damps, or by something soft between.
std::optional<std::size_t> carrier_of(const MovingBody& b, const std::vector<MovingBody>& bodies) {
  if (b.given || b.body.soft()) return {};
  std::optional<std::size_t> by;
  if (b.swings) by = b.carrier;
  if (!by && b.free && b.on && bodies[*b.on].body.soft()) by = b.on;
  for (std::size_t turns = 0; by && bodies[*by].body.soft() && turns < bodies.size(); ++turns)
    by = bodies[*by].bonded ? bodies[*by].bonded : bodies[*by].carrier;
  return by && bodies[*by].given && !bodies[*by].body.soft() ? by : std::nullopt;
}

}  // namespace

void CarriedForce::Axis::see(double a, double beside) { largest = std::max(largest, std::abs(a)), meant = std::max(meant, std::abs(a + beside)); }

double CarriedForce::Body::share() const {
  double most = 0, of = force;
  for (const Axis& axis : axes) most = std::max(most, std::abs(axis.meant - axis.largest)), of = std::max(of, axis.meant);
  return of > 0 ? most / of : NAN;
}

void CarriedForce::follow(Body& body, const MovingBody& b, const Vec3& there, double rounding) const {
  const double h = integration_.step;
  const Vec3 a = b.a - gravity_, changed = b.a - at(body.a, 0), slope = (b.x - at(body.x, 0)) / h;
  const Vec3 carried = integration_.second_order ? Vec3((there + at(body.carrier, 0)) / 2) : there;
  const Vec3 r = h * (slope - carried), v = b.v - there - at(body.seen, 0);
  body.unrest = std::max(body.unrest, changed.norm());
  if (changed.norm() <= std::max(tuning::kSettled * body.unrest, rounding / (h * h))) body.settled = 1;
  body.force = std::max({body.force, a.norm(), b.push.norm() / b.body.mass()});
  for (int d = 0; d < 3; ++d) {
    Axis& axis = body.axes[d];
    axis.swing.fit(r[d], v[d], changed[d]);
    axis.see(a[d], body.settled ? axis.swing.swing(body.a[d], b.a[d], slope[d] - body.slope[d], h) : 0);
  }
  Vector(body.slope) = slope;
}

void CarriedForce::state(const std::vector<double>& points, const std::vector<MovingBody>& bodies) {
  if (std::isnan(integration_.step) || bodies.empty()) return;
  bodies_.resize(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const MovingBody& b = bodies[i];
    Body& body = bodies_[i];
    const std::optional<std::size_t> by = carrier_of(b, bodies);
    if (!by || body.by != static_cast<double>(*by)) {  // only what was largest stays
      body.states = body.unrest = body.settled = 0, body.by = by ? static_cast<double>(*by) : -1;
      for (Axis& axis : body.axes) axis = {.largest = axis.largest, .meant = axis.meant};
    }
    if (!by) continue;
    const Vec3 there = bodies[*by].rigid().at(b.x);
    if (++body.states > 2)
      follow(body, b, there, tuning::kNoWay * b.body.radius(b.x, points));
    else if (body.states > 1)
      Vector(body.slope) = (b.x - at(body.x, 0)) / integration_.step;
    Vector(body.x) = b.x, Vector(body.seen) = b.v - there, Vector(body.carrier) = there, Vector(body.a) = b.a;
  }
}

double CarriedForce::share() const {
  double most = NAN;
  for (const Body& b : bodies_) most = std::fmax(most, b.share());
  return most;
}

void CarriedForce::checkpoint(Archive& archive) { archive_all(archive, "carried_force.bodies", bodies_); }

}  // namespace mortise::audit
