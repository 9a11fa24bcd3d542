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

}  // namespace

GivenKinks::GivenKinks(const model::ModelInput& input) {
  const Integration integration = integration_of(input.scene);
  if (integration.second_order && told_to_move(input.scene.at("effects"))) step_ = integration.step;
}

void GivenKinks::look(Body& body, const MovingBody& b, double force) const {
  const double h = step_;
  const auto c = [&](int k) { return across(b, Vec3(at(body.x, k + 1) - 2 * at(body.x, k) + at(body.x, k - 1)) / (h * h)).norm(); };
  const int n = kKept - 3;
  const auto jumps = [&](int k) { return c(k) > tuning::kSpike * std::max(c(k - 1), c(k + 1)); };
  double most = 0;
  bool jumped = false;
  for (int k = n - 3; k <= n; ++k) jumped = jumped || jumps(k), most = std::max(most, c(k));
  const double a = across(b, effects::bdf2(h, h).rate(at(body.v, n), at(body.v, n - 1), at(body.v, n - 2))).norm(), m = b.body.mass();
  body.jumps += jumps(n);
  if (jumped) {
    body.jumped = std::max(body.jumped, m * a);
    return;
  }
  body.taken = std::max(body.taken, m * a), body.asked = std::max(body.asked, m * most);
  body.all = std::max({body.all, body.asked, b.given ? force : tuning::kAcross * b.push.norm()});
}

void GivenKinks::state(const std::vector<MovingBody>& bodies, const std::vector<double>& forces) {
  if (std::isnan(step_) || bodies.empty()) return;
  bodies_.resize(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const MovingBody& b = bodies[i];
    Body& body = bodies_[i];
    if (!goes_along(b, bodies)) {
      body.states = 0;
      continue;
    }
    std::rotate(body.x, body.x + 3, body.x + 3 * kKept), std::rotate(body.v, body.v + 3, body.v + 3 * kKept);
    // Before that it went on at the velocity that it began with.
    for (int k = body.states++ == 0 ? 0 : kKept - 1; k < kKept; ++k)
      Eigen::Map<Vec3>(body.x + 3 * k) = b.x - (kKept - 1 - k) * step_ * b.v, Eigen::Map<Vec3>(body.v + 3 * k) = b.v;
    if (body.states - 2 >= tuning::kBegins) look(body, b, forces[i]);  // two states before this one
  }
}

double GivenKinks::value() const {
  double most = NAN;
  for (const Body& b : bodies_) {
    const bool sampled = b.jumps > tuning::kJumps;
    const double over = std::max((sampled ? std::max(b.taken, b.jumped) : b.taken) - b.asked, 0.0), all = sampled ? std::max(b.all, b.jumped) : b.all;
    if (all > 0) most = std::fmax(most, over / all);
  }
  return most;
}

void GivenKinks::checkpoint(Archive& archive) { archive_all(archive, "given_kinks.bodies", bodies_); }

}  // namespace mortise::audit
