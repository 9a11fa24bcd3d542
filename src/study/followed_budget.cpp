#include "study/followed_budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>

#include "effects/roles.h"
#include "study/blind.h"
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

std::vector<Mended> faults_of(const Params& scene, bool soft) {
  std::vector<Mended> out;
  if (soft) out.push_back({effects::Fault::mesh, kMeshPart, {}, {}});
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

// Steps in which bodies touch others for the first time or let all go: whose contact forces are none before or after.
class Touches {
 public:
  explicit Touches(const Params& scene) : contact_(effects::of_role(scene.at("effects"), effects::Role::contact)) {}
  void see(const Snapshot& state) {
    std::set<std::string> now;
    const double moves = state.has("inertia/kinetic_energy") ? state.at("inertia/kinetic_energy") : 0;
    if (state.has("elasticity/energy")) held_ = std::max(held_, state.at("elasticity/energy"));
    for (const std::string& effect : contact_)
      for (const auto& [name, value] : state.number)
        if (value != 0 && name.starts_with(effect + "/force_")) now.insert(name.substr(0, name.rfind('_')));
    if (steps_ > 0 && now != touching_) ++changes_, struck_ = std::max(struck_, moved_);
    touching_ = std::move(now), moved_ = moves, ++steps_;
  }
  // Energies of motion that bodies meet with, or part with, are no small share of what they hold when they are deformed.
  bool strike() const { return struck_ > tuning::kStruckShare * held_; }
  std::string note() const {
    if (changes_ == 0) return "";
    return fmt::format(
        "bodies touch or let go in {} of {} steps: when within a step they do is not told, nor what comes of it (largest forces of impacts were "
        "2.3 times as wrong, bounces had the wrong sign)",
        changes_, steps_);
  }

 private:
  std::vector<std::string> contact_;
  std::set<std::string> touching_;
  long steps_ = 0, changes_ = 0;
  double held_ = 0, moved_ = 0, struck_ = 0;  // largest elastic energy; of motion in the last state, and the largest before a change [J]
};

// The mesh's part of a number, with what makes it unreliable besides. before: the largest part up to then, over the largest value.
ErrorPart mesh_part(ErrorPart part, const Quantity& q, bool strikes, double before) {
  const bool sampled = q.value == "contact_pressure" && q.over != "integral" && q.over != "mean";
  std::string why;
  if (before > tuning::kCoarseShare)
    why = fmt::format("before that time {:.2g} % of the largest value was found, and where that goes through zero it tells nothing", 100 * before);
  if (strikes) why = "bodies strike, and what masses on a surface make of that is not followed";
  if (sampled) why = "how far the surface's own elements resolve a pressure is not followed";
  return why.empty() || !std::isfinite(part.error) ? part : ErrorPart{part.source, NAN, std::string(kNotReliable) + ": " + why};
}

// Why a number is not followed; empty where it is.
std::string why_not(const Quantity& q, double value) {
  if (group_of(q.value) == "steps") return "numbers of the steps themselves are not followed";
  return std::isfinite(value) ? "" : "it has no value: nothing reports it then";
}

}  // namespace

ErrorBudget followed_budget(const scene::Scene& scene, const std::vector<Quantity>& quantities, const Place& place) {
  const engine::Choice choice = engine::choose(place.device, place.threads);
  const std::string folder = place.folder + "/runs/error_budget";
  Course base(scene, folder + ".vtkhdf", choice);
  check(base.engine().begin());
  Blind blind(base.input());
  std::vector<Mended> faults = faults_of(scene.root, blind.soft());
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
  Touches touches(scene.root);
  out.solve_seconds = take(base, beside, [&](const Snapshot& state) {
    touches.see(state);
    if (blind.soft()) blind.see(state.cell.at("cauchy_stress"));
  });
  const auto with = [&](effects::Fault fault) {
    return std::any_of(faults.begin(), faults.end(), [&](const Mended& m) { return m.fault == fault; });
  };
  const bool motion = with(effects::Fault::steps), contact = with(effects::Fault::gap);
  if (motion) out.note = touches.note();

  const std::vector<double> values = base.measure(quantities);
  const std::vector<double> missed = base.missed_between(quantities);
  for (std::size_t k = 0; k < values.size(); ++k) {
    QuantityBudget& budget = out.of.emplace_back();
    budget.why_not = why_not(quantities[k], values[k]);
    budget.value = values[k];
    if (!blind.soft()) budget.parts.push_back(blind.part(NAN));
    if (!motion && scene.root.at("time").integer("steps") > 1) budget.parts.push_back({kLoadStepsPart, NAN, "ladders tell (--vary time.steps=...)"});
    if (const std::string between = what_lies_between(missed[k] / values[k]); !between.empty()) budget.parts.push_back({kBetweenPart, NAN, between});
  }
  for (Mended& m : faults) {
    const std::string lost = m.less->engine().lost().empty() ? m.more->engine().lost() : m.less->engine().lost();
    const std::vector<double> less = lost.empty() ? m.less->measure(quantities) : values, more = lost.empty() ? m.more->measure(quantities) : values;
    std::vector<double> apart;
    if (lost.empty() && m.fault == effects::Fault::mesh) apart = m.less->largest_apart(*m.more, quantities);
    for (std::size_t k = 0; k < values.size(); ++k) {
      ErrorPart part = lost.empty() ? part_of(m.source, less[k], values[k], more[k]) : ErrorPart{m.source, NAN, lost};
      if (m.fault == effects::Fault::mesh && std::isfinite(part.error))
        part = mesh_part(blind.part(part.error), quantities[k], motion && touches.strike(), apart[k] / (2 * tuning::kMendedShare));
      out.of[k].parts.push_back(part);
    }
  }
  for (QuantityBudget& budget : out.of) {
    std::stable_partition(budget.parts.begin(), budget.parts.end(), [](const ErrorPart& p) { return p.source == kMeshPart; });
    if (contact) budget.parts.push_back({kFacetsPart, NAN, "no estimate"});
    budget.judge(budget.value);
  }
  return out;
}

}  // namespace mortise::study
