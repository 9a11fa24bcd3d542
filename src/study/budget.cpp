#include "study/budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "study/compare.h"
#include "study/corrections.h"
#include "study/greedy.h"

namespace mortise::study {
namespace {

constexpr const char* kNotRun = "not run: the budget was spent";

class Budget {
 public:
  Budget(const Study& study, const Place& place, const Told& told) : study_(study), place_(place), told_(told), left_(study.budget) {}

  double left() const { return left_; }

  // The run, or what says that it was not run because it is expected to take more than is left.
  RunResult run(const Planned& p, double expected) {
    for (const auto& [scene, found] : done_)
      if (scene == p.variant.id) {
        RunResult same = found;
        return same.label = p.label, same;
      }
    RunResult out;
    out.label = p.label, out.code = static_cast<int>(Exit::stopped), out.message = kNotRun, out.values.assign(study_.quantities.size(), NAN);
    if (expected > left_ || left_ < 1) return out;
    out = execute(p, place_, study_.repeats, {study_.limit, left_});
    left_ -= out.process;
    measure_all(study_, place_, out);
    done_.emplace_back(p.variant.id, out);
    told_.run(done_.size(), 0, out);
    return out;
  }

 private:
  const Study& study_;
  const Place& place_;
  const Told& told_;
  double left_;
  std::vector<std::pair<std::string, RunResult>> done_;
};

// What the next step of a ladder will take, from the last two: as much more as the last took more; from one as with elements in space.
double expected(const Curve& c, const Ladder& ladder, const std::vector<RunResult>& runs, std::size_t step) {
  if (step == 0) return 0;
  const RunResult& last = runs[c.runs[step - 1]];
  if (last.failed()) return 0;
  const double before = step > 1 ? runs[c.runs[step - 2]].process : 0;
  if (step > 1 && before > 0 && !runs[c.runs[step - 2]].failed()) return last.process * std::max(1.0, last.process / before);
  return ladder.sizes.empty() ? last.process : last.process * ladder.sizes[step - 1] / ladder.sizes[step];
}

std::vector<Knob> knobs_of(const Plan& plan, const Results& r, std::vector<std::size_t>& curves) {
  std::vector<Knob> out;
  const RunResult& base = r.runs[plan.base.front()];
  for (std::size_t at = 0; at < plan.curves.size(); ++at) {
    const Curve& c = plan.curves[at];
    if (c.method != 0 || r.study.ladders[c.ladder].sizes.empty()) continue;
    const auto share =
        std::find_if(r.shares.begin(), r.shares.end(), [&](const Share& s) { return s.quantity == 0 && s.ladder == r.study.ladders[c.ladder].name; });
    Knob k;
    k.base_error = share->error;
    for (std::size_t run : c.runs) {
      k.error.push_back(std::abs(r.runs[run].values[0] - share->limit.value) / r.references[0].scale);
      k.cost.push_back(r.runs[run].process / base.process);
    }
    out.push_back(k), curves.push_back(at);
  }
  return out;
}

}  // namespace

Results run_with_budget(const Study& study, const Place& place, const Told& told) {
  if (!study.one_at_a_time || !study.benchmark.empty()) throw Error(Exit::usage, "--budget is for scenes and for one knob at a time");
  Plan plan = plan_of(study);
  Results out;
  out.study = study;
  out.runs.resize(plan.runs.size());
  Budget budget(study, place, told);
  for (std::size_t b : plan.base) out.runs[b] = budget.run(plan.runs[b], 0);
  std::size_t levels = 0;
  for (const Curve& c : plan.curves) levels = std::max(levels, c.runs.size());
  for (std::size_t level = 0; level < levels; ++level)
    for (const Curve& c : plan.curves)
      if (level < c.runs.size())
        out.runs[c.runs[level]] = budget.run(plan.runs[c.runs[level]], expected(c, study.ladders[c.ladder], out.runs, level));
  if (const std::vector<OnCurve> steps = joint_steps(plan, out); !steps.empty()) {
    const Planned joint = joint_run(study, plan, steps);
    double factor = 1;  // times of knobs multiply
    for (const OnCurve& s : steps) factor *= out.runs[plan.curves[s.curve].runs[s.step]].process / out.runs[plan.base.front()].process;
    if (const RunResult result = budget.run(joint, factor * out.runs[plan.base.front()].process); !result.failed()) {
      plan.refined.push_back({plan.runs.size(), steps});
      plan.runs.push_back(joint), out.runs.push_back(result);
    }
  }
  compare(plan, nullptr, out);

  std::vector<std::size_t> curves;
  const std::vector<Knob> knobs = knobs_of(plan, out, curves);
  std::vector<std::size_t> at(knobs.size(), kBase);
  const double base = out.runs[plan.base.front()].process;
  double scale = 1;  // of what runs took over what was predicted
  for (;;) {
    const auto move = best_move(knobs, at, budget.left() / (base * scale));
    if (!move) break;
    at[move->knob] = move->step;
    std::vector<OnCurve> steps;
    for (std::size_t k = 0; k < knobs.size(); ++k)
      if (at[k] != kBase) steps.push_back({curves[k], at[k]});
    const Planned next = joint_run(study, plan, steps);
    const RunResult result = budget.run(next, 0);
    if (result.failed() && result.message == kNotRun) break;
    if (!result.failed() && result.process > 0) scale = result.process / (base * move->cost);
    plan.refined.push_back({plan.runs.size(), steps});
    plan.runs.push_back(next), out.runs.push_back(result);
    if (result.failed()) break;
  }
  compare(plan, nullptr, out);
  out.notes.push_back(
      fmt::format("budget {:g} s of CPU time, {:.3g} s left; setup and output of the runs are counted", study.budget, std::max(0.0, budget.left())));
  describe_machine(place, out);
  return out;
}

}  // namespace mortise::study
