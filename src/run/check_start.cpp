#include "run/check_start.h"

#include <optional>

#include "base/complaints.h"
#include "engine/api.h"
#include "engine/input.h"
#include "render/from_scene.h"
#include "render/renderer.h"
#include "run/reported.h"
#include "run/reset_watch.h"
#include "sensors/sensors.h"

namespace mortise::run {
namespace {

void must_succeed(const engine::Outcome& outcome) {
  if (outcome.code != 0) throw Error(static_cast<Exit>(outcome.code), outcome.message, outcome.located);
}

// An engine that has not stepped, and what is reported then.
struct Start {
  std::unique_ptr<engine::Engine> engine;
  std::vector<double> points;
  Snapshot said;
};

Start start_of(const model::ModelInput& input) {
  Start out;
  Complaints wrong;
  std::optional<sensors::Sensors> sensors;
  wrong.gather([&] { must_succeed(engine::cpu_api().create(input, out.engine)); });
  wrong.gather([&] { sensors.emplace(input); });
  wrong.raise();
  out.points = out.engine->points();
  out.engine->report(out.said);
  sensors->read(out.said, out.points);
  return out;
}

}  // namespace

std::unique_ptr<engine::Engine> check_start(const Params& scene, const model::ModelInput& input, const std::vector<Params>& resets) {
  auto [engine, points, start] = start_of(input);
  Complaints wrong;
  wrong.gather([&] { ResetWatch(resets, input).check(start); });
  wrong.gather([&] { check_quantities(input, start); });
  wrong.raise();
  if (scene.has("render") && scene.at("output").flag("pictures")) {
    render::SceneView view(scene, input.bodies);
    view.move(points);
    for (const std::string& camera : view.cameras()) render::check_job(view.job(camera, start.drawable(), ""));
  }
  must_succeed(engine->begin());
  return std::move(engine);
}

void check_reported(const Params& scene, const std::vector<std::string>& scalars, const std::string& what, const SourceLoc& where) {
  Snapshot start;
  try {
    start = start_of(engine::make_input(scene)).said;
  } catch (const Error&) {
    return;
  }
  for (const std::string& scalar : scalars)
    if (!may_report(scalar, scene, start)) not_reported(where, what, scalar, scene, start);
}

}  // namespace mortise::run
