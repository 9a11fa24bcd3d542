#include "study/error_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/cpu_time.h"
#include "effects/roles.h"
#include "study/enriched.h"
#include "study/measure.h"
#include "study/tuning.h"

namespace mortise::study {
namespace {

bool has(const model::ModelInput& input, effects::Role role) { return !effects::of_role(input.scene.at("effects"), role).empty(); }

}  // namespace

ErrorWatch::ErrorWatch(engine::Engine& leader, const model::ModelInput& input, std::vector<Quantity> quantities, Means means)
    : leader_(leader),
      input_(input),
      quantities_(std::move(quantities)),
      means_(std::move(means)),
      moves_(input.scene.at("time").text("mode") != "static"),
      contact_(has(input, effects::Role::contact)),
      steps_(input.scene.at("time").integer("steps")) {
  remembers_ = moves_ || has(input, effects::Role::follower) ||
               std::any_of(quantities_.begin(), quantities_.end(), [](const Quantity& q) { return q.of_history() || q.when == "start"; });
}

std::unique_ptr<Course> ErrorWatch::course(const model::ModelInput& input) {
  auto out = std::make_unique<Course>(input, fmt::format("{}/estimate_{}.vtkhdf", means_.folder, files_++), *means_.api);
  check(out->engine().begin());
  return out;
}

void ErrorWatch::none(const std::string& name, const std::string& why_not) { sources_.push_back({name, nullptr, nullptr, false, why_not}); }

void ErrorWatch::add(const std::string& name, Line& line, const model::ModelInput& input, solver::Departure by, bool whole) {
  by.fits = true;
  try {
    sources_.push_back({name, &line, course(input), whole, ""});
    line.led.emplace_back(&sources_.back().companion->engine(), by);
  } catch (const Error& e) {
    none(name, e.what());
  }
}

// Goes where the leader goes, and a companion takes away what it has left there.
void ErrorWatch::add_shadow(const std::string& name, const model::ModelInput& input, const std::string& why_not) {
  if (!why_not.empty()) return none(name, why_not);
  if (moves_ && !means_.all_in_motion) return none(name, "in motion it costs more than the run: mortise study --error-budget");
  try {
    auto shadow = course(input);
    check(leader_.cast(shadow->engine()));
    engine::Engine& engine = shadow->engine();
    Recording& recording = shadow->recording();
    lines_.push_back(std::make_unique<Line>(Line{&engine, &recording, std::move(shadow)}));
    add(name, *lines_.back(), input, {.residual = tuning::kHair}, true);
  } catch (const Error& e) {
    none(name, e.what());
  }
}

// The models beside begin where the leader stands.
void ErrorWatch::join() {
  joined_ = true;
  own_ = std::make_unique<Recording>(leader_, input_, means_.folder + "/estimate.vtkhdf");
  lines_.push_back(std::make_unique<Line>(Line{&leader_, own_.get()}));
  Line& own = *lines_.front();
  const double e = tuning::kHair;
  std::string why_not, not_round;

  const model::ModelInput mesh = richer(input_, why_not);
  add_shadow("mesh of soft bodies", mesh, why_not);
  const bool meshed = lines_.size() > 1;
  if (contact_) add("gap that contact leaves", own, thinner(input_, e), {});
  if (moves_) add("time steps", own, input_, {.integrator = e});
  if (contact_) {
    const model::ModelInput facets = finer_facets(input_, why_not);
    if (why_not.empty()) add_shadow("facets of stiff bodies", facets, why_not);
  }
  if (const model::ModelInput round = rounder(input_, e, not_round); not_round.empty())  // of quadratic elements,
    add("facets of soft bodies", own, round, {});
  else if (const model::ModelInput too = rounder(mesh, e, not_round); not_round.empty())  // or beside them
    meshed ? add("facets of soft bodies", *lines_[1], too, {}) : none("facets of soft bodies", sources_.front().why_not);
  if (contact_) {
    const model::ModelInput integrated = better_integrated(input_, why_not);
    add_shadow("integration of contact", integrated, why_not);
  }
  add("Newton's method, linear systems, lag", own, input_, {.residual = e});

  for (const auto& line : lines_) {
    check(line->engine->lead(line->led));
    line->recording->open();
  }
  for (const Source& s : sources_)
    if (s.companion) s.companion->recording().open();
}

void ErrorWatch::before_step() {
  if (joined_ || !why_not_.empty()) return;
  const double start = cpu_time();
  if (remembers_ && leader_.steps_done() > 0) {
    why_not_ = "the run was continued from a checkpoint, and what went beside it before is not known";
  } else if (remembers_ || leader_.steps_done() + 1 == steps_) {
    try {
      join();
    } catch (const Error& e) {
      why_not_ = e.what();
    }
  }
  seconds_ += cpu_time() - start;
}

void ErrorWatch::after_step(const solver::StepReport& report, bool frame) {
  if (!joined_ || !why_not_.empty()) return;
  const double start = cpu_time();
  for (const auto& line : lines_)
    if (!line->lost()) line->recording->see(line->course ? nullptr : &report, frame);
  for (const Source& s : sources_)
    if (s.companion && !s.line->lost() && s.companion->engine().lost().empty()) s.companion->recording().see(nullptr, frame);
  seconds_ += cpu_time() - start;
}

ErrorPart ErrorWatch::part(const Source& s, const Quantity& q, double value) const {
  ErrorPart out{s.name, NAN, s.why_not};
  if (s.companion) out.why_not = s.line->lost() ? s.line->engine->lost() : s.companion->engine().lost();
  if (!out.why_not.empty()) return out;
  const double there = measure(s.line->recording->read(), q);  // at the run's displacements
  out.error = (measure(s.companion->recording().read(), q) - there) / tuning::kHair;
  if (s.whole) {
    // Pressures of single nodes are other numbers on other meshes.
    const double otherwise = there - value;
    out.error += otherwise;
    if (std::abs(otherwise) > std::abs(out.error) && std::abs(otherwise) > tuning::kReadAlike * std::abs(value))
      return {s.name, NAN, fmt::format("not reliable: at the very same displacements it is read as {:+.2g} % there", 100 * otherwise / std::abs(value))};
  }
  if (!std::isfinite(out.error)) out.why_not = "it is not reported there";
  return out;
}

ErrorBudget ErrorWatch::end() {
  const double start = cpu_time();
  ErrorBudget out;
  for (const Quantity& q : quantities_) {
    QuantityBudget& budget = out.of.emplace_back();
    budget.why_not = why_not_;
    if (group_of(q.value) == "steps") budget.why_not = "it counts what the solver does";
    if (!budget.why_not.empty()) continue;
    try {
      budget.value = measure(own_->read(), q);
      for (const Source& s : sources_) budget.parts.push_back(part(s, q, budget.value));
    } catch (const Error& e) {
      budget.why_not = e.what();
    }
  }
  out.seconds = seconds_ + leader_.beside_time().cpu + cpu_time() - start;
  return out;
}

}  // namespace mortise::study
