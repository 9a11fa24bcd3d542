#include "run/alone.h"

#include "engine/choose.h"
#include "engine/memory_needed.h"
#include "run/memory.h"
#include "run/stopwatch.h"

namespace mortise::run {

void take_step(Turn& turn) {
  const Stopwatch since;
  turn.outcome = turn.of->step(turn.stop, turn.report);
  turn.wall = since.wall(), turn.cpu = since.cpu();
}

Exit run_alone(const Options& o, Turn& turn, Routine<Exit>& run) {
  for (run.start(); !run.done(); turn.go_on()) {
    if (turn.wants == Turn::Wants::step) {
      take_step(turn);
      continue;
    }
    const engine::Choice choice = engine::choose(o.device, o.threads);
    turn.device = choice.device;
    turn.said = compare_memory(engine::memory_needed(*turn.input), choice.device);
    turn.outcome = choice.api->create(*turn.input, *turn.made);
  }
  return run.result();
}

}  // namespace mortise::run
