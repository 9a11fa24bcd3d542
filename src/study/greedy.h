#pragma once
// Refines several knobs together, always the one that takes away most error per CPU second.
#include <cstddef>
#include <optional>
#include <vector>

namespace mortise::study {

// What is known of a ladder from climbing it alone: of every step the error that this knob leaves, and its time over that of the scene as it is; NaN
// of steps that failed.
struct Knob {
  double base_error = 0;
  std::vector<double> error, cost;
};

struct Move {
  std::size_t knob = 0, step = 0;
  double error = 0, cost = 0;  // predicted of the scene after it: errors of knobs add up, times multiply
};

inline constexpr std::size_t kBase = SIZE_MAX;  // a knob as the scene has it

// From `at` (a step, or kBase, per knob) the step of one knob that lowers log(error) most per log(time), among those that take no more than
// `most_cost`; nothing where none lowers the error.
std::optional<Move> best_move(const std::vector<Knob>& knobs, const std::vector<std::size_t>& at, double most_cost);

}  // namespace mortise::study
