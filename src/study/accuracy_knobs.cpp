#include "study/accuracy_knobs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "effects/roles.h"
#include "scene/edge_lengths.h"
#include "study/tuning.h"

namespace mortise::study {

Settings AutoKnob::settings(int level) const {
  Settings out;
  const double factor = std::pow(ratio, level);
  for (const Path& p : paths)
    if (level != 0 || p.set)
      out.emplace_back(p.path, p.whole ? fmt::format("{}", static_cast<long>(std::lround(p.base / factor))) : fmt::format("{:.9g}", p.base * factor));
  return out;
}

std::string AutoKnob::label(int level) const {
  const double factor = std::pow(1 / ratio, std::abs(level));
  return level == 0 ? "" : fmt::format("{} {} {:.3g}", name, level > 0 ? "/" : "x", factor);
}

namespace {

bool is_number(const Params& block, const char* key) {
  const Params* p = block.find(key);
  return p && p->kind() == Params::Kind::number;
}

}  // namespace

std::vector<AutoKnob> auto_knobs(const Params& scene, bool pressures) {
  std::vector<AutoKnob> out;
  AutoKnob mesh{"mesh", tuning::kMeshRatio, tuning::kMeshDearer, true, false, {}}, layer{"contact layer", 0.5, tuning::kLayerDearer, false, true, {}};
  double finest = INFINITY;  // edge of a soft body [m]
  for (const auto& [name, body] : scene.at("bodies").entries()) {
    const Params* shape = body.find("shape");
    if (!shape) continue;
    for (const scene::EdgeLength& edge : scene::edge_lengths(*shape)) {
      mesh.paths.push_back({fmt::format("bodies.{}.shape.{}", name, edge.path), edge.length});
      if (body.text("type") == "soft") finest = std::min(finest, edge.length);
    }
  }
  for (const std::string& contact : effects::of_role(scene.at("effects"), effects::Role::contact)) {
    const Params& block = scene.at("effects").at(contact);
    const double given = is_number(block, "d_hat") ? block.number("d_hat") : 0;
    const bool thicker = pressures && !is_number(block, "stiffness") && finest < INFINITY && given < tuning::kPressureLayer * finest;
    if (given > 0 || thicker)
      layer.paths.push_back({"effects." + contact + ".d_hat", thicker ? tuning::kPressureLayer * finest : given, false, thicker});
  }
  if (!mesh.paths.empty()) out.push_back(mesh);
  if (!layer.paths.empty()) out.push_back(layer);
  const Params& time = scene.at("time");
  if (time.text("mode") != "static")
    out.push_back({"time step", 0.5, 1, false, false, {{"time.step", time.number("step"), false}}});
  else if (!effects::of_role(scene.at("effects"), effects::Role::follower).empty())
    out.push_back({"load steps", 0.5, 1, false, false, {{"time.steps", static_cast<double>(time.integer("steps")), true}}});
  return out;
}

std::vector<AutoKnob> joined(std::vector<AutoKnob> knobs) {
  const auto mesh = std::find_if(knobs.begin(), knobs.end(), [](const AutoKnob& k) { return k.mesh; });
  const auto layer = std::find_if(knobs.begin(), knobs.end(), [](const AutoKnob& k) { return k.layer; });
  if (mesh == knobs.end() || layer == knobs.end()) return knobs;
  mesh->name = "mesh and layer", mesh->layer = true;
  mesh->paths.insert(mesh->paths.end(), layer->paths.begin(), layer->paths.end());
  knobs.erase(layer);
  return knobs;
}

}  // namespace mortise::study
