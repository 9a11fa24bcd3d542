#include "study/sensitivity.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "engine/choose.h"
#include "engine/effect_tables.h"
#include "run/signals.h"
#include "scene/scene.h"
#include "study/course.h"
#include "study/tuning.h"

namespace mortise::study {
namespace {

template <class Cell>
bool same_cells(const std::vector<Cell>& a, const std::vector<Cell>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Cell& x, const Cell& y) { return std::ranges::equal(x.v, y.v); });
}

// Corner for corner the same connections; nodes may have moved.
bool same_meshes(const model::ModelInput& a, const model::ModelInput& b) {
  return std::equal(a.bodies.begin(), a.bodies.end(), b.bodies.begin(), b.bodies.end(), [](const model::BodyInput& x, const model::BodyInput& y) {
    return x.nodes.size() == y.nodes.size() && same_cells(x.tets, y.tets) && same_cells(x.triangles, y.triangles);
  });
}

// The message of the first of the errors, without its place.
std::string reason_of(const Error& e) {
  std::string text = e.what();
  if (const std::size_t at = text.find("error: "); at != std::string::npos) text = text.substr(at + 7);
  return text.substr(0, text.find('\n'));
}

// The two neighbours of a parameter's value.
struct Pair {
  std::size_t parameter;
  std::unique_ptr<Course> less, more;
};

}  // namespace

Sensitivities find_sensitivities(const Study& study, const std::vector<std::string>& paths, const Place& place) {
  run::install_signal_handlers();
  if (study.scene.empty()) throw Error(Exit::usage, "--sensitivity is for scenes, not for benchmarks");
  if (study.quantities.empty()) throw Error(Exit::usage, "no quantity to differentiate: give --qoi group/name");
  const auto tables = engine::effect_tables();
  const std::string text = variant_of(study, study.methods.front(), {}).yaml, precise = "output.precision=double";
  const scene::Scene scene = scene::read_scene_text(text, study.scene, {precise}, tables);

  Sensitivities out;
  for (const std::string& path : paths) {
    const SourceLoc at{"--sensitivity " + path, 0, 0};
    const std::vector<Parameter> found = path == "all" ? all_parameters(scene.root) : std::vector<Parameter>{parameter(scene.root, path, at)};
    for (const Parameter& p : found)
      if (std::none_of(out.parameters.begin(), out.parameters.end(), [&](const Sensitivity& s) { return s.parameter.path == p.path; }))
        out.parameters.push_back({p, "", std::vector<Derivative>(study.quantities.size())});
  }

  const engine::Choice choice = engine::choose(place.device, place.threads);
  const std::string folder = place.folder + "/runs/sensitivity";
  std::error_code ec;
  std::filesystem::create_directories(place.folder + "/runs", ec);
  Course base(scene, folder + ".vtkhdf", choice);
  check(base.engine().begin());
  std::vector<Pair> pairs;
  for (std::size_t k = 0; k < out.parameters.size(); ++k) try {
      Pair pair{k, {}, {}};
      for (double sign : {-1.0, 1.0}) {
        const std::string change = out.parameters[k].parameter.scaled(1 + sign * tuning::kHair);
        const scene::Scene beside = scene::read_scene_text(text, study.scene, {precise, change}, tables);
        auto course = std::make_unique<Course>(beside, fmt::format("{}_{}{}.vtkhdf", folder, k, sign < 0 ? "a" : "b"), choice);
        if (!same_meshes(base.input(), course->input()))
          throw Error(Exit::usage, "it changes the connections of a mesh: there is no derivative with respect to it");
        check(base.engine().lead({&course->engine()}));
        check(course->engine().begin());
        (sign < 0 ? pair.less : pair.more) = std::move(course);
      }
      pairs.push_back(std::move(pair));
    } catch (const Error& e) {
      if (e.code() == Exit::file || e.code() == Exit::stopped) throw;
      out.parameters[k].refused = reason_of(e);
    }
  std::vector<Course*> courses;
  for (Pair& pair : pairs) courses.insert(courses.end(), {pair.less.get(), pair.more.get()});
  out.seconds = take(base, courses);

  out.values = base.measure(study.quantities);
  for (Pair& pair : pairs) {
    for (Course* course : {pair.less.get(), pair.more.get()})
      if (const std::string why = course->engine().lost(); !why.empty()) out.parameters[pair.parameter].refused = why;
    if (!out.parameters[pair.parameter].refused.empty()) continue;
    const std::vector<double> less = pair.less->measure(study.quantities), more = pair.more->measure(study.quantities);
    for (std::size_t q = 0; q < out.values.size(); ++q) {
      Derivative& d = out.parameters[pair.parameter].of[q];
      d.below = (out.values[q] - less[q]) / tuning::kHair, d.above = (more[q] - out.values[q]) / tuning::kHair;
      d.kink = d.uncertainty() > tuning::kKink * std::abs(d.central()) && d.uncertainty() > tuning::kNoDerivative * std::abs(out.values[q]);
    }
  }
  return out;
}

}  // namespace mortise::study
