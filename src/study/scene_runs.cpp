#include "study/scene_runs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "bench/harness.h"
#include "engine/effect_tables.h"
#include "study/limit.h"

namespace mortise::study {
namespace {

double end_time(const scene::Scene& scene) {
  const Params& time = scene.root.at("time");
  return time.text("mode") == "static" ? 1 : time.number("step") * static_cast<double>(time.integer("steps"));
}

bool same(double a, double b) { return std::abs(a - b) <= 1e-9 * std::abs(b); }

bool varies(const Settings& settings, const char* key) {
  return std::any_of(settings.begin(), settings.end(), [key](const auto& s) { return s.first == key; });
}

}  // namespace

std::vector<std::string> overrides_of(const Study& study, const Settings& settings) {
  const std::vector<scene::EffectTable> tables = engine::effect_tables();
  std::vector<std::string> out = study.overrides;
  for (const auto& [key, value] : settings) out.push_back(key + "=" + value);
  const scene::Scene varied = scene::read_scene(study.scene, out, tables);
  if (varied.root.has("environments"))
    throw Error(Exit::usage, "a study runs one environment at a time: take the 'environments' block out of the scene");
  const double end = end_time(scene::read_scene(study.scene, study.overrides, tables)), now = end_time(varied);
  if (same(now, end)) return out;
  if (varies(settings, "time.step") && !varies(settings, "time.steps")) {
    const double step = varied.root.at("time").number("step"), steps = std::round(end / step);
    if (!same(steps * step, end))
      throw Error(Exit::usage, fmt::format("--vary time.step: steps of {:g} s do not end at {:g} s, when the scene does", step, end));
    out.push_back(fmt::format("time.steps={}", static_cast<long>(steps)));
    return out;
  }
  throw Error(Exit::usage,
              fmt::format("the runs would end at {:g} s and {:g} s, where their results do not compare; vary time.step alone", end, now));
}

void run_scenes(const Study& study, const std::vector<Settings>& runs, std::vector<Point>& points, std::vector<std::string>& references) {
  const std::vector<scene::EffectTable> tables = engine::effect_tables();
  std::vector<std::vector<std::string>> overrides;  // of all runs before the first: nothing is run in vain
  for (const Settings& settings : runs) overrides.push_back(overrides_of(study, settings));
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const scene::Scene scene = scene::read_scene(study.scene, overrides[r], tables);
    bench::Solved s = bench::solve(scene);
    for (int i = 1; i < study.repeats; ++i) s.seconds = std::min(s.seconds, bench::solve(scene).seconds);
    for (const std::string& q : study.quantities) {
      Point p;
      p.settings = runs[r], p.quantity = q, p.seconds = s.seconds, p.newton_iterations = s.newton, p.dofs = s.dofs;
      p.failed = !s.converged;
      p.value = s.converged ? s.fields.at(q) : NAN;
      if (s.converged && !s.fields.number.contains(q)) {
        std::string known;
        for (const auto& [name, v] : s.fields.number) known += "\n  " + name;
        throw Error(Exit::usage, "--qoi " + q + ": nothing reports it; there are" + known);
      }
      points.push_back(p);
    }
  }
  const std::vector<double> sizes = ladder_sizes(study.vary.front().values);
  for (std::size_t k = 0; k < study.quantities.size(); ++k) {
    Limit limit{NAN, false, "given"};
    if (!study.references.empty()) {
      limit.value = study.references.at(k);
    } else {
      std::vector<double> ladder;
      const std::size_t steps = study.vary.front().values.size();
      for (std::size_t i = 0; i < steps; ++i) ladder.push_back(points[i * study.quantities.size() + k].value);
      Point& finest = points[(steps - 1) * study.quantities.size() + k];
      if (finest.failed) throw Error(Exit::solve, "the run that the others are compared with did not converge; give --reference");
      limit = limit_of(sizes, ladder);
      finest.reference = !limit.extrapolated;
    }
    references.push_back(fmt::format("{}: compared with {:.6g} ({})", study.quantities[k], limit.value, limit.how));
    for (std::size_t i = k; i < points.size(); i += study.quantities.size())
      points[i].error = limit.value != 0 ? std::abs(points[i].value / limit.value - 1) : std::abs(points[i].value);
  }
}

}  // namespace mortise::study
