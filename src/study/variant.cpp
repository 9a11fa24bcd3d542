#include "study/variant.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/sha256.h"
#include "engine/effect_tables.h"
#include "scene/suggest.h"

namespace mortise::study {
namespace {

bool same(double a, double b) { return std::abs(a - b) <= 1e-9 * std::abs(b); }

bool varies(const std::vector<std::string>& overrides, const std::string& path) {
  return std::any_of(overrides.begin(), overrides.end(), [&](const std::string& o) { return o.starts_with(path + "="); });
}

scene::Scene read(const Study& study, const Method& method, const std::vector<std::string>& overrides, bool keep_pictures = false) {
  const auto tables = engine::effect_tables();
  std::vector<std::string> all = study.set;
  if (method.without.empty()) {
    all.insert(all.end(), overrides.begin(), overrides.end());
    return scene::read_scene(study.scene, all, tables);
  }
  const scene::Scene whole = scene::read_scene(study.scene, all, tables);
  std::vector<std::string> known;
  for (const auto& [name, block] : whole.root.at("effects").entries()) known.push_back(name);
  for (const std::string& name : method.without)
    if (!std::count(known.begin(), known.end(), name))
      throw Error(Exit::usage, method.at,
                  fmt::format("method '{}' is without '{}', which the scene does not list\n  {}", method.name, name, scene::suggestion(name, known)));
  return scene::read_scene_text(scene::to_yaml(without_effects(whole.root, method.without, keep_pictures)),
                                fmt::format("{} (without {})", study.scene, scene::join(method.without, ", ")), overrides, tables);
}

Variant of(const scene::Scene& scene) { return {scene::to_yaml(scene.root), scene::identity(scene.root)}; }

}  // namespace

Params without_effects(const Params& root, const std::vector<std::string>& effects, bool keep_pictures) {
  Params out = Params::make_table(root.where());
  for (const auto& [key, block] : root.entries()) {
    if (key == "checks" || (key == "render" && !keep_pictures)) continue;
    if (key != "effects") {
      out.set(key, block);
      continue;
    }
    Params kept = Params::make_table(block.where());
    for (const auto& [name, effect] : block.entries())
      if (!std::count(effects.begin(), effects.end(), name)) kept.set(name, effect);
    out.set(key, std::move(kept));
  }
  return out;
}

Variant variant_of(const Study& study, const Method& method, const Settings& settings, bool as_written) {
  std::vector<std::string> overrides = method.set;
  for (const auto& [path, value] : settings) overrides.push_back(path + "=" + value);
  const double end = scene::end_time(read(study, {}, {}).root);
  const scene::Scene scene = read(study, method, overrides);
  if (scene.root.has("environments"))
    throw Error(Exit::usage, "a study runs one environment at a time: take the 'environments' block out of the scene");
  if (const double now = scene::end_time(scene.root); !same(now, end)) {
    if (!varies(overrides, "time.step") || varies(overrides, "time.steps"))
      throw Error(Exit::usage,
                  fmt::format("the runs would end at {:g} s and {:g} s, where their results do not compare; vary time.step alone", end, now));
    const double step = scene.root.at("time").number("step"), steps = std::round(end / step);
    if (!same(steps * step, end))
      throw Error(Exit::usage, fmt::format("time.step: steps of {:g} s do not end at {:g} s, when the scene does", step, end));
    overrides.push_back(fmt::format("time.steps={}", static_cast<long>(steps)));
  }
  if (as_written) try {
      return of(read(study, method, overrides, true));
    } catch (const scene::SceneErrors&) {  // a picture shows what is not there
      return of(read(study, method, overrides));
    }
  // What quantities are made of: every step where they look at more than the last, and all digits of fields. A run that was cut short begins again,
  // so that its time is whole: checkpoints would only cost.
  const auto any = [&](auto is) { return std::any_of(study.quantities.begin(), study.quantities.end(), is); };
  if (any([](const Quantity& q) { return q.of_history(); })) overrides.emplace_back("time.frame_every=1");
  if (any([](const Quantity& q) { return !q.body.empty(); })) overrides.emplace_back("output.precision=double");
  overrides.push_back(fmt::format("output.checkpoint_every={{steps: {}}}", read(study, method, overrides).root.at("time").integer("steps")));
  return of(read(study, method, overrides));
}

}  // namespace mortise::study
