#include "run/shape_defect.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "run/holds.h"
#include "run/measured_body.h"

namespace mortise::run {
namespace {

// Of round shapes [m^3]; 0 of others.
double exact_volume(const Params& shape) {
  const auto& [kind, p] = *shape.entries().begin();
  if (kind != "sphere" && kind != "cylinder" && kind != "capsule") return 0;
  const double R = p.number("radius"), ball = 4.0 / 3 * std::numbers::pi * R * R * R;
  if (kind == "sphere") return ball;
  const double tube = std::numbers::pi * R * R * p.number("height");
  return kind == "cylinder" ? tube : tube + ball;
}

}  // namespace

double shape_defect(const model::ModelInput& input) {
  const Holds holds(input.scene.at("effects"));
  double worst = 0;
  for (const model::BodyInput& body : input.bodies) {
    const Params* shape = body.params.find("shape");
    if (!shape || body.type == model::BodyType::half_space) continue;
    const bool soft = body.type == model::BodyType::soft;
    if (soft ? body.params.has("curved") && body.params.flag("curved") : holds.held(body.name) || body.params.has("mass")) continue;
    if (const double exact = exact_volume(*shape); exact > 0) worst = std::max(worst, 1 - MeasuredBody(body, 0).rest_volume() / exact);
  }
  return worst;
}

}  // namespace mortise::run
