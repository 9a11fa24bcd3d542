#include "audit/carried_lag.h"

#include "audit/archived.h"
#include "audit/tuning.h"
#include "audit/vector_at.h"

namespace mortise::audit {

void CarriedLag::start(const MovingBody& body, const std::vector<double>& points) {
  carried_.emplace_back();
  ways_.start(body.v, (body.free ? tuning::kStill : tuning::kCarriedStill) * 2 * body.body.radius(body.x, points));
}

double CarriedLag::hardly(std::size_t i, double h) const { return tuning::kHardly * ways_.least(i) / h; }

// Did the carrier's speed jump by the change before this one? Then the way begins with what the body's was then.
void CarriedLag::set_off(std::size_t i, Carried& c, const Vec3& changed, double h) {
  const Vec3 jump = at(c.changed, 0), v = at(c.v, 0);
  if (c.steps < 2 || !(jump.norm() > std::max({tuning::kSetsOff * changed.norm(), tuning::kSetsOff * c.changed_before, hardly(i, h)}))) return;
  ways_.restart(i, at(c.before, 0) - jump);
  ways_.lag(i, h * v, v, h, 1);
  Eigen::Map<Vec3>(c.along) = h * v, c.steps = 1;
}

double CarriedLag::lag(std::size_t i, const std::vector<MovingBody>& bodies, double h, long steps) {
  const MovingBody& b = bodies[i];
  Carried& c = carried_[i];
  const bool squeezed = b.push.isZero();
  std::optional<std::size_t> by = b.free ? b.on : b.carrier;
  if (b.free && squeezed && by) by = bodies[*by].carrier;
  if (!by) return c.lag;
  const MovingBody& carrier = bodies[*by];
  Vec3 there = carrier.rigid().at(b.x), v = b.v - there;
  const Vec3 turns = there - carrier.v;
  if (b.free && !squeezed) there = b.across_push(there), v = b.across_push(v);
  if (c.by != static_cast<double>(*by) || turns.norm() > std::max(tuning::kStill * there.norm(), hardly(i, h))) {
    ways_.restart(i, v);
    c = {.by = static_cast<double>(*by), .onset = SlipOnset(steps <= tuning::kFromRest)};
    return 0;
  }
  // How fast pinned bodies start nobody knows: as if the first step had been like the second.
  if (!b.free && c.steps == 0) ways_.restart(i, 2 * ways_.v0(i) - v);
  using Vector = Eigen::Map<Vec3>;
  const Vec3 changed = there - Vector(c.there);
  if (b.free && (c.steps > 0 || steps - 1 <= tuning::kFromRest)) c.onset.step(changed, changed + v - Vector(c.v), v, h);
  set_off(i, c, changed, h);
  Vector way(c.carrier), along(c.along);
  way += h * there, along += h * v;
  const double of_onset = c.onset.ahead().norm();
  c.far = std::max(c.far, (along - c.onset.ahead()).norm());
  const double lag = std::max(ways_.lag(i, along, v, h, static_cast<long>(++c.steps)), of_onset / std::max(c.far, ways_.least(i)));
  c.changed_before = at(c.changed, 0).norm();
  Vector(c.before) = at(c.v, 0), Vector(c.v) = v, Vector(c.there) = there, Vector(c.changed) = changed;
  return c.lag = way.norm() > ways_.far(i) ? lag : 0;
}

void CarriedLag::checkpoint(Archive& archive) {
  archive_all(archive, "lag.carried", carried_);
  ways_.checkpoint(archive, "lag.along");
}

}  // namespace mortise::audit
