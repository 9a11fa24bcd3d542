#include "cost/trial.h"

#include <algorithm>
#include <utility>

#include "base/cpu_time.h"

namespace mortise::cost {

Trial try_steps(engine::Engine& engine, long steps, double most, Trial before) {
  Trial out = std::move(before);
  double begun = static_cast<double>(out.iterations), spent = out.seconds;  // with a step that is broken off
  const double start = cpu_time() - out.seconds;
  while (out.steps < steps && cpu_time() - start <= most) {
    solver::StepReport report;
    const engine::Outcome outcome = engine.step([&] { return cpu_time() - start > most; }, report);
    begun += static_cast<double>(report.newton), spent = cpu_time() - start;
    if (outcome.code != 0) break;
    ++out.steps, out.iterations += report.newton, out.seconds = spent;
    out.taken.push_back(report.newton);
  }
  if (spent > 0) out.each = spent / std::max(begun, 1.0);  // of the first, where it was broken off, the least that it takes
  double later = 0;
  const std::size_t half = out.taken.size() / 2;
  for (std::size_t i = half; i < out.taken.size(); ++i) later += static_cast<double>(out.taken[i]);
  if (!out.taken.empty()) out.later_iterations = later / static_cast<double>(out.taken.size() - half);
  return out;
}

}  // namespace mortise::cost
