#include "audit/given_lag.h"

#include <algorithm>
#include <cmath>

#include "audit/archived.h"
#include "audit/entries.h"
#include "audit/tuning.h"
#include "audit/vector_at.h"

namespace mortise::audit {

GivenLag::GivenLag(const model::ModelInput& input)
    : step_(integration_of(input.scene).step),
      backward_euler_(!integration_of(input.scene).second_order && told_to_move(input.scene.at("effects"))),
      holds_(input.scene.at("effects")),
      drives_(backward_euler_ ? kinematic_joints(input.scene.at("effects"), holds_) : std::vector<std::string>()),
      sums_(input, holds_, drives_, [&](const std::string& body) { return holds_.given(body); }) {}

void GivenLag::Sides::see(const Vec3& now, double force) {
  const double change = (now - at(last, 0)).norm(), of = std::fmax(now.norm(), force);
  const bool smooth = change < now.norm();
  late += change, all += of, jumps += !smooth && change > tuning::kRoundedWay * force;
  if (smooth) late_smooth += change, all_smooth += of;
  std::copy(now.data(), now.data() + 3, last);
}

double GivenLag::Sides::lag() const {
  if (jumps > tuning::kJumps) return all > 0 ? late / all : NAN;
  return all_smooth > 0 ? late_smooth / all_smooth : NAN;
}

void GivenLag::state(const Snapshot& said, const std::vector<double>& points, const std::vector<MovingBody>& bodies,
                     const std::vector<double>& forces) {
  if (!backward_euler_ || bodies.empty()) return;
  bodies_.resize(bodies.size()), joints_.resize(drives_.size());
  if (++states_ <= 2) {
    for (std::size_t i = 0; i < bodies.size(); ++i) Eigen::Map<Vec3>(bodies_[i].last) = bodies[i].body.mass() * bodies[i].a;
  } else {
    for (std::size_t i = 0; i < bodies.size(); ++i)
      if (bodies[i].given) bodies_[i].see(bodies[i].body.mass() * bodies[i].a, forces[i]);
  }
  if (sums_.empty()) return;
  const JointSums::Sums sums = sums_.of(points, bodies);
  for (std::size_t j = 0; j < drives_.size(); ++j) {
    if (states_ > 2) joints_[j].see({sums.J[j], 0, 0}, driving(said, drives_[j], sums, j, step_));
    joints_[j].last[0] = sums.J[j];
  }
}

double GivenLag::value() const {
  double most = NAN;
  for (const std::vector<Sides>* of : {&bodies_, &joints_})
    for (const Sides& s : *of) most = std::fmax(most, s.lag());
  return most;
}

void GivenLag::checkpoint(Archive& archive) {
  archive_all(archive, "given_lag.bodies", bodies_);
  archive_all(archive, "given_lag.joints", joints_);
  archive.io("given_lag.states", states_);
}

}  // namespace mortise::audit
