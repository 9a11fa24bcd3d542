#include "study/error_watch.h"

#include <algorithm>
#include <cmath>

#include "base/cpu_time.h"
#include "effects/roles.h"
#include "output/field_reader.h"
#include "study/enriched.h"
#include "study/measure.h"
#include "study/tuning.h"

namespace mortise::study {
namespace {

constexpr const char *kOfMesh = "mesh of soft bodies", *kOfGap = "gap that contact leaves", *kOfTime = "time steps",
                     *kOfNewton = "Newton's method, linear systems, lag", *kOfFacets = "facets of round surfaces, integration";

bool has(const model::ModelInput& input, effects::Role role) { return !effects::of_role(input.scene.at("effects"), role).empty(); }

double difference(Recording& a, double of_b, const Quantity& q) { return measure(a.read(), q) - of_b; }

}  // namespace

ErrorWatch::ErrorWatch(engine::Engine& leader, const model::ModelInput& input, std::vector<Quantity> quantities, Means means)
    : leader_(leader),
      input_(input),
      quantities_(std::move(quantities)),
      means_(std::move(means)),
      moves_(input.scene.at("time").text("mode") != "static"),
      contact_(has(input, effects::Role::contact)),
      steps_(input.scene.at("time").integer("steps")) {
  remembers_ = moves_ || has(input, effects::Role::follower) || std::any_of(quantities_.begin(), quantities_.end(), [](const Quantity& q) { return q.of_history(); });
}

ErrorWatch::Source ErrorWatch::source(const std::string& name, const model::ModelInput& input, Recording& beside_of) const {
  Source out{name, &beside_of, nullptr, ""};
  try {
    out.companion = std::make_unique<Course>(input, means_.folder + "/estimate_" + std::to_string(sources_.size()) + ".vtkhdf", *means_.api);
    check(out.companion->engine().begin());
  } catch (const Error& e) {
    out.companion.reset(), out.why_not = e.what();
  }
  return out;
}

// The models beside begin where the leader stands.
void ErrorWatch::join() {
  joined_ = true;
  own_ = std::make_unique<Recording>(leader_, input_, means_.folder + "/estimate.vtkhdf");
  std::vector<engine::Engine::Beside> led, of_shadow;
  const double e = tuning::kHair;
  const auto add = [&](const char* name, const model::ModelInput& input, Recording& of, solver::Departure by, std::vector<engine::Engine::Beside>& to) {
    sources_.push_back(source(name, input, of));
    by.fits = true;
    if (sources_.back().companion) to.emplace_back(&sources_.back().companion->engine(), by);
  };
  const auto none = [&](const char* name, const std::string& why_not) { sources_.push_back({name, nullptr, nullptr, why_not}); };

  const model::ModelInput richer = enriched(input_, no_shadow_);
  if (no_shadow_.empty() && moves_ && !means_.mesh_in_motion)
    no_shadow_ = "in motion it costs more than the run: mortise study --error-budget";
  if (no_shadow_.empty()) try {
      shadow_ = std::make_unique<Course>(richer, means_.folder + "/estimate_richer.vtkhdf", *means_.api);
      check(shadow_->engine().begin());
      check(leader_.cast(shadow_->engine()));
    } catch (const Error& error) {
      shadow_.reset(), no_shadow_ = error.what();
    }
  if (shadow_)
    add(kOfMesh, richer, shadow_->recording(), {.residual = e}, of_shadow);
  else
    none(kOfMesh, no_shadow_);
  if (contact_) add(kOfGap, thinner(input_, e), *own_, {}, led);
  if (moves_) add(kOfTime, input_, *own_, {.integrator = e}, led);
  add(kOfNewton, input_, *own_, {.residual = e}, led);
  if (contact_) none(kOfFacets, "no estimate");
  check(leader_.lead(led));
  if (shadow_) check(shadow_->engine().lead(of_shadow));

  own_->open();
  if (shadow_) shadow_->recording().open();
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
  own_->see(&report, frame);
  const auto see = [&](Course& c) {
    if (c.engine().lost().empty()) c.recording().see(nullptr, frame);
  };
  if (shadow_ && shadow_->engine().lost().empty()) see(*shadow_);
  for (const Source& s : sources_)
    if (s.companion) see(*s.companion);
  seconds_ += cpu_time() - start;
}

ErrorPart ErrorWatch::part(Source& s, const Quantity& q, double value) {
  ErrorPart out{s.name, NAN, s.why_not};
  const bool of_shadow = s.name == kOfMesh;
  if (s.companion) out.why_not = of_shadow && !shadow_->engine().lost().empty() ? shadow_->engine().lost() : s.companion->engine().lost();
  if (!out.why_not.empty()) return out;
  const double there = of_shadow ? measure(s.beside_of->read(), q) : value;
  out.error = difference(s.companion->recording(), there, q) / tuning::kHair + (there - value);
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
      for (Source& s : sources_) budget.parts.push_back(part(s, q, budget.value));
    } catch (const Error& e) {
      budget.why_not = e.what();
    }
  }
  out.seconds = seconds_ + leader_.beside_time().cpu + cpu_time() - start;
  return out;
}

}  // namespace mortise::study
