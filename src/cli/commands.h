#pragma once
// One file per subcommand: add_x() declares its flags and, when the user names it, leaves what to do in the context.
#include <CLI/CLI.hpp>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace mortise::cli {

struct Context {
  std::function<int()> action;  // set by the subcommand that was named; returns the exit code
};

void add_run(CLI::App&, Context&);
void add_render(CLI::App&, Context&);
void add_bench(CLI::App&, Context&);
void add_study(CLI::App&, Context&);
void add_sweep(CLI::App&, Context&);
void add_merge(CLI::App&, Context&);
void add_import(CLI::App&, Context&);
void add_check(CLI::App&, Context&);
void add_schema(CLI::App&, Context&);
void add_effects(CLI::App&, Context&);
void add_info(CLI::App&, Context&);

// The whole program; what main() returns.
int program(std::vector<std::string> arguments);

// `scene` positional and repeatable --set, the same for every command that reads a scene.
void add_scene_options(CLI::App& command, std::string& scene, std::vector<std::string>& overrides);

// --device and --threads, the same for every command that solves. MORTISE_DEVICE in the environment stands for a --device that is not given.
void add_device_options(CLI::App& command, std::string& device, int& threads);

std::string version_text();  // "mortise 0.1.0 (commit)"

}  // namespace mortise::cli
