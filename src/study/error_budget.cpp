#include "study/error_budget.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/cpu_time.h"
#include "engine/effect_tables.h"
#include "engine/input.h"
#include "output/field_reader.h"
#include "run/signals.h"
#include "scene/scene.h"
#include "study/error_watch.h"
#include "study/measure.h"
#include "study/read.h"

namespace mortise::study {
namespace {

// Of a run of its own folder.
class Beside final : public run::Estimate {
 public:
  explicit Beside(const run::EstimateOf& of)
      : quantities_(quantities_of(of.input.scene)),
        watch_(of.engine, of.input, quantities_, {engine::chosen().api, of.folder, false}),
        fields_(of.folder + "/fields.vtkhdf") {}
  void before_step() override { watch_.before_step(); }
  void after_step(const solver::StepReport& report, bool frame) override { watch_.after_step(report, frame); }
  std::string end() override {
    ErrorBudget budget = watch_.end();
    const output::FieldReader reader(fields_);
    for (std::size_t k = 0; k < quantities_.size(); ++k) try {  // a run that took hours does not fail for a name that nothing reports
        budget.of[k].value = measure(reader, quantities_[k]);
      } catch (const Error& e) {
        budget.of[k].why_not = e.what();
      }
    return budget_entries(quantities_, budget);
  }

 private:
  const std::vector<Quantity> quantities_;
  ErrorWatch watch_;
  const std::string fields_;
};

}  // namespace

double QuantityBudget::sum() const {
  double out = 0;
  for (const ErrorPart& part : parts) out += std::isfinite(part.error) ? part.error : 0;
  return out;
}

bool QuantityBudget::complete() const {
  return std::all_of(parts.begin(), parts.end(), [](const ErrorPart& p) { return std::isfinite(p.error); });
}

std::unique_ptr<run::Estimate> estimate_beside(const run::EstimateOf& run) {
  if (quantities_of(run.input.scene).empty()) return nullptr;
  return std::make_unique<Beside>(run);
}

ErrorBudget find_error_budget(const Study& study, const Place& place) {
  run::install_signal_handlers();
  if (study.scene.empty()) throw Error(Exit::usage, "--error-budget is for scenes, not for benchmarks");
  if (study.quantities.empty()) throw Error(Exit::usage, "no quantity to look at: give --qoi group/name");
  const scene::Scene scene =
      scene::read_scene_text(variant_of(study, study.methods.front(), {}).yaml, study.scene, {"output.precision=double"}, engine::effect_tables());
  const Params& time = scene.root.at("time");
  const long steps = time.integer("steps"), every = time.integer("frame_every");
  const engine::Choice choice = engine::choose(place.device, place.threads);
  const std::string folder = place.folder + "/runs";
  std::error_code ec;
  std::filesystem::create_directories(folder, ec);
  const model::ModelInput input = engine::make_input(scene.root);
  std::unique_ptr<engine::Engine> engine;
  check(choice.api->create(input, engine));
  ErrorWatch watch(*engine, input, study.quantities, {choice.api, folder, true});
  double solve_seconds = 0;
  check(engine->begin());
  for (long step = 1; step <= steps; ++step) {
    watch.before_step();
    const double start = cpu_time(), beside = engine->beside_time().cpu;
    solver::StepReport report;
    check(engine->step(run::stop_asked, report));
    solve_seconds += cpu_time() - start - (engine->beside_time().cpu - beside);
    watch.after_step(report, step % every == 0 || step == steps);
  }
  ErrorBudget out = watch.end();
  out.solve_seconds = solve_seconds;
  return out;
}

}  // namespace mortise::study
