#include "audit/given_kinks.h"

#include <algorithm>
#include <cmath>

#include "audit/archived.h"
#include "audit/entries.h"
#include "audit/tuning.h"
#include "audit/vector_at.h"
#include "effects/integrator.h"

namespace mortise::audit {

namespace {

// Of v what counts: of what lies on something, what is across the force that presses it.
Vec3 across(const MovingBody& b, const Vec3& v) { return b.given ? v : b.across_push(v); }

// Does it go as the scene says, or along with something that does?
bool goes_along(const MovingBody& b, const std::vector<MovingBody>& bodies) {
  if (b.given) return true;
  if (!b.free || b.push.isZero() || !b.on || !bodies[*b.on].given) return false;
  const Vec3 there = bodies[*b.on].rigid().at(b.x);
  return b.across_push(b.v - there).norm() <= tuning::kStill * there.norm();
}

// h of a scene that this is about, else NaN.
double looked_at(const model::ModelInput& input) {
  const Integration integration = integration_of(input.scene);
  return integration.second_order && told_to_move(input.scene.at("effects")) ? integration.step : NAN;
}

}  // namespace

GivenKinks::GivenKinks(const model::ModelInput& input)
    : step_(looked_at(input)),
      holds_(input.scene.at("effects")),
      drives_(std::isnan(step_) ? std::vector<std::string>() : kinematic_joints(input.scene.at("effects"), holds_)),
      sums_(input, holds_, drives_, [&](const std::string& body) { return holds_.given(body); }) {
  for (const std::string& name : drives_)
    coordinates_.push_back("joint/" + name + (joint_named(input.scene.at("effects"), name)->text("type") == "prismatic" ? "_travel" : "_angle"));
}

bool GivenKinks::Told::goes_on(const Vec3& now, const Vec3& velocity, double h) {
  std::rotate(x, x + 3, x + 3 * kKept), std::rotate(v, v + 3, v + 3 * kKept);
  // Before that it went on at the velocity that it began with.
  for (int k = states++ == 0 ? 0 : kKept - 1; k < kKept; ++k)
    Eigen::Map<Vec3>(x + 3 * k) = now - (kKept - 1 - k) * h * velocity, Eigen::Map<Vec3>(v + 3 * k) = velocity;
  return states - 2 >= tuning::kBegins;  // two states before this one
}

void GivenKinks::look(Told& told, double m, double force, const Counts& counts) const {
  const double h = step_;
  const auto c = [&](int k) { return counts(Vec3(at(told.x, k + 1) - 2 * at(told.x, k) + at(told.x, k - 1)) / (h * h)).norm(); };
  const int n = kKept - 3;
  const auto jumps = [&](int k) { return c(k) > tuning::kSpike * std::max(c(k - 1), c(k + 1)); };
  double most = 0;
  bool jumped = false;
  for (int k = n - 3; k <= n; ++k) jumped = jumped || jumps(k), most = std::max(most, c(k));
  const double a = counts(effects::bdf2(h, h).rate(at(told.v, n), at(told.v, n - 1), at(told.v, n - 2))).norm();
  told.jumps += jumps(n);
  if (jumped) {
    told.jumped = std::max(told.jumped, m * a);
    return;
  }
  told.taken = std::max(told.taken, m * a), told.asked = std::max(told.asked, m * most);
  told.all = std::max({told.all, told.asked, force});
}

void GivenKinks::state(const Snapshot& said, const std::vector<double>& points, const std::vector<MovingBody>& bodies,
                       const std::vector<double>& forces) {
  if (std::isnan(step_) || bodies.empty()) return;
  bodies_.resize(bodies.size()), joints_.resize(drives_.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const MovingBody& b = bodies[i];
    if (!goes_along(b, bodies)) {
      bodies_[i].states = 0;
      continue;
    }
    if (bodies_[i].goes_on(b.x, b.v, step_))
      look(bodies_[i], b.body.mass(), b.given ? forces[i] : tuning::kAcross * b.push.norm(), [&](const Vec3& of) { return across(b, of); });
  }
  if (sums_.empty()) return;
  const JointSums::Sums sums = sums_.of(points, bodies);
  for (std::size_t j = 0; j < drives_.size(); ++j)
    if (joints_[j].goes_on({said.at(coordinates_[j]), 0, 0}, {said.at("joint/" + drives_[j] + "_rate"), 0, 0}, step_))
      look(joints_[j], sums.M(j, j), driving(said, drives_[j], sums, j, step_), [](const Vec3& of) { return of; });
}

double GivenKinks::value() const {
  double most = NAN;
  for (const std::vector<Told>* of : {&bodies_, &joints_})
    for (const Told& b : *of) {
      const bool sampled = b.jumps > tuning::kJumps;
      const double over = std::max((sampled ? std::max(b.taken, b.jumped) : b.taken) - b.asked, 0.0),
                   all = sampled ? std::max(b.all, b.jumped) : b.all;
      if (all > 0) most = std::fmax(most, over / all);
    }
  return most;
}

void GivenKinks::checkpoint(Archive& archive) {
  archive_all(archive, "given_kinks.bodies", bodies_);
  archive_all(archive, "given_kinks.joints", joints_);
}

}  // namespace mortise::audit
