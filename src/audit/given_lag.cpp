#include "audit/given_lag.h"

#include <algorithm>
#include <cmath>

#include "audit/vector_at.h"

namespace mortise::audit {

GivenLag::GivenLag(const model::ModelInput& input) {
  const Integration integration = integration_of(input.scene);
  if (!integration.second_order) step_ = integration.step;
}

void GivenLag::state(const std::vector<MovingBody>& bodies, double largest_force) {
  if (std::isnan(step_) || bodies.empty()) return;
  v_.resize(3 * bodies.size()), a_.resize(v_.size()), late_.resize(bodies.size()), all_.resize(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Vec3 a = (bodies[i].v - at(v_, i)) / step_, change = a - at(a_, i);
    const double m = bodies[i].body.mass();
    if (states_ > 1 && bodies[i].given && change.norm() < a.norm()) late_[i] += m * change.norm(), all_[i] += std::fmax(m * a.norm(), largest_force);
    for (int k = 0; k < 3; ++k) v_[3 * i + k] = bodies[i].v[k], a_[3 * i + k] = a[k];
  }
  ++states_;
}

double GivenLag::value() const {
  double most = NAN;
  for (std::size_t i = 0; i < all_.size(); ++i)
    if (all_[i] > 0) most = std::fmax(most, late_[i] / all_[i]);
  return most;
}

void GivenLag::checkpoint(Archive& archive) {
  for (auto [name, values] : {std::pair{"given_lag.v", &v_}, {"given_lag.a", &a_}, {"given_lag.late", &late_}, {"given_lag.all", &all_}})
    archive.io(name, *values);
  archive.io("given_lag.states", states_);
}

}  // namespace mortise::audit
