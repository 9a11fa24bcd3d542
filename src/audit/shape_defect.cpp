#include "audit/shape_defect.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "audit/entries.h"
#include "audit/holds.h"
#include "audit/measured_body.h"
#include "audit/tuning.h"
#include "effects/roles.h"
#include "geometry/nearest_triangle.h"
#include "geometry/placement.h"
#include "geometry/shapes.h"

namespace mortise::audit {
namespace {

// Volume between the surface of a file and the one that the body has instead of it: facets of the latter by how far their middles are from the
// former [m^3].
double remeshed_by(const model::BodyInput& body) {
  const std::optional<geometry::TriMesh> file = geometry::remeshed_surface(body.params.at("shape"));
  if (!file) return 0;
  std::vector<Vec3> given = file->points;
  geometry::Placement(body.params).apply(given);
  const geometry::NearestTriangle near(given, file->triangles);
  double out = 0;
  for (const Triangle& t : body.triangles) {
    const Vec3 &a = body.nodes[t.v[0]], &b = body.nodes[t.v[1]], &c = body.nodes[t.v[2]], middle = (a + b + c) / 3;
    out += 0.5 * (b - a).cross(c - a).norm() * near.distance(middle);
  }
  return out;
}

bool has_weight(const Params& effects) {
  const std::vector<std::string> loads = effects::of_role(effects, effects::Role::load);
  return !effects::of_role(effects, effects::Role::inertia).empty() ||
         std::any_of(loads.begin(), loads.end(), [&](const std::string& load) { return effects.at(load).has("acceleration"); });
}

// Does a hinge let a round body turn about its own axis?
bool turns_on_its_axis(const Params& effects, const model::BodyInput& body) {
  for (const Params& joint : entries(effects, "joint")) {
    if (joint.text("type") != "revolute" || joint.text("body") != body.name) continue;
    const geometry::Placement placed(body.params);
    const Vec3 axis = joint.vec3("axis").normalized(), along = placed.R.col(2);
    const bool ball = body.params.at("shape").has("sphere");
    if (!ball && axis.cross(along).norm() > tuning::kOnAxis) continue;
    const auto& [kind, p] = *body.params.at("shape").entries().begin();
    if (axis.cross(placed.t - joint.vec3("at")).norm() < tuning::kOnAxis * p.number("radius")) return true;
  }
  return false;
}

}  // namespace

double round_volume(const Params& shape) {
  const auto& [kind, p] = *shape.entries().begin();
  if (kind != "sphere" && kind != "cylinder" && kind != "capsule") return 0;
  const double R = p.number("radius"), ball = 4.0 / 3 * std::numbers::pi * R * R * R;
  if (kind == "sphere") return ball;
  const double tube = std::numbers::pi * R * R * p.number("height");
  return kind == "cylinder" ? tube : tube + ball;
}

double shape_defect(const model::ModelInput& input) {
  const Params& effects = input.scene.at("effects");
  const Holds holds(effects);
  double worst = 0;
  for (const model::BodyInput& body : input.bodies) {
    const Params* shape = body.params.find("shape");
    if (!shape || body.type == model::BodyType::half_space) continue;
    const bool soft = body.type == model::BodyType::soft;
    const double exact = round_volume(*shape);
    if (soft && body.params.has("curved") && body.params.flag("curved")) continue;
    const bool by_mass = !body.params.has("mass") && (!holds.held(body.name) || (!holds.given(body.name) && has_weight(effects)));
    if (!soft && !by_mass && !(exact > 0 && turns_on_its_axis(effects, body))) continue;
    const auto volume = [&] { return MeasuredBody(body, 0).rest_volume(); };
    if (exact > 0) worst = std::max(worst, 1 - volume() / exact);
    if (const double between = soft ? remeshed_by(body) : 0; between > 0) worst = std::max(worst, tuning::kRemeshed * between / volume());
  }
  return worst;
}

}  // namespace mortise::audit
