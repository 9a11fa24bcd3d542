#include "cost/scout.h"

#include <memory>

#include "base/cpu_time.h"
#include "cost/coarser.h"
#include "cost/predict.h"
#include "cost/tuning.h"
#include "engine/choose.h"
#include "engine/input.h"

namespace mortise::cost {
namespace {

// Null where there is no such mesh, or bodies touch at the start.
std::unique_ptr<engine::Engine> begun(const Params& scene) {
  try {
    std::unique_ptr<engine::Engine> engine;
    if (engine::chosen().api->create(engine::make_input(scene), engine).code == 0 && engine->begin().code == 0) return engine;
  } catch (const Error&) {
    // A mesh that cannot be made so coarse.
  }
  return nullptr;
}

}  // namespace

Passed Scouted::until(double step) const {
  Passed before;
  for (std::size_t i = 0; i < steps.size(); before = steps[i++]) {
    const double part = step - static_cast<double>(i);
    if (part < 1)
      return {before.iterations + part * (steps[i].iterations - before.iterations), before.seconds + part * (steps[i].seconds - before.seconds)};
  }
  return before;
}

double coarse_enough(const model::ModelInput& input, const std::string& linear_solver, double expected, double most) {
  const double now = iteration_seconds(work_of(input, linear_solver));
  double best = 1, shortest = expected;
  for (const double edges : tuning::kScoutEdges) {
    const double course = expected * iteration_seconds(work_of(input, linear_solver, edges)) / now;
    if (course < shortest) best = edges, shortest = course;
    if (course <= most) break;
  }
  return best;
}

Scouted scout(const Params& scene, double edges, double most) {
  Scouted out{edges, {}};
  const std::unique_ptr<engine::Engine> engine = begun(coarser(scene, edges));
  if (!engine) return out;
  const double start = cpu_time();
  const auto over = [&] { return cpu_time() - start > most; };
  Passed all;
  for (long step = scene.at("time").integer("steps"); step > 0 && !over(); --step) {
    solver::StepReport report;
    if (engine->step(over, report).code != 0) break;
    all.iterations += static_cast<double>(report.newton), all.seconds = cpu_time() - start;
    out.steps.push_back(all);
  }
  return out;
}

}  // namespace mortise::cost
