#include "audit/jolted.h"

#include <algorithm>
#include <cmath>

#include "audit/archived.h"
#include "audit/tuning.h"
#include "audit/vector_at.h"

namespace mortise::audit {

namespace {

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

Jolted::Jolted(const model::ModelInput& input) : gravity_(gravity_of(input.scene)) {
  if (const Integration integration = integration_of(input.scene); !integration.second_order) step_ = integration.step;
}

double Jolted::Body::missing_now() const {
  const double size = at(D, 0).norm();
  return size > 0 && o > -tuning::kCaughtUp * size ? std::max(size - o, 0.0) : 0;
}

void Jolted::look(Body& body, const Vec3& a) {
  const auto A = [&](int k) { return at(body.A, k); };
  const Vec3 changed = A(kKept - 2) - A(1);
  const double size = changed.norm(), stands = tuning::kStands * size;
  Eigen::Map<Vec3> D(body.D);
  if (size > 0 && (A(1) - A(0)).norm() <= stands && (A(kKept - 1) - A(kKept - 2)).norm() <= stands && size > body.missing_now()) {
    body.missing = std::max(body.missing, body.missing_now());
    D = changed, body.o = -size;
  }
  if (const double of = D.norm(); of > 0) body.o = std::max(body.o, (a - A(kKept - 1)).dot(D) / of);
}

void Jolted::state(const std::vector<MovingBody>& bodies) {
  if (std::isnan(step_) || bodies.empty()) return;
  bodies_.resize(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const MovingBody& b = bodies[i];
    Body& body = bodies_[i];
    const std::optional<std::size_t> by = carrier_of(b, bodies);
    if (!by) {
      body.states = 0;
      continue;
    }
    const Vec3 there = bodies[*by].rigid().at(b.x);
    if (body.by != static_cast<double>(*by)) body.states = 0, body.by = static_cast<double>(*by);
    if (body.states == 0) {
      body.missing = std::max(body.missing, body.missing_now());
      std::fill(body.A, body.A + 3 * kKept, 0.0), std::fill(body.D, body.D + 3, 0.0);
    } else {
      std::rotate(body.A, body.A + 3, body.A + 3 * kKept);
      Eigen::Map<Vec3>(body.A + 3 * (kKept - 1)) = (there - at(body.there, 0)) / step_;
      body.mass = b.body.mass(), body.force = std::max({body.force, body.mass * (b.a - gravity_).norm(), b.push.norm()});
      if (body.states > kKept) look(body, b.a);
    }
    ++body.states;
    Eigen::Map<Vec3>(body.there) = there;
  }
}

double Jolted::value() const {
  double most = NAN;
  for (const Body& b : bodies_)
    if (const double missing = b.mass * std::max(b.missing, b.missing_now()); b.force > 0) most = std::fmax(most, missing / (b.force + missing));
  return most;
}

void Jolted::checkpoint(Archive& archive) { archive_all(archive, "jolted.bodies", bodies_); }

}  // namespace mortise::audit
