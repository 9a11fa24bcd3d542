// mortise check: every error of a scene at once.
#include <algorithm>
#include <iostream>
#include <map>
#include <memory>
#include <set>

#include "cli/commands.h"
#include "cli/plan.h"
#include "engine/effect_tables.h"
#include "engine/input.h"
#include "run/check_start.h"
#include "run/warnings.h"
#include "scene/environments.h"
#include "scene/suggest.h"

namespace mortise::cli {
namespace {

struct CheckOptions {
  std::string scene;
  std::vector<std::string> overrides;
  bool print_resolved = false, plan = false, quick = false;
  long environment = -1;
};

// "3 bodies (2 soft, 1 half_space); effects inertia, gravity; 60 steps"
std::string summary(const Params& scene) {
  std::map<std::string, int> types;
  for (const auto& [name, body] : scene.at("bodies").entries()) ++types[body.text("type")];
  std::vector<std::string> bodies, effects;
  for (const auto& [type, count] : types) bodies.push_back(std::to_string(count) + " " + type);
  for (const auto& [name, block] : scene.at("effects").entries()) effects.push_back(name);
  const std::size_t n = scene.at("bodies").entries().size();
  return std::to_string(n) + (n == 1 ? " body (" : " bodies (") + scene::join(bodies, ", ") + "); effects " + scene::join(effects, ", ") + "; " +
         std::to_string(scene.at("time").integer("steps")) + (scene.at("time").text("mode") == "static" ? " load steps" : " steps");
}

// All that would keep a run of the scene from its first step.
void check_run(const Params& scene, const std::string& called, std::set<std::string>& warned, const std::vector<Params>& resets = {}) {
  const model::ModelInput input = engine::make_input(scene);
  run::check_start(scene, input, resets);
  for (const std::string& w : run::warnings(input))
    if (warned.insert(w).second) std::cerr << "warning: " << (w.starts_with(called) ? "" : called) << w << "\n";  // places may name it already
}

int cmd_check(const CheckOptions& o) {
  const std::vector<scene::EffectTable> tables = engine::effect_tables();
  scene::Scene scene = scene::read_scene(o.scene, o.overrides, tables);
  if (o.environment >= 0) scene = scene::one_environment(scene, o.overrides, tables, o.environment);
  const long environments = scene::environment_count(scene.root);
  if (o.print_resolved) {
    std::cout << scene::to_yaml(scene.root);
    return 0;
  }
  if (o.plan) {
    if (environments > 0) {
      std::cout << "environments  " << environments << ", each a process with what follows; one per CPU thread at a time\n";
      scene = scene::environment_of(scene, o.overrides, tables, 0);
    }
    std::cout << plan_text(scene.root);
    return 0;
  }
  std::set<std::string> warned;
  if (!o.quick && environments == 0) check_run(scene.root, "", warned);
  if (environments > 0 && !o.quick) engine::keep_meshes(scene.root);
  const Params* reset = environments > 0 ? scene.root.at("environments").find("reset") : nullptr;
  const std::vector<Params> resets = reset ? reset->items() : std::vector<Params>();
  const bool goes_on = std::any_of(resets.begin(), resets.end(), [](const Params& c) { return c.has("failure"); });
  long failed = 0;
  for (long e = 0; e < environments; ++e) {
    const std::string called = "environment " + std::to_string(e) + ": ";
    const scene::Scene one = scene::environment_of(scene, o.overrides, tables, e);
    if (o.quick) continue;
    try {
      check_run(one.root, called, warned, resets);
    } catch (const Error& error) {
      std::string text = error.what();
      if (text.starts_with(called)) throw;
      const std::string mark = ": error: ";
      text.insert(error.located() ? text.find(mark) + mark.size() : 0, called);
      if (!goes_on || error.code() != Exit::scene || ++failed == environments) throw Error(error.code(), text, error.located());
      std::cerr << "warning: a start that fails, after which the environment is reset:\n" << text << "\n";
    }
  }
  std::cout << (o.scene == "-" ? "<stdin>" : o.scene) << ": valid: " << summary(scene.root)
            << (environments > 0 ? "; " + std::to_string(environments) + " environments" : "") << "\n";
  return 0;
}

}  // namespace

void add_check(Command app, Context& context) {
  const Command sub = app.command("check", "report every error in a scene, and all that would keep a run from its first step");
  auto o = std::make_shared<CheckOptions>();
  add_scene_options(sub, o->scene, o->overrides);
  sub.flag("--print-resolved", o->print_resolved, "print the scene with all defaults filled in and every number in SI");
  sub.flag(
      "--plan", o->plan,
      "list effects, buffers, bytes and kernels of a run too, what passes through what, and how long the steps will take: from runs that were, or "
      "from the first steps, which are tried for two seconds, and a coarser run of the others");
  sub.flag("--quick", o->quick, "read the scene alone: no meshes, no files of motions, no search for bodies that touch");
  sub.option("--environment", o->environment, "of this one of the scene's `environments`, which is a scene of its own").not_negative();
  sub.footer(
      "Examples:\n  mortise check scene.yaml\n  mortise check scene.yaml --set effects.friction.mu=0.3 --print-resolved\n"
      "  generate_scene.py | mortise check -");
  sub.action([o, &context] { context.action = [o] { return cmd_check(*o); }; });
}

}  // namespace mortise::cli
