#include "audit/held_weight.h"

#include <cmath>

#include "audit/holds.h"
#include "audit/measured_body.h"
#include "audit/moving_body.h"
#include "audit/shape_defect.h"

namespace mortise::audit {

HeldWeight::HeldWeight(const model::ModelInput& input) {
  const Holds holds(input.scene.at("effects"));
  const double g = gravity_of(input.scene).norm();
  std::size_t number = 0;
  for (const model::BodyInput& body : input.bodies) {
    if (body.type == model::BodyType::half_space) continue;
    const std::size_t own = number++;
    const Params* shape = body.params.find("shape");
    if (g == 0 || !shape || body.type != model::BodyType::stiff || body.params.has("mass") || !holds.given(body.name)) continue;
    const double exact = round_volume(*shape);
    if (exact == 0) continue;
    const MeasuredBody measured(body, 0);
    bodies_.push_back({own, measured.mass() * g, 1 - measured.rest_volume() / exact});
  }
  largest_.assign(bodies_.size(), 0.0);
}

void HeldWeight::state(const std::vector<double>& forces) {
  for (std::size_t i = 0; i < bodies_.size(); ++i) largest_[i] = std::fmax(largest_[i], forces[bodies_[i].number]);
}

double HeldWeight::share() const {
  double most = NAN;
  for (std::size_t i = 0; i < bodies_.size(); ++i)
    if (largest_[i] > 0) most = std::fmax(most, bodies_[i].defect * bodies_[i].weight / std::fmax(largest_[i], bodies_[i].weight));
  return most;
}

}  // namespace mortise::audit
