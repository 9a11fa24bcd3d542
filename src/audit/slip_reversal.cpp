#include "audit/slip_reversal.h"

#include <algorithm>

#include "audit/archived.h"
#include "audit/entries.h"
#include "audit/tuning.h"
#include "geometry/bounds.h"

namespace mortise::audit {

SlipReversal::SlipReversal(const model::ModelInput& input) : integration_(integration_of(input.scene)) {
  if (!integration_.second_order) return;
  std::vector<const model::BodyInput*> bodies;
  for (const model::BodyInput& b : input.bodies)
    if (b.type != model::BodyType::half_space) bodies.push_back(&b);
  const Params& effects = input.scene.at("effects");
  for (const Params& drive : entries(effects, "drive")) {
    const std::string name = drive.text("joint");
    const std::optional<Params> joint = joint_named(effects, name);
    if (!drive.has("friction") || !joint || !joint->has("to")) continue;
    for (std::size_t i = 0; i < bodies.size(); ++i)
      if (bodies[i]->name == joint->text("to")) dry_.push_back({"joint/" + name + "_rate", i, geometry::bounds_of(bodies[i]->nodes).size().norm()});
  }
  joints_.resize(dry_.size()), bearings_.resize(dry_.size());
  for (const auto& [effect, law] : friction_laws(input)) creep_ = std::max(creep_, law.creep_speed);
}

void SlipReversal::advance(Slip& slip, const Vec3& v, double rate) const {
  Eigen::Map<Vec3> last(slip.v);
  slip.fastest = std::max(slip.fastest, v.norm());
  const bool slides = std::max(v.norm(), (v - last).norm()) > std::max(tuning::kSlips * slip.fastest, creep_);
  const bool turns = slides && v.dot(last) < 0;
  if (turns && slip.turned != 0) slip.late += 2 * integration_.step * slip.rate * slip.time;
  if (turns || !slides) slip.gone += slip.way, slip.begin(turns);
  slip.way += integration_.step * v.norm(), slip.time += integration_.step, slip.rate = std::max(slip.rate, rate);
  last = v;
}

void SlipReversal::bearing(std::size_t number, double v) {
  Bearing& of = bearings_[number];
  Slip& slip = joints_[number];
  const double change = v - slip.v[0];
  const bool turned = slip.turned != 0 && slip.time <= integration_.step;
  advance(slip, Vec3(v, 0, 0), turned ? std::abs(change - of.before) / (2 * integration_.step) : 0);
  of = {change, of.change};
}

void SlipReversal::state(const Snapshot& said, const std::vector<MovingBody>& bodies) {
  if (!integration_.second_order || bodies.empty()) return;
  for (std::size_t j = 0; j < dry_.size(); ++j) {
    const MovingBody& to = bodies[dry_[j].to];
    const double way = integration_.step * (to.v.norm() + dry_[j].size * to.w.norm());
    bearing(j, to.given && way > tuning::kShakes * dry_[j].size ? said.at(dry_[j].rate) : 0);
  }
  const Snapshot::Values* friction = said.of_points("friction_force", 3);
  if (!friction || friction->empty()) return;
  bodies_.resize(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const MovingBody& b = bodies[i];
    const Vec3 there = b.on ? bodies[*b.on].rigid().at(b.pressed) : Vec3(Vec3::Zero());
    const bool rides = b.free && b.on && bodies[*b.on].given && !b.push.isZero(0) && !there.isZero(0);
    advance(bodies_[i], rides ? b.across_push(b.v - there) : Vec3(Vec3::Zero()), b.body.sum(*friction).norm() / b.body.mass());
  }
}

double SlipReversal::share() const {
  double most = NAN;
  for (const auto& slips : {bodies_, joints_})
    for (const Slip& s : slips)
      if (s.late > 0) most = std::fmax(most, s.late / s.gone);
  return most;
}

void SlipReversal::checkpoint(Archive& archive) {
  archive_all(archive, "slip_reversal", bodies_);
  archive_all(archive, "slip_reversal.joints", joints_);
  archive_all(archive, "slip_reversal.bearings", bearings_);
}

}  // namespace mortise::audit
