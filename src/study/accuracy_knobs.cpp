#include "study/accuracy_knobs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "effects/roles.h"
#include "scene/edge_lengths.h"
#include "scene/scene.h"
#include "study/tuning.h"

namespace mortise::study {

static long steps_at(const AutoKnob& knob, int level) {
  return std::max(1L, std::lround(static_cast<double>(knob.steps) / std::pow(knob.ratio, level)));
}

Settings AutoKnob::settings(int level) const {
  Settings out;
  const double factor = std::pow(ratio, level);
  for (const Path& p : paths)
    if (level != 0 || p.set) out.emplace_back(p.path, fmt::format("{:.9g}", p.base * factor));
  if (steps == 0 || level == 0) return out;
  const long n = steps_at(*this, level);
  if (end > 0) out.emplace_back("time.step", fmt::format("{:.15g}", end / static_cast<double>(n)));
  out.emplace_back("time.steps", std::to_string(n));
  return out;
}

double AutoKnob::size(int level) const {
  return steps > 0 ? static_cast<double>(steps) / static_cast<double>(steps_at(*this, level)) : std::pow(ratio, level);
}

std::string AutoKnob::label(int level) const {
  return level == 0 ? "" : fmt::format("{} {} {:.3g}", name, level > 0 ? "/" : "x", level > 0 ? 1 / size(level) : size(level));
}

namespace {

bool is_number(const Params& block, const char* key) {
  const Params* p = block.find(key);
  return p && p->kind() == Params::Kind::number;
}

}  // namespace

std::vector<AutoKnob> auto_knobs(const Params& scene, const std::vector<Quantity>& quantities) {
  const auto any = [&](const auto& of) { return std::any_of(quantities.begin(), quantities.end(), of); };
  const bool pressures = any([](const Quantity& q) { return q.value == "contact_pressure"; });
  const bool over_time = any([](const Quantity& q) { return q.of_history(); });
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
    if (given > 0 || thicker) layer.paths.push_back({"effects." + contact + ".d_hat", thicker ? tuning::kPressureLayer * finest : given, thicker});
  }
  if (!mesh.paths.empty()) out.push_back(mesh);
  if (!layer.paths.empty()) out.push_back(layer);
  const bool statics = scene.at("time").text("mode") == "static";
  AutoKnob time{statics ? "load steps" : "time step", 0.5, 1, false, false, {}};
  time.steps = scene.at("time").integer("steps"), time.end = statics ? 0 : scene::end_time(scene);
  if (!statics || over_time || !effects::of_role(scene.at("effects"), effects::Role::follower).empty()) out.push_back(time);
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
