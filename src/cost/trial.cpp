#include "cost/trial.h"

#include <vector>

#include "base/cpu_time.h"

namespace mortise::cost {

Trial try_steps(engine::Engine& engine, long steps, double most) {
  Trial out;
  std::vector<long> taken;
  const double start = cpu_time();
  while (out.steps < steps) {
    solver::StepReport report;
    const engine::Outcome outcome = engine.step([&] { return cpu_time() - start > most; }, report);
    if (outcome.code != 0) break;
    ++out.steps, out.iterations += report.newton, out.seconds = cpu_time() - start;
    taken.push_back(report.newton);
    if (out.seconds > most) break;
  }
  double later = 0;
  for (std::size_t i = taken.size() / 2; i < taken.size(); ++i) later += static_cast<double>(taken[i]);
  if (!taken.empty()) out.later_iterations = later / static_cast<double>(taken.size() - taken.size() / 2);
  return out;
}

}  // namespace mortise::cost
