#include "study/accuracy_knobs.h"

#include <fmt/format.h>

#include <cmath>

#include "effects/roles.h"
#include "scene/edge_lengths.h"
#include "study/tuning.h"

namespace mortise::study {

Settings AutoKnob::settings(int level) const {
  Settings out;
  if (level == 0) return out;
  const double factor = std::pow(ratio, level);
  for (const Path& p : paths)
    out.emplace_back(p.path, p.whole ? fmt::format("{}", static_cast<long>(std::lround(p.base / factor))) : fmt::format("{:.9g}", p.base * factor));
  return out;
}

std::string AutoKnob::label(int level) const {
  const double factor = std::pow(1 / ratio, std::abs(level));
  return level == 0 ? "" : fmt::format("{} {} {:.3g}", name, level > 0 ? "/" : "x", factor);
}

std::vector<AutoKnob> auto_knobs(const Params& root) {
  std::vector<AutoKnob> out;
  AutoKnob mesh{"mesh", tuning::kMeshRatio, tuning::kMeshDearer, true, {}}, layer{"contact layer", 0.5, tuning::kLayerDearer, false, {}};
  for (const auto& [name, body] : root.at("bodies").entries())
    if (const Params* shape = body.find("shape"))
      for (const scene::EdgeLength& edge : scene::edge_lengths(*shape))
        mesh.paths.push_back({fmt::format("bodies.{}.shape.{}", name, edge.path), edge.length, false});
  for (const std::string& contact : effects::of_role(root.at("effects"), effects::Role::contact))
    if (const Params* d_hat = root.at("effects").at(contact).find("d_hat"); d_hat && d_hat->kind() == Params::Kind::number)
      layer.paths.push_back({"effects." + contact + ".d_hat", d_hat->as_number(), false});
  if (!mesh.paths.empty() && !layer.paths.empty()) {
    mesh.name += " and contact layer";
    mesh.paths.insert(mesh.paths.end(), layer.paths.begin(), layer.paths.end());
  }
  if (!mesh.paths.empty())
    out.push_back(mesh);
  else if (!layer.paths.empty())
    out.push_back(layer);
  const Params& time = root.at("time");
  if (time.text("mode") != "static")
    out.push_back({"time step", 0.5, 1, false, {{"time.step", time.number("step"), false}}});
  else if (!effects::of_role(root.at("effects"), effects::Role::follower).empty())
    out.push_back({"load steps", 0.5, 1, false, {{"time.steps", static_cast<double>(time.integer("steps")), true}}});
  return out;
}

}  // namespace mortise::study
