// mortise run: a scene in, fields and pictures out.
#include "run/run.h"

#include <memory>

#include "cli/commands.h"
#include "engine/effect_tables.h"
#include "scene/quantity.h"

namespace mortise::cli {

void add_run(CLI::App& app, Context& context) {
  CLI::App* sub = app.add_subcommand("run", "run a scene: fields, checkpoints and pictures go to the output folder");
  auto o = std::make_shared<run::Options>();
  add_scene_options(*sub, o->scene, o->overrides);
  sub->add_option("-o,--output", o->output, "output folder; default out/<name of the scene>");
  sub->add_option("--environment", o->environment, "run this one of the scene's `environments` alone, as a scene of its own")
      ->check(CLI::NonNegativeNumber);
  sub->add_option("--episode", o->episode, "and of its episodes this one, in which nothing is reset")
      ->check(CLI::NonNegativeNumber)
      ->needs("--environment");
  auto* overwrite = sub->add_flag("--overwrite", o->overwrite, "replace the results in the output folder");
  sub->add_option("--resume", o->resume,
                  "continue from the newest good checkpoint (`output.checkpoint_every` says how often there is one); --resume=auto starts afresh "
                  "where there is none")
      ->expected(0, 1)
      ->default_str("yes")
      ->check(CLI::IsMember({"yes", "auto"}))
      ->excludes(overwrite);
  sub->add_option("--frames", o->frames, "stop after so many frames; the state at the start does not count")->check(CLI::NonNegativeNumber);
  const auto seconds = [](double& to) {
    return [&to](const std::string& text) {
      const scene::Quantity q = scene::parse_quantity(text, Unit::time);
      if (!q.error.empty()) throw CLI::ValidationError("a time " + q.error + (q.hint.empty() ? "" : "\n  " + q.hint));
      to = q.value;
    };
  };
  auto* walltime = sub->add_option_function<std::string>("--walltime", seconds(o->walltime),
                                                         "stop with a checkpoint (exit 75) before so much time is over, e.g. '4 h'");
  sub->add_option_function<std::string>("--grace", seconds(o->grace),
                                        "how long before; a Newton iteration and a checkpoint have to fit in (default 60 s)")
      ->needs(walltime);
  add_device_options(*sub, o->device, o->threads);
  sub->add_flag("--no-render", o->no_render, "no pictures; fewer of them: `render: {every: N}` in the scene");
  sub->add_flag("--json", o->json, "one JSON object per event on stdout instead of progress lines");
  sub->add_flag("-q,--quiet", o->quiet, "errors only");
  sub->footer(
      "Examples:\n  mortise run scenes/tactile/press.yaml -o out/press\n  mortise run scene.yaml --set time.steps=10 --frames 5 --no-render\n"
      "  mortise run scene.yaml -o out/a --resume=auto         (exit 75 = stopped by a signal: run the same again)");
  sub->callback([o, &context] { context.action = [o] { return static_cast<int>(run::run_scene(*o, engine::effect_tables())); }; });
}

}  // namespace mortise::cli
