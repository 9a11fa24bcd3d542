// mortise check: every error of a scene at once.
#include <iostream>
#include <map>
#include <memory>

#include "cli/commands.h"
#include "cli/plan.h"
#include "engine/effect_tables.h"
#include "engine/input.h"
#include "run/check_start.h"
#include "run/warnings.h"
#include "scene/suggest.h"

namespace mortise::cli {
namespace {

struct Options {
  std::string scene;
  std::vector<std::string> overrides;
  bool print_resolved = false, plan = false, quick = false;
};

// "3 bodies (2 soft, 1 half_space); effects inertia, gravity; 60 steps"
std::string summary(const Params& scene) {
  std::map<std::string, int> types;
  for (const auto& [name, body] : scene.at("bodies").entries()) ++types[body.text("type")];
  std::vector<std::string> bodies, effects;
  for (const auto& [type, count] : types) bodies.push_back(std::to_string(count) + " " + type);
  for (const auto& [name, block] : scene.at("effects").entries()) effects.push_back(name);
  const std::size_t n = scene.at("bodies").entries().size();
  return std::to_string(n) + (n == 1 ? " body (" : " bodies (") + scene::join(bodies, ", ") + "); effects " +
         scene::join(effects, ", ") + "; " + std::to_string(scene.at("time").integer("steps")) +
         (scene.at("time").text("mode") == "static" ? " load steps" : " steps");
}

int cmd_check(const Options& o) {
  const scene::Scene scene = scene::read_scene(o.scene, o.overrides, engine::effect_tables());
  if (o.print_resolved) {
    std::cout << scene::to_yaml(scene.root);
    return 0;
  }
  if (o.plan) {
    std::cout << plan_text(scene.root);
    return 0;
  }
  if (!o.quick) {
    const model::ModelInput input = engine::make_input(scene.root);
    run::check_start(scene.root, input);
    for (const std::string& w : run::warnings(input)) std::cerr << "warning: " << w << "\n";
  }
  std::cout << (o.scene == "-" ? "<stdin>" : o.scene) << ": valid: " << summary(scene.root) << "\n";
  return 0;
}

}  // namespace

void add_check(CLI::App& app, Context& context) {
  CLI::App* sub = app.add_subcommand("check", "report every error in a scene, and all that would keep a run from its first step");
  auto o = std::make_shared<Options>();
  add_scene_options(*sub, o->scene, o->overrides);
  sub->add_flag("--print-resolved", o->print_resolved, "print the scene with all defaults filled in and every number in SI");
  sub->add_flag("--plan", o->plan, "list effects, buffers, bytes and kernels of a run too, and what passes through what");
  sub->add_flag("--quick", o->quick, "read the scene alone: no meshes, no search for bodies that touch");
  sub->footer(
      "Examples:\n  mortise check scene.yaml\n  mortise check scene.yaml --set effects.friction.mu=0.3 --print-resolved\n"
      "  generate_scene.py | mortise check -");
  sub->callback([o, &context] { context.action = [o] { return cmd_check(*o); }; });
}

}  // namespace mortise::cli
