#include "cost/work.h"

#include <algorithm>
#include <cmath>

#include "base/sha256.h"
#include "cost/coarser.h"
#include "effects/roles.h"
#include "scene/scene.h"

namespace mortise::cost {
namespace {

// Is anything pinned to a motion?
bool moves(const Params& effects) {
  const Params* pins = effects.find("pin");
  return pins && pins->kind() == Params::Kind::list &&
         std::any_of(pins->items().begin(), pins->items().end(), [](const Params& pin) { return pin.has("motion"); });
}

}  // namespace

Work work_of(const model::ModelInput& input, const std::string& linear_solver, double edges) {
  const Params &effects = input.scene.at("effects"), &time = input.scene.at("time");
  Work out;
  out.statics = time.text("mode") == "static", out.steps = time.integer("steps");
  out.contact = !effects::of_role(effects, effects::Role::contact).empty();
  out.friction = !effects::of_role(effects, effects::Role::follower).empty();
  out.drives = effects.has("drive") || moves(effects);
  out.iterates = linear_solver.starts_with("cg");
  for (const model::BodyInput& b : input.bodies) {
    const double area = edges != 1 && can_be_coarser(input.scene, b.name) ? edges * edges : 1, volume = std::pow(area, 1.5);
    const double blocks = b.type == model::BodyType::soft ? static_cast<double>(b.nodes.size()) / volume : b.type == model::BodyType::stiff ? 4 : 0;
    out.blocks += blocks, out.factor += blocks * blocks;
    (b.midsides.empty() ? out.tets : out.quadratic) += static_cast<double>(b.tets.size()) / volume;
    if (out.contact) out.triangles += static_cast<double>(b.triangles.size()) / area;
  }
  return out;
}

std::string same_physics(const Params& scene) {
  Params kept = Params::make_table();
  for (const auto& [key, block] : scene.entries()) {
    if (key == "output" || key == "render" || key == "checks" || key == "quantities" || key == "sensors" || key == "name") continue;
    if (key != "time") {
      kept.set(key, block);
      continue;
    }
    Params time = Params::make_table();
    for (const auto& [name, value] : block.entries())
      if (name != "steps" && name != "frame_every") time.set(name, value);
    kept.set(key, std::move(time));
  }
  return sha256(scene::identity(kept)).substr(0, 16);
}

std::string same_kind(const Params& scene) {
  std::string names = scene.text("name") + "|" + scene.at("time").text("mode");
  for (const auto& [name, body] : scene.at("bodies").entries()) names += "|" + name + ":" + body.text("type");
  for (const auto& [name, effect] : scene.at("effects").entries()) names += "|" + name;
  return sha256(names).substr(0, 16);
}

}  // namespace mortise::cost
