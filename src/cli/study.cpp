// mortise study: accuracy against time.
#include <fmt/format.h>

#include <filesystem>
#include <iostream>
#include <memory>
#include <thread>

#include "bench/benchmark.h"
#include "cli/commands.h"
#include "engine/effect_tables.h"
#include "output/atomic_file.h"
#include "scene/scene.h"
#include "study/claim.h"
#include "study/effects_off.h"
#include "study/error_budget.h"
#include "study/orders.h"
#include "study/read.h"
#include "study/report.h"
#include "study/run_study.h"
#include "study/sensitivity.h"

namespace mortise::cli {
namespace {

struct StudyOptions {
  std::string what, output, device = "cpu";
  std::vector<std::string> overrides, vary, quantities, sensitivity;
  std::vector<double> references;
  int threads = 1, repeats = 0;
  double limit = 0, budget = 0;
  bool one_at_a_time = false, effects = false, error_budget = false, dry_run = false, quiet = false, overwrite = false;
};

study::Study of_flags(const StudyOptions& o) {
  study::Study s;
  s.name = std::filesystem::path(o.what).stem().string();
  (bench::find_benchmark(o.what) ? s.benchmark : s.scene) = o.what;
  s.one_at_a_time = o.one_at_a_time;
  for (const std::string& v : o.vary) s.ladders.push_back(study::ladder_of_flag(v));
  for (const std::string& q : o.quantities) s.quantities.push_back(study::quantity_of_flag(q));
  if (!o.references.empty() && o.references.size() != s.quantities.size()) throw Error(Exit::usage, "give one --reference per --qoi");
  for (std::size_t k = 0; k < o.references.size(); ++k) s.quantities[k].reference = o.references[k];
  return s;
}

study::Study study_of(const StudyOptions& o) {
  study::Study s;
  if (study::is_study(o.what)) {
    if (!o.vary.empty() || !o.quantities.empty() || !o.references.empty() || o.one_at_a_time)
      throw Error(Exit::usage, "'" + o.what + "' is a study's file: ladders, quantities, references and plan are written in it");
    s = study::read_study(o.what);
  } else {
    s = of_flags(o);
  }
  s.set.insert(s.set.end(), o.overrides.begin(), o.overrides.end());
  // Without any, those that the scene itself is about.
  if (s.quantities.empty() && !s.scene.empty()) s.quantities = study::quantities_of(scene::read_scene(s.scene, s.set, engine::effect_tables()).root);
  if (s.methods.empty()) s.methods.emplace_back();
  if (o.repeats > 0) s.repeats = o.repeats;
  if (o.limit > 0) s.limit = o.limit;
  s.budget = o.budget;
  if (o.budget > 0 && !study::is_study(o.what)) s.one_at_a_time = true;
  return s;
}

void list_runs(const study::Plan& plan) {
  for (const study::Curve& c : plan.curves)
    for (std::size_t run : c.runs) std::cout << fmt::format("{:30}  {}\n", c.name, plan.runs[run].label);
  std::cerr << plan.runs.size() << " runs; every scene is right\n";
}

std::string values_text(const study::Study& s, const study::RunResult& r) {
  if (r.failed()) return "failed: " + r.message;
  std::string out;
  for (std::size_t k = 0; k < s.quantities.size(); ++k)
    out += fmt::format("{}{} {}", k == 0 ? "" : ", ", s.quantities.size() == 1 ? "" : s.quantities[k].name,
                       std::isfinite(r.values[k]) ? fmt::format("{:.6g}", r.values[k]) : "-");
  return out;
}

int cmd_study(const StudyOptions& o) {
  study::Study s = study_of(o);
  const study::Place place{o.output.empty() ? "out/" + (study::is_study(o.what) ? s.name : "study") : o.output, o.device, o.threads};
  const auto told_run = [&](std::size_t done, std::size_t all, const study::RunResult& r) {
    if (!o.quiet)
      std::cerr << fmt::format("{:>3}{}  {:50} {:>9}{}  {}\n", done, all > 0 ? fmt::format("/{}", all) : "", r.label.empty() ? "as it is" : r.label,
                               study::seconds_text(r.seconds), r.before ? " (before)" : "", values_text(s, r));
  };
  if (o.effects) {
    s.ladders.clear();
    const study::StudyFolder folder(place.folder);
    if (!o.overwrite) study::refuse_another_study(s, "effects", place.folder);
    const auto runs = study::run_without_effects(s, place, {told_run});
    study::note_study(s, "effects", place.folder);
    output::write_file_atomically(place.folder + "/effects.csv", study::effects_csv(s, runs), false);
    std::cout << study::effects_table(s, runs) << "written to " << place.folder << ": effects.csv\n";
    return 0;
  }
  if (o.error_budget) {
    s.ladders.clear();
    const study::StudyFolder folder(place.folder);
    if (!o.overwrite) study::refuse_another_study(s, "error_budget", place.folder);
    const study::ErrorBudget budget = study::find_error_budget(s, place);
    study::note_study(s, "error_budget", place.folder);
    output::write_file_atomically(place.folder + "/error_budget.json", study::budget_json(s, budget), false);
    std::cout << study::budget_table(s, budget) << "written to " << place.folder << ": error_budget.json\n";
    return 0;
  }
  if (!o.sensitivity.empty()) {
    s.ladders.clear();
    const study::StudyFolder folder(place.folder);
    if (!o.overwrite) study::refuse_another_study(s, "sensitivity", place.folder);
    const study::Sensitivities found = study::find_sensitivities(s, o.sensitivity, place);
    study::note_study(s, "sensitivity", place.folder);
    output::write_file_atomically(place.folder + "/sensitivity.csv", study::sensitivity_csv(s, found), false);
    std::cout << study::sensitivity_table(s, found) << "written to " << place.folder << ": sensitivity.csv\n";
    return 0;
  }
  const study::Study apart = study::orders_apart(s);
  const study::Plan plan = study::plan_of(apart);
  if (o.dry_run) return list_runs(plan), 0;
  const study::StudyFolder folder(place.folder);
  if (!o.overwrite) study::refuse_another_study(s, "study", place.folder);
  const study::Results results = study::run_study(apart, place, {told_run});
  study::note_study(s, "study", place.folder);
  study::write_reports(results, place.folder);
  std::cout << study::text_report(results) << "written to " << place.folder << ": study.html, work_precision.svg and .png, points.csv, study.json"
            << (study::recommended_yaml(results).empty() ? "" : ", recommended.yaml") << "\n";
  return 0;
}

}  // namespace

void add_study(Command app, Context& context) {
  const Command sub = app.command("study", "run with varied settings: how wrong is a number, and what would less error cost");
  auto o = std::make_shared<StudyOptions>();
  sub.option("study", o->what, "file of a study (src/study/README.md), a scene, or the name of a benchmark").required();
  sub.option("--set", o->overrides, "path=value of all runs, as for run").one_each();
  const Flag vary = sub.option("--vary", o->vary,
                               "path=v1,v2,... from coarse to fine: a ladder. Several: the first is climbed, combinations of the others are curves")
                        .take_all();
  const Flag one = sub.flag("--one-at-a-time", o->one_at_a_time, "every ladder alone, from the scene as it is");
  sub.option("--qoi", o->quantities,
             "quantity: group/name of any scalar (sensors' too), or a block '{value: contact_pressure, body: pad, over: max}'")
      .take_all();
  sub.option("--reference", o->references,
             "its right value in SI, one per --qoi; default: the limit of the ladder (Richardson, order observed), with its uncertainty");
  sub.option("-o,--output", o->output, "folder of runs, figures and tables; default out/study, of a study's file out/<its name>");
  const Flag repeat = sub.option("--repeat", o->repeats, "runs of every setting; the fastest counts").positive();
  const Flag limit = sub.time("--limit", o->limit, "CPU time of its steps after which a run counts as failed, e.g. '60 s'");
  const Flag effects = sub.flag("--effects", o->effects, "run with every effect off in turn instead: time saved and change of each quantity")
                           .excludes(vary)
                           .excludes(one);
  const Flag budget = sub.flag("--error-budget", o->error_budget,
                               "run the scene once instead, and estimate what its mesh, its time steps, the gap that contact leaves and "
                               "Newton's method make of the quantities")
                          .excludes(vary)
                          .excludes(one)
                          .excludes(effects)
                          .excludes(repeat)
                          .excludes(limit);
  const Flag sensitivity =
      sub.option(
             "--sensitivity", o->sensitivity,
             "path of a number of the scene (materials.pad.youngs_modulus), or `all` of materials and effects: run once instead, and tell what the "
             "quantities change by with each (derivatives along the run)")
          .take_all()
          .excludes(vary)
          .excludes(one)
          .excludes(effects)
          .excludes(repeat)
          .excludes(limit)
          .excludes(budget);
  sub.time("--budget", o->budget, "CPU time of all runs: one knob at a time, then together, always the knob that takes away most error per second")
      .excludes(budget)
      .excludes(sensitivity);
  sub.flag("--dry-run", o->dry_run, "list the runs and check the scene of each").excludes(budget).excludes(sensitivity);
  sub.flag("--overwrite", o->overwrite, "replace the results of another study in the output folder");
  sub.option("--device", o->device, "as for run").environment_variable("MORTISE_DEVICE").show_default();
  sub.option("--threads", o->threads, "CPU threads of every run").positive().show_default();
  sub.flag("-q,--quiet", o->quiet, "no line per run");
  sub.footer(
      "The same command goes on where it was stopped or killed; a finished run is never run again. Time is CPU time of the steps.\n"
      "Examples:\n  mortise study scene.yaml --vary time.step='10 ms,5 ms,2.5 ms' --qoi elasticity/energy      (all runs end at the same time)\n"
      "  mortise study scene.yaml --one-at-a-time --vary time.step='4 ms,2 ms,1 ms' --vary bodies.ball.shape.sphere.edge_length='4 mm,3 mm,2 mm' \\\n"
      "      --qoi '{value: contact_pressure, body: ball, over: max, when: largest}'\n"
      "  mortise study press_study.yaml --budget '5 min'\n  mortise study scene.yaml --effects --qoi supports/ball_z\n"
      "  mortise study scene.yaml --qoi supports/ball_z --sensitivity all\n"
      "  mortise study hertz --vary size=tiny,coarse,small --qoi 'pressure L2, r <= a'      (a benchmark: one curve per method)\n"
      "Exit codes: 0 done, also where some runs failed (the tables say which and why); 5 nothing to compare; 75 stopped by a signal");
  sub.action([o, &context] { context.action = [o] { return cmd_study(*o); }; });
}

}  // namespace mortise::cli
