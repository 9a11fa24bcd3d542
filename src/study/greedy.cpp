#include "study/greedy.h"

#include <cmath>

#include "study/tuning.h"

namespace mortise::study {
namespace {

double error_at(const Knob& k, std::size_t step) { return step == kBase ? k.base_error : k.error[step]; }
double cost_at(const Knob& k, std::size_t step) { return step == kBase ? 1 : k.cost[step]; }

}  // namespace

std::optional<Move> best_move(const std::vector<Knob>& knobs, const std::vector<std::size_t>& at, double most_cost) {
  double error = 0, cost = 1;
  for (std::size_t k = 0; k < knobs.size(); ++k) error += error_at(knobs[k], at[k]), cost *= cost_at(knobs[k], at[k]);
  std::optional<Move> best;
  double gain = 0;
  for (std::size_t k = 0; k < knobs.size(); ++k)
    for (std::size_t s = 0; s < knobs[k].error.size(); ++s) {
      const double e = error - error_at(knobs[k], at[k]) + knobs[k].error[s], c = cost / cost_at(knobs[k], at[k]) * knobs[k].cost[s];
      if (!(e < error) || !(c <= most_cost)) continue;
      const double down = std::log(error / std::fmax(e, tuning::kRounding)), up = std::log(c / cost);
      const double per_time = up > 0 ? down / up : INFINITY;
      if (per_time > gain || (per_time == gain && best && e < best->error)) best = {k, s, e, c}, gain = per_time;
    }
  return best;
}

}  // namespace mortise::study
