#pragma once
// One file per subcommand: add_x() declares its flags and, when the user names it, leaves what to do in the context.
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "cli/flags.h"
#include "scene/scene.h"

namespace mortise::cli {

struct Context {
  std::function<int()> action;  // set by the subcommand that was named; returns the exit code
};

void add_run(Command, Context&);
void add_render(Command, Context&);
void add_bench(Command, Context&);
void add_study(Command, Context&);
void add_sweep(Command, Context&);
void add_merge(Command, Context&);
void add_import(Command, Context&);
void add_export(Command, Context&);
void add_check(Command, Context&);
void add_schema(Command, Context&);
void add_effects(Command, Context&);
void add_info(Command, Context&);

// The whole program; what main() returns.
int program(std::vector<std::string> arguments);

// `scene` positional and repeatable --set, the same for every command that reads a scene.
void add_scene_options(Command command, std::string& scene, std::vector<std::string>& overrides);

// --device and --threads, the same for every command that solves. MORTISE_DEVICE in the environment stands for a --device that is not given.
void add_device_option(Command command, std::string& device);
void add_device_options(Command command, std::string& device, int& threads);

// When a run stops by itself and when it writes checkpoints [s], the same for every command that may run for hours.
struct TimeLimits {
  double walltime = 0, grace = 60;  // walltime 0: none
  double checkpoint_every = -1;     // below 0: as the scene says
  // Throws Error(Exit::usage) where no time is left to run, or none between checkpoints.
  void check() const;
};
void add_time_limits(Command command, TimeLimits& limits);

std::string version_text();  // "mortise 0.1.0 (commit)"

}  // namespace mortise::cli
