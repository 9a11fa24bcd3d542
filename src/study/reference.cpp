// What the values of a study are compared with.
#include <fmt/format.h>

#include <algorithm>

#include "study/compare.h"
#include "study/corrections.h"
#include "study/tuning.h"

namespace mortise::study {
namespace {

void note_equal_runs(const Plan& plan, Results& r) {
  for (const Curve& c : plan.curves)
    for (std::size_t i = 0; i + 1 < c.runs.size(); ++i)
      if (!r.runs[c.runs[i]].failed() && r.runs[c.runs[i]].dofs > 0 && same_run(r.runs[c.runs[i]], r.runs[c.runs[i + 1]]))
        r.notes.push_back(fmt::format("'{}' and '{}' gave the same to the last digit: they count as one step of the ladder",
                                      plan.runs[c.runs[i]].label, plan.runs[c.runs[i + 1]].label));
}

Reference given(const Quantity& q) { return {*q.reference, q.uncertainty, 1, true, "given"}; }

// Errors of knobs add up, to first order: q = q_base + sum over ladders of (limit of the ladder - q_base). Their interaction is of second order.
Reference added_up(const Plan& plan, const Results& r, std::size_t k, bool& extrapolated) {
  const double base = r.runs[plan.base.front()].values[k];
  Reference out{base, 0, 1, true, ""};
  std::string how;
  for (const Curve& c : plan.curves) {
    const Ladder& ladder = r.study.ladders[c.ladder];
    if (c.method != 0 || ladder.sizes.empty()) continue;
    const Limit limit = limit_along(c, r, k);
    extrapolated = extrapolated && limit.extrapolated;
    out.value += limit.value - base, out.uncertainty += limit.uncertainty;
    how += (how.empty() ? "" : "; ") + ladder.name + ": " + limit.how;
  }
  if (!how.empty()) out.uncertainty += interaction(plan, r, k);
  out.how = r.study.ladders.size() > 1 ? "limits of the ladders, added up (" + how + ")" : how;
  if (how.empty()) extrapolated = false, out.uncertainty = NAN, out.how = "the scene as it is: no ladder is one of refinement";
  return out;
}

// Of combinations the limit of the finest curve: the first method, the first of alternatives, the last steps of all ladders of refinement. Of two
// such ladders the limit along the second of the limits along the first.
Reference of_combinations(const Plan& plan, const Results& r, std::size_t k, bool& extrapolated) {
  const std::vector<Ladder>& ladders = r.study.ladders;
  std::size_t finest = 0, stride = 1, refining = 0;
  for (std::size_t l = ladders.size(); l-- > 1; stride *= ladders[l].steps.size())
    if (!ladders[l].sizes.empty()) finest += stride * (ladders[l].steps.size() - 1), ++refining;
  const auto has_value = [&](const Curve& c) {
    return std::any_of(c.runs.begin(), c.runs.end(), [&](std::size_t run) { return std::isfinite(r.runs[run].values[k]); });
  };
  if (!has_value(plan.curves[finest])) {
    const auto any = std::find_if(plan.curves.begin(), plan.curves.end(), has_value);
    finest = any == plan.curves.end() ? 0 : static_cast<std::size_t>(any - plan.curves.begin()), refining = 0;
  }
  const Curve& curve = plan.curves[finest];
  const Limit along = limit_along(curve, r, k);
  extrapolated = along.extrapolated;
  const std::string of = plan.curves.size() > 1 ? ", of the curve '" + curve.name + "'" : "";
  if (ladders.size() != 2 || refining != 1) return {along.value, along.uncertainty, 1, true, along.how + of};
  std::vector<double> sizes, values;
  for (std::size_t i = 0; i < ladders[1].steps.size(); ++i)
    if (has_value(plan.curves[i])) sizes.push_back(ladders[1].sizes[i]), values.push_back(limit_along(plan.curves[i], r, k).value);
  const Limit across = limit_of(sizes, values);
  extrapolated = extrapolated && across.extrapolated;
  const std::string how = fmt::format("{}: {}; then {}: {}", ladders[0].name, along.how, ladders[1].name, across.how);
  return {across.value, along.uncertainty + across.uncertainty, 1, true, how};
}

Reference of_ladders(const Plan& plan, const Results& r, std::size_t k, bool& extrapolated) {
  extrapolated = true;
  return plan.base.empty() ? of_combinations(plan, r, k, extrapolated) : added_up(plan, r, k, extrapolated);
}

// Of the runs of the first method the finest, or what the finest of all ladders would be together.
double finest(const Plan& plan, const Results& r, std::size_t k) {
  double out = plan.base.empty() ? NAN : r.runs[plan.base.front()].values[k];
  for (const Curve& c : plan.curves) {
    const double v = r.runs[c.runs.back()].values[k];
    if (c.method != 0 || !std::isfinite(v) || r.study.ladders[c.ladder].sizes.empty()) continue;
    out = plan.base.empty() ? v : out + v - r.runs[plan.base.front()].values[k];
  }
  return out;
}

// How far the finest of the others is from a run that is n times finer, over n - 1: what is left of an error of first order.
Reference of_over_resolved(const Plan& plan, const Results& r, const RunResult& over, std::size_t k) {
  const double u = std::abs(over.values[k] - finest(plan, r, k)) / (tuning::kOverResolved - 1);
  return {over.values[k], u, 1, true, "an over-resolved run (" + over.label + ")"};
}

void scale(Reference& ref, const Quantity& q) {
  ref.scale = std::max(std::abs(ref.value), q.scale);
  ref.relative = ref.scale > 0;
  if (!ref.relative) ref.scale = 1;
}

void add_shares(const Plan& plan, Results& r) {
  for (const Curve& c : plan.curves) {
    if (plan.base.empty() || r.study.ladders[c.ladder].sizes.empty()) continue;
    for (std::size_t k = 0; k < r.references.size(); ++k) {
      const Limit limit = limit_along(c, r, k);
      const double base = r.runs[plan.base[c.method]].values[k];
      r.shares.push_back(
          {r.study.methods[c.method].name, r.study.ladders[c.ladder].name, k, std::abs(base - limit.value) / r.references[k].scale, limit});
    }
  }
}

// `left`: what the knobs of the run still move, each by itself. Errors that cancel do not make a run better than these.
Point point(const Curve& c, const Planned& planned, const RunResult& run, std::size_t step, std::size_t k, const Results& r,
            const std::vector<Correction>& left) {
  Point p;
  p.curve = c.name, p.label = planned.label, p.run = run.id, p.settings = planned.settings, p.quantity = k, p.method = c.method, p.step = step;
  p.seconds = run.seconds, p.slowest = run.slowest, p.newton = run.newton, p.dofs = run.dofs;
  p.value = run.values[k], p.failed = run.failed() || !std::isfinite(p.value);
  p.why = run.failed() ? run.message : (p.failed ? "the run does not report it" : "");
  p.refines = step == SIZE_MAX || !r.study.ladders[c.ladder].sizes.empty();
  const Reference& ref = r.references[k];
  if (p.failed) return p;
  p.error = std::max(std::abs(p.value - ref.value), root_of_squares(left)) / ref.scale;
  p.cancel = cancelling(left, ref.value < 0 ? -ref.scale : ref.scale);
  p.hollow = std::isfinite(ref.uncertainty) && p.error < ref.uncertainty / ref.scale;
  return p;
}

void add_points(const Plan& plan, Results& r, std::size_t k) {
  // A value that was given is the truth: then errors are what they are.
  const bool given = r.study.quantities[k].reference.has_value();
  const auto put = [&](const Curve& c, std::size_t run, std::size_t step, const std::vector<Correction>& left) {
    r.points.push_back(point(c, plan.runs[run], r.runs[run], step, k, r, given ? std::vector<Correction>{} : left));
  };
  for (std::size_t m = 0; m < plan.base.size(); ++m)
    put({plan.runs[plan.base[m]].label, m, 0, {}}, plan.base[m], SIZE_MAX, corrections(plan, r, k, m, {}));
  for (std::size_t at = 0; at < plan.curves.size(); ++at) {
    const Curve& c = plan.curves[at];
    const bool refines = !r.study.ladders[c.ladder].sizes.empty();
    for (std::size_t i = 0; i < c.runs.size(); ++i)
      put(c, c.runs[i], i,
          plan.base.empty() ? corrections(plan, r, k, {at, i}, r.references[k].value)
                            : (refines ? corrections(plan, r, k, c.method, {{at, i}}) : std::vector<Correction>{}));
  }
  for (std::size_t i = 0; i < plan.refined.size(); ++i) {
    put({"knobs together", 0, 0, {}}, plan.refined[i].run, i, corrections(plan, r, k, 0, plan.refined[i].steps));
    r.points.back().refines = true;
  }
}

}  // namespace

bool needs_over_resolved(const Plan& plan, const Results& r) {
  for (std::size_t k = 0; k < r.study.quantities.size(); ++k) {
    bool extrapolated = false;
    if (!r.study.quantities[k].reference && (of_ladders(plan, r, k, extrapolated), !extrapolated)) return true;
  }
  return false;
}

void compare(const Plan& plan, const RunResult* over, Results& r) {
  r.references.clear(), r.points.clear(), r.shares.clear(), r.notes.clear();
  for (std::size_t k = 0; k < r.study.quantities.size(); ++k) {
    bool extrapolated = true;
    Reference ref = r.study.quantities[k].reference ? given(r.study.quantities[k]) : of_ladders(plan, r, k, extrapolated);
    if (!r.study.quantities[k].reference && !extrapolated && over && !over->failed()) ref = of_over_resolved(plan, r, *over, k);
    if (!std::isfinite(ref.value))
      throw Error(Exit::solve, fmt::format("quantity '{}' has nothing to be compared with: {}; give it a reference", r.study.quantities[k].name,
                                           plan.base.empty() ? "no run of the first curve has a value" : "the scene as it is has no value"));
    scale(ref, r.study.quantities[k]);
    r.references.push_back(ref);
    add_points(plan, r, k);
    // A run that all others are compared with has no error of its own.
    if (ref.how.starts_with("the finest run"))  // of one ladder
      for (Point& p : r.points)
        if (p.quantity == k && p.value == ref.value) p.reference = true;
  }
  note_equal_runs(plan, r);
  add_shares(plan, r);
  mark_best(r.points, r.references);
}

}  // namespace mortise::study
