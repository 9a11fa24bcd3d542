// mortise run: a scene in, fields and pictures out.
#include "run/run.h"

#include <memory>

#include "cli/commands.h"
#include "cli/run_accuracy.h"
#include "engine/effect_tables.h"
#include "study/error_budget.h"

namespace mortise::cli {

void add_run(Command app, Context& context) {
  const Command sub = app.command("run", "run a scene: fields, checkpoints and pictures go to the output folder");
  auto o = std::make_shared<run::Options>();
  auto goals = std::make_shared<std::vector<std::string>>();
  auto most = std::make_shared<double>(1800);
  o->estimate = study::budget_of_run;
  add_scene_options(sub, o->scene, o->overrides);
  sub.option("-o,--output", o->output, "output folder; default out/<name of the scene, or of its file>");
  const Flag environment =
      sub.option("--environment", o->environment, "run this one of the scene's `environments` alone, as a scene of its own").not_negative();
  sub.option("--episode", o->episode, "and of its episodes this one, in which nothing is reset").not_negative().needs(environment);
  sub.option(
         "--together", o->together,
         "run the scene's `environments` as rows of models: of one for each K of them, of one for all, or (auto) of one for every sixteen on a CPU "
         "and for all on a GPU, where that is what happens anyway; the same bits")
      .maybe_value("auto")
      .check([](const std::string& k) {
        return k == "all" || k == "auto" || (!k.empty() && k.find_first_not_of("0123456789") == std::string::npos && k.size() < 8 && std::stol(k) > 0)
                   ? std::string()
                   : "'" + k + "' is no number of environments, from 1 (the scene goes before --together, or --together=K, or --together=all)";
      })
      .excludes(environment);
  const Flag accuracy =
      sub.option("--accuracy", *goals,
                 "NAME=PERCENT of one of the scene's `quantities`: run with finer meshes, contact layers and time steps, those that matter most per "
                 "second first, until the estimated error is below it")
          .take_all()
          .excludes(environment);
  sub.time("--accuracy-budget", *most, "CPU time of all runs of it together; default 30 min").needs(accuracy);
  const Flag overwrite = sub.flag("--overwrite", o->overwrite, "replace the results in the output folder");
  sub.option("--resume", o->resume,
             "continue from the newest good checkpoint (--checkpoint-every says how often there is one); --resume=auto starts afresh where there is "
             "none")
      .maybe_value("yes")
      .one_of({"yes", "auto"})
      .excludes(overwrite)
      .excludes(accuracy);
  sub.option("--frames", o->frames, "stop after so many frames; the state at the start does not count").not_negative().excludes(accuracy);
  auto limits = std::make_shared<TimeLimits>();
  add_time_limits(sub, *limits);
  const Flag bridge =
      sub.option("--bridge", o->bridge,
                 "a program that drives the scene's motors, step by step, by lines of JSON (src/bridge): a command for the shell, or - "
                 "for the standard streams")
          .check([](const std::string& command) {
            return command.find_first_not_of(" \t") == std::string::npos ? std::string("needs a command, or - for the standard streams")
                                                                         : std::string();
          })
          .excludes(accuracy);
  const Flag every =
      sub.option("--bridge-every", o->bridge_every, "time steps from one message of it to the next; default 1").positive().needs(bridge);
  sub.time("--bridge-timeout", o->bridge_timeout, "how long an answer may take, 0 s for ever; default 60 s, then exit 8 with a checkpoint")
      .needs(bridge);
  sub.option("--replay", o->replay, "drive the motors as the output folder (or its bridge.jsonl) of an earlier run recorded it")
      .excludes(bridge)
      .excludes(every)
      .excludes(accuracy);
  add_device_options(sub, o->device, o->threads);
  sub.flag("--no-render", o->no_render, "no pictures; fewer of them: `render: {every: N}` in the scene");
  sub.flag("--json", o->json, "one JSON object per event on stdout instead of progress lines").excludes(accuracy);
  sub.flag("-q,--quiet", o->quiet, "errors only");
  sub.footer(
      "Examples:\n  mortise run scenes/tactile/press.yaml -o out/press\n  mortise run scene.yaml --set time.steps=10 --frames 5 --no-render\n"
      "  mortise run scene.yaml -o out/a --accuracy peak=2% --accuracy force=1%\n"
      "  mortise run scene.yaml -o out/a --resume=auto         (exit 75 = stopped by a signal: run the same again)\n"
      "  mortise run arm.yaml -o out/arm --bridge 'python3 tools/bridge_policy.py' --bridge-every 4\n"
      "  mortise run arm.yaml -o out/again --replay out/arm    (the same, bit for bit, without the program)");
  sub.action([=, &context] {
    context.action = [=] {
      limits->check();
      o->walltime = limits->walltime, o->grace = limits->grace, o->checkpoint_every = limits->checkpoint_every;
      return goals->empty() ? static_cast<int>(run::run_scene(*o, engine::effect_tables())) : run_to_accuracy(*o, *goals, *most);
    };
  });
}

}  // namespace mortise::cli
