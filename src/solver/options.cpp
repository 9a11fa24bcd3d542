#include "solver/options.h"

#include <algorithm>

#include "effects/list.h"

namespace mortise::solver {

Options read_options(const Params& scene) {
  Options o;
  const Params& s = scene.at("solver");
  o.force_tolerance = s.number("force_tolerance");
  o.relative_tolerance = s.number("relative_tolerance");
  o.step_tolerance = s.number("step_tolerance");
  o.iterations = static_cast<Index>(s.integer("iterations"));
  o.halvings = static_cast<Index>(s.integer("halvings"));
  o.linear = s.text("linear");
  o.batch = scene.find("environments") != nullptr;
  o.cg_tolerance = s.number("cg_tolerance");
  o.cg_forcing = s.text("cg_forcing") == "eisenstat_walker";
  o.preconditioner = s.text("preconditioner");
  o.trace = s.flag("trace");
  o.cg_iterations = static_cast<Index>(s.integer("cg_iterations"));

  const Params& time = scene.at("time");
  o.is_static = time.text("mode") == "static";
  o.steps = static_cast<Index>(time.integer("steps"));
  o.dt = o.is_static ? 1.0 / o.steps : time.number("step");

  // Whichever effect lags something says how well it wants that resolved; the strictest wins.
  bool any = false;
  for (const effects::Kind& kind : effects::list()) {
    const Params* block = kind.lags ? scene.at("effects").find(kind.name) : nullptr;
    if (!block) continue;
    const double tolerance = block->number("lag_tolerance");
    const Index rounds = static_cast<Index>(block->integer("lag_iterations"));
    o.lag_tolerance = !any ? tolerance : std::min(o.lag_tolerance, tolerance);
    o.lag_iterations = !any ? rounds : std::max(o.lag_iterations, rounds);
    any = true;
  }
  return o;
}

}  // namespace mortise::solver
