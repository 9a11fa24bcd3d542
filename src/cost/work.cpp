#include "cost/work.h"

#include "base/sha256.h"
#include "effects/roles.h"
#include "scene/scene.h"

namespace mortise::cost {

Work work_of(const model::ModelInput& input, const std::string& linear_solver) {
  const Params &effects = input.scene.at("effects"), &time = input.scene.at("time");
  Work out;
  out.statics = time.text("mode") == "static", out.steps = time.integer("steps");
  out.contact = !effects::of_role(effects, effects::Role::contact).empty();
  out.friction = !effects::of_role(effects, effects::Role::follower).empty();
  out.drives = effects.has("drive");
  out.iterates = linear_solver.starts_with("cg");
  for (const model::BodyInput& b : input.bodies) {
    const double blocks = b.type == model::BodyType::soft ? static_cast<double>(b.nodes.size()) : b.type == model::BodyType::stiff ? 4 : 0;
    out.blocks += blocks, out.factor += blocks * blocks;
    (b.midsides.empty() ? out.tets : out.quadratic) += static_cast<double>(b.tets.size());
    if (out.contact) out.triangles += static_cast<double>(b.triangles.size());
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
