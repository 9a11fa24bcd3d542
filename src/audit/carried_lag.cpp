#include "audit/carried_lag.h"

#include "audit/archived.h"
#include "audit/tuning.h"

namespace mortise::audit {

void CarriedLag::start(const MovingBody& body, const std::vector<double>& points) {
  carried_.emplace_back();
  ways_.start(body.v, tuning::kCarriedStill * 2 * body.body.radius(body.x, points));
}

double CarriedLag::lag(std::size_t i, const std::vector<MovingBody>& bodies, double h) {
  const MovingBody& b = bodies[i];
  Carried& c = carried_[i];
  const std::optional<std::size_t> by = !b.free ? b.carrier : b.push.isZero() ? std::nullopt : b.on;
  if (!by) return c.lag;
  const MovingBody& carrier = bodies[*by];
  Vec3 there = carrier.rigid().at(b.x), v = b.v - there;
  const Vec3 turns = there - carrier.v;
  if (b.free) there = b.across_push(there), v = b.across_push(v);
  if (c.by != static_cast<double>(*by) || turns.norm() > tuning::kStill * there.norm()) {
    ways_.restart(i, v);
    c = {.by = static_cast<double>(*by)};
    return 0;
  }
  // How fast pinned bodies start nobody knows: as if the first step had been like the second.
  if (!b.free && c.steps == 0) ways_.restart(i, 2 * ways_.v0(i) - v);
  Eigen::Map<Vec3> way(c.carrier), along(c.along);
  way += h * there, along += h * v;
  const double lag = ways_.lag(i, along, v, h, static_cast<long>(++c.steps));
  return c.lag = way.norm() > ways_.far(i) ? lag : 0;
}

void CarriedLag::checkpoint(Archive& archive) {
  archive_all(archive, "lag.carried", carried_);
  ways_.checkpoint(archive, "lag.along");
}

}  // namespace mortise::audit
