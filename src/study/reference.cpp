// What the values of a study are compared with.
#include <fmt/format.h>

#include <algorithm>

#include "study/compare.h"
#include "study/tuning.h"

namespace mortise::study {
namespace {

// Whether two steps made the same: a mesh has whole numbers of cells, and edge lengths that differ a little may make equal ones.
bool same_run(const RunResult& a, const RunResult& b) { return a.dofs == b.dofs && a.newton == b.newton && a.values == b.values; }

// Of the runs along a curve that did not fail; of equal ones the one that was meant to be finer.
Limit limit_along(const Curve& curve, const Results& r, std::size_t quantity) {
  std::vector<double> sizes, values;
  const Ladder& ladder = r.study.ladders[curve.ladder];
  for (std::size_t i = 0; i < curve.runs.size(); ++i) {
    const RunResult& run = r.runs[curve.runs[i]];
    if (!std::isfinite(run.values[quantity]) || (i + 1 < curve.runs.size() && same_run(run, r.runs[curve.runs[i + 1]]))) continue;
    values.push_back(run.values[quantity]);
    if (!ladder.sizes.empty()) sizes.push_back(ladder.sizes[i]);
  }
  return limit_of(sizes, values);
}

void note_equal_runs(const Plan& plan, Results& r) {
  for (const Curve& c : plan.curves)
    for (std::size_t i = 0; i + 1 < c.runs.size(); ++i)
      if (!r.runs[c.runs[i]].failed() && r.runs[c.runs[i]].dofs > 0 && same_run(r.runs[c.runs[i]], r.runs[c.runs[i + 1]]))
        r.notes.push_back(fmt::format("'{}' and '{}' gave the same to the last digit: they count as one step of the ladder",
                                      plan.runs[c.runs[i]].label, plan.runs[c.runs[i + 1]].label));
}

Reference given(const Quantity& q) { return {*q.reference, q.uncertainty, 1, true, "given"}; }

// Errors of knobs add up, to first order: q = q_base + sum over ladders of d, d = limit of the ladder - q_base. Of second order are products of their
// shares, d1 d2 / q_base: as large may the error of the sum be.
Reference added_up(const Plan& plan, const Results& r, std::size_t k, bool& extrapolated) {
  const double base = r.runs[plan.base.front()].values[k];
  Reference out{base, 0, 1, true, ""};
  std::string how;
  double changes = 0, products = 0;
  for (const Curve& c : plan.curves) {
    const Ladder& ladder = r.study.ladders[c.ladder];
    if (c.method != 0 || ladder.sizes.empty()) continue;
    const Limit limit = limit_along(c, r, k);
    extrapolated = extrapolated && limit.extrapolated;
    const double change = std::abs(limit.value - base);
    products += changes * change, changes += change;
    out.value += limit.value - base, out.uncertainty += limit.uncertainty;
    how += (how.empty() ? "" : "; ") + ladder.name + ": " + limit.how;
  }
  if (base != 0) out.uncertainty += products / std::abs(base);
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

Point point(const Curve& c, const Planned& planned, const RunResult& run, std::size_t step, std::size_t k, const Results& r) {
  Point p;
  p.curve = c.name, p.label = planned.label, p.run = run.id, p.settings = planned.settings, p.quantity = k, p.method = c.method, p.step = step;
  p.seconds = run.seconds, p.slowest = run.slowest, p.newton = run.newton, p.dofs = run.dofs;
  p.value = run.values[k], p.failed = run.failed() || !std::isfinite(p.value);
  p.why = run.failed() ? run.message : (p.failed ? "the run does not report it" : "");
  p.refines = step == SIZE_MAX || !r.study.ladders[c.ladder].sizes.empty();
  const Reference& ref = r.references[k];
  if (p.failed) return p;
  p.error = std::abs(p.value - ref.value) / ref.scale;
  p.hollow = std::isfinite(ref.uncertainty) && p.error < ref.uncertainty / ref.scale;
  return p;
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
    for (std::size_t m = 0; m < plan.base.size(); ++m) {
      Curve c{plan.runs[plan.base[m]].label, m, 0, {}};
      r.points.push_back(point(c, plan.runs[plan.base[m]], r.runs[plan.base[m]], SIZE_MAX, k, r));
    }
    for (const Curve& c : plan.curves)
      for (std::size_t i = 0; i < c.runs.size(); ++i) r.points.push_back(point(c, plan.runs[c.runs[i]], r.runs[c.runs[i]], i, k, r));
    for (std::size_t i = 0; i < plan.refined.size(); ++i) {
      r.points.push_back(point({"knobs together", 0, 0, {}}, plan.runs[plan.refined[i]], r.runs[plan.refined[i]], i, k, r));
      r.points.back().refines = true;
    }
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
