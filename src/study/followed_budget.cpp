#include "study/followed_budget.h"

#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "effects/roles.h"
#include "study/course.h"
#include "study/tuning.h"

namespace mortise::study {
namespace {

// Two scenes that mend a fault by a share: of less than none, and of more.
struct Mended {
  effects::Fault fault;
  const char* source;
  std::unique_ptr<Course> less, more;
};

std::vector<Mended> faults_of(const Params& scene) {
  std::vector<Mended> out;
  if (scene.at("time").text("mode") != "static") out.push_back({effects::Fault::steps, kStepsPart, {}, {}});
  if (!effects::of_role(scene.at("effects"), effects::Role::contact).empty()) out.push_back({effects::Fault::gap, kGapPart, {}, {}});
  out.push_back({effects::Fault::solution, kSolutionPart, {}, {}});
  return out;
}

// less, value, more: of the quantity.
ErrorPart part_of(const char* source, double less, double value, double more) {
  const double below = (value - less) / tuning::kMendedShare, above = (more - value) / tuning::kMendedShare;
  const double error = (below + above) / 2, apart = std::abs(above - below) / 2;
  if (!std::isfinite(error)) return {source, NAN, "the quantity has no value"};
  if (apart > tuning::kMendedKink * std::abs(error) && apart > tuning::kNoDerivative * std::abs(value))
    return {source, NAN,
            fmt::format("{}: {:+.2g} or {:+.2g}, as something touches, lets go or slips a step sooner or later", kNotReliable, below, above)};
  if (std::abs(error) > tuning::kFirstOrderShare * std::abs(value))
    return {source, NAN,
            fmt::format("{}: {:.0f} % of the number was found, and above {:g} % it is no matter of first order", kNotReliable,
                        100 * std::abs(error / value), 100 * tuning::kFirstOrderShare)};
  return {source, error, ""};
}

}  // namespace

ErrorBudget followed_budget(const scene::Scene& scene, const std::vector<Quantity>& quantities, const std::string& why_no_mesh, const Place& place) {
  const engine::Choice choice = engine::choose(place.device, place.threads);
  const std::string folder = place.folder + "/runs/error_budget";
  Course base(scene, folder + ".vtkhdf", choice);
  check(base.engine().begin());
  std::vector<Mended> faults = faults_of(scene.root);
  std::vector<Course*> beside;
  for (Mended& m : faults)
    for (double sign : {-1.0, 1.0}) {
      auto course = std::make_unique<Course>(base, fmt::format("{}_{}.vtkhdf", folder, beside.size()), choice);
      check(course->engine().mend(m.fault, sign * tuning::kMendedShare));
      check(course->engine().begin());
      beside.push_back(course.get());
      (sign < 0 ? m.less : m.more) = std::move(course);
    }
  ErrorBudget out;
  out.solve_seconds = take(base, beside);

  const std::vector<double> values = base.measure(quantities);
  for (double value : values) {
    QuantityBudget& budget = out.of.emplace_back();
    budget.value = value;
    budget.parts.push_back({kMeshPart, NAN, why_no_mesh});
  }
  for (Mended& m : faults) {
    const std::string lost = m.less->engine().lost().empty() ? m.more->engine().lost() : m.less->engine().lost();
    const std::vector<double> less = lost.empty() ? m.less->measure(quantities) : values, more = lost.empty() ? m.more->measure(quantities) : values;
    for (std::size_t k = 0; k < values.size(); ++k)
      out.of[k].parts.push_back(lost.empty() ? part_of(m.source, less[k], values[k], more[k]) : ErrorPart{m.source, NAN, lost});
  }
  const bool contact = faults.size() > 1 && faults[faults.size() - 2].fault == effects::Fault::gap;
  for (QuantityBudget& budget : out.of) {
    if (contact) budget.parts.push_back({kFacetsPart, NAN, "no estimate"});
    budget.judge(budget.value);
  }
  return out;
}

}  // namespace mortise::study
