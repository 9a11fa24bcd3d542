#include "audit/slip_reversal.h"

#include <algorithm>

#include "audit/archived.h"
#include "audit/tuning.h"

namespace mortise::audit {

void SlipReversal::state(const Snapshot& said, const std::vector<MovingBody>& bodies) {
  const Snapshot::Values* friction = said.of_points("friction_force", 3);
  if (!integration_.second_order || bodies.empty() || !friction || friction->empty()) return;
  bodies_.resize(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const MovingBody& b = bodies[i];
    Body& of = bodies_[i];
    using Vector = Eigen::Map<Vec3>;
    const bool rides = b.free && b.on && bodies[*b.on].given && !b.push.isZero(0);
    const Vec3 slip = rides ? b.across_push(b.v - bodies[*b.on].rigid().at(b.pressed)) : Vec3(Vec3::Zero());
    of.fastest = std::max(of.fastest, slip.norm());
    const bool slides = std::max(slip.norm(), (slip - Vector(of.slips)).norm()) > tuning::kSlips * of.fastest;
    const bool turns = slides && slip.dot(Vector(of.slips)) < 0;
    if (turns && of.turned != 0) of.late += 2 * integration_.step * of.rate * of.time, of.gone += of.way;
    if (turns || !slides) of.begin(turns);
    of.way += integration_.step * slip.norm(), of.time += integration_.step,
        of.rate = std::max(of.rate, b.body.sum(*friction).norm() / b.body.mass());
    Vector(of.slips) = slip;
  }
}

double SlipReversal::share() const {
  double most = NAN;
  for (const Body& b : bodies_)
    if (b.gone > 0) most = std::fmax(most, b.late / b.gone);
  return most;
}

void SlipReversal::checkpoint(Archive& archive) { archive_all(archive, "slip_reversal", bodies_); }

}  // namespace mortise::audit
