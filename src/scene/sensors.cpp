#include "scene/sensors.h"

#include <algorithm>
#include <limits>

#include "scene/checker.h"
#include "scene/suggest.h"

namespace mortise::scene {
namespace {

using Kind = Param::Kind;
using namespace param;

Param count(std::string key, std::string help) {
  return range(required(of(Kind::integer, std::move(key), Unit::none, {}, std::move(help))), 1, 4096);
}
Param required_length(std::string key, std::string help) {
  return positive(required(of(Kind::number, std::move(key), Unit::length, {}, std::move(help))));
}

// Two increasing numbers; `least`: the first is no smaller.
void check_range(const Params& sensor, const char* key, double least, const std::string& path, Diagnostics& errors) {
  const Params* range = sensor.find(key);
  if (!range) return;
  const std::vector<double> ends = range->as_numbers();
  if (ends.size() != 2 || !(ends[0] < ends[1]) || ends[0] < least)
    errors.add(range->where(), path + "." + key + " must be two increasing " + (least == 0 ? "numbers from 0 on" : "numbers"));
}

void check(const std::string& path, const Params& sensor, const Params* bodies, Diagnostics& errors) {
  const Params* body = sensor.find("body");
  if (body && bodies) {
    std::vector<std::string> names;
    for (const auto& [name, block] : bodies->entries()) names.push_back(name);
    const Params* found = bodies->find(body->as_text());
    const Params* type = found ? found->find("type") : nullptr;
    if (!found) errors.add(body->where(), path + ".body: no body '" + body->as_text() + "'", suggestion(body->as_text(), names));
    if (type && type->as_text() == "half_space")
      errors.add(body->where(), path + ".body: half-space '" + body->as_text() + "' has no surface of finite size", "name a soft or stiff body");
  }
  check_range(sensor, "range", -std::numeric_limits<double>::infinity(), path, errors);
  check_range(sensor, "shear_range", 0, path, errors);
  const Params *normal = sensor.find("normal"), *up = sensor.find("up");
  if (normal && up && !normal->as_vec3().isZero(0) && !up->as_vec3().isZero(0) &&
      !(normal->as_vec3().cross(up->as_vec3()).norm() > 1e-6 * normal->as_vec3().norm() * up->as_vec3().norm()))
    errors.add(up->where(), path + ".up is along its normal", "it has to lie in the plane of the grid");
}

}  // namespace

const ParamTable& sensor_table() {
  static const ParamTable t{
      "sensor",
      "A grid of taxels on the surface of a body: pressure, shear, displacement and wrench in every frame.",
      {required(of(Kind::text, "body", Unit::none, {}, "Soft or stiff body whose surface it lies on.")),
       of(Kind::vec3, "position", Unit::length, "[0, 0, 0]", "Middle of the grid, in world coordinates at the start."),
       of(Kind::vec3, "normal", Unit::none, "[0, 0, 1]",
          "Direction out of the body, of any length but zero; the grid is laid on the surface along it."),
       of(Kind::vec3, "up", Unit::none, "[0, 1, 0]", "Direction in which row numbers grow; columns grow along up x normal."),
       count("rows", "Number of taxels along `up`."), count("columns", "Number of taxels across."),
       required_length("width", "Size of the grid across."), required_length("height", "Size of the grid along `up`."),
       positive(optional(of(Kind::number, "depth", Unit::length, {},
                            "Surface farther than this from the grid's plane does not belong to it; absent: all that faces it."))),
       choice("moves_with", {"supports", "body"}, "supports",
              "What the frame is fixed to: the nodes of the body that pins hold in all directions or that are bonded (without such: as body), or the "
              "rigid motion nearest to that of all its nodes."),
       optional(of(Kind::numbers, "range", Unit::pressure, {},
                   "Pictures: pressures at the two ends of the colour scale; absent takes 0 and the largest so far.")),
       optional(
           of(Kind::numbers, "shear_range", Unit::pressure, {},
              "Pictures: least shear that has an arrow, and the shear of the longest arrow; absent takes 5 % of the largest so far, and that."))}};
  return t;
}

void check_sensors(const Params& root, std::span<const EffectTable> tables, const std::set<std::string>& incomplete, Diagnostics& errors) {
  const Params *sensors = root.find("sensors"), *render = root.find("render");
  if (render && !incomplete.count("render") && !sensors && !render->has("cameras"))
    errors.add(render->where(), "render has no 'cameras'", "there is nothing to draw without cameras and without sensors");
  if (!sensors) return;
  const Params* effects = root.find("effects");
  if (effects && !incomplete.count("effects") &&
      std::none_of(tables.begin(), tables.end(), [&](const EffectTable& t) { return t.contact && effects->has(t.name); }))
    errors.add(sensors->where(), "sensors read contact forces, but the scene has no contact effect", "add barrier_contact or mortar_contact",
               {{effects->where(), "the effects"}});
  const Params* bodies = incomplete.count("bodies") ? nullptr : root.find("bodies");
  for (const auto& [name, sensor] : sensors->entries()) check("sensors." + name, sensor, bodies, errors);
}

}  // namespace mortise::scene
