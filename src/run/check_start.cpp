#include "run/check_start.h"

#include "engine/api.h"
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

}  // namespace

std::unique_ptr<engine::Engine> check_start(const Params& scene, const model::ModelInput& input, const std::vector<Params>& resets) {
  std::unique_ptr<engine::Engine> engine;
  must_succeed(engine::cpu_api().create(input, engine));
  sensors::Sensors sensors(input);
  const std::vector<double> points = engine->points();
  Snapshot start;
  engine->report(start);
  sensors.read(start, points);
  ResetWatch(resets, input).check(scene, start);
  check_quantities(scene, start);
  if (scene.has("render") && scene.at("output").flag("pictures")) {
    render::SceneView view(scene, input.bodies);
    view.move(points);
    for (const std::string& camera : view.cameras()) render::check_job(view.job(camera, start.drawable(), ""));
  }
  must_succeed(engine->begin());
  return engine;
}

}  // namespace mortise::run
