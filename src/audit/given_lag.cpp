#include "audit/given_lag.h"

#include <algorithm>
#include <cmath>

#include "audit/entries.h"
#include "audit/vector_at.h"

namespace mortise::audit {

GivenLag::GivenLag(const model::ModelInput& input)
    : backward_euler_(!integration_of(input.scene).second_order && told_to_move(input.scene.at("effects"))) {}

void GivenLag::state(const std::vector<MovingBody>& bodies, const std::vector<double>& forces) {
  if (!backward_euler_ || bodies.empty()) return;
  a_.resize(3 * bodies.size()), late_.resize(bodies.size()), all_.resize(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Vec3 &a = bodies[i].a, change = a - at(a_, i);
    const double m = bodies[i].body.mass();
    if (states_ > 1 && bodies[i].given && change.norm() < a.norm()) late_[i] += m * change.norm(), all_[i] += std::fmax(m * a.norm(), forces[i]);
    Eigen::Map<Vec3>(a_.data() + 3 * i) = a;
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
  for (auto [name, values] : {std::pair{"given_lag.a", &a_}, {"given_lag.late", &late_}, {"given_lag.all", &all_}}) archive.io(name, *values);
  archive.io("given_lag.states", states_);
}

}  // namespace mortise::audit
