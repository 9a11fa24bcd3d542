#include "study/corrections.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "study/tuning.h"

namespace mortise::study {
namespace {

bool refines(const Results& r, const Curve& c) { return !r.study.ladders[c.ladder].sizes.empty(); }

double value_of(const Plan& plan, const Results& r, const OnCurve& at, std::size_t k) {
  return r.runs[plan.curves[at.curve].runs[at.step]].values[k];
}

// Sum of the products of all pairs.
double products(const std::vector<double>& changes) {
  double sum = 0, out = 0;
  for (double c : changes) out += sum * std::abs(c), sum += std::abs(c);
  return out;
}

}  // namespace

bool same_run(const RunResult& a, const RunResult& b) { return a.dofs == b.dofs && a.newton == b.newton && a.values == b.values; }

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

std::vector<Correction> corrections(const Plan& plan, const Results& r, std::size_t k, std::size_t method, const std::vector<OnCurve>& steps) {
  std::vector<Correction> out;
  for (std::size_t c = 0; c < plan.curves.size(); ++c) {
    const Curve& curve = plan.curves[c];
    if (curve.method != method || !refines(r, curve)) continue;
    double value = r.runs[plan.base[method]].values[k];
    for (const OnCurve& at : steps)
      if (at.curve == c) value = value_of(plan, r, at, k);
    const double by = limit_along(curve, r, k).value - value;
    if (std::isfinite(by)) out.push_back({r.study.ladders[curve.ladder].name, by});
  }
  return out;
}

std::vector<Correction> corrections(const Plan& plan, const Results& r, std::size_t k, const OnCurve& at, double reference) {
  const Curve& curve = plan.curves[at.curve];
  if (!refines(r, curve)) return {};
  const double limit = limit_along(curve, r, k).value;
  std::string others;
  for (std::size_t l = 1; l < r.study.ladders.size(); ++l) others += (others.empty() ? "" : ", ") + r.study.ladders[l].name;
  if (r.study.methods.size() > 1) others = others.empty() ? "method" : "method, " + others;
  return {{r.study.ladders[curve.ladder].name, limit - value_of(plan, r, at, k)}, {others, reference - limit}};
}

double root_of_squares(const std::vector<Correction>& all) {
  double sum = 0;
  for (const Correction& c : all) sum += c.by * c.by;
  return std::sqrt(sum);
}

std::string cancelling(const std::vector<Correction>& all, double scale) {
  double sum = 0;
  for (const Correction& c : all) sum += c.by;
  const double root = root_of_squares(all);
  if (!(std::abs(sum) < tuning::kCancels * root)) return "";
  std::string out;
  for (const Correction& c : all)
    if (std::abs(c.by) > tuning::kCancelsWorthNaming * root)
      out += fmt::format("{}{} {:+.3g} %", out.empty() ? "" : " and ", c.knob, -100 * c.by / scale);
  return out;
}

std::vector<OnCurve> joint_steps(const Plan& plan, const Results& r) {
  std::vector<OnCurve> out;
  for (std::size_t c = 0; c < plan.curves.size() && !plan.base.empty(); ++c) {
    const Curve& curve = plan.curves[c];
    const double base = r.runs[plan.base.front()].values[0], limit = limit_along(curve, r, 0).value;
    if (curve.method != 0 || !refines(r, curve)) continue;
    for (std::size_t i = 0; i < curve.runs.size(); ++i) {
      if (!(std::abs(value_of(plan, r, {c, i}, 0) - limit) < std::abs(base - limit))) continue;
      out.push_back({c, i});
      break;
    }
  }
  return out.size() > 1 ? out : std::vector<OnCurve>{};
}

Planned joint_run(const Study& study, const Plan& plan, const std::vector<OnCurve>& steps) {
  Planned out;
  out.label = study.methods.front().name;
  for (const OnCurve& at : steps) {
    const Ladder& ladder = study.ladders[plan.curves[at.curve].ladder];
    const Ladder::Step& step = ladder.steps[at.step];
    out.settings.insert(out.settings.end(), step.settings.begin(), step.settings.end());
    out.label += (out.label.empty() ? "" : ", ") + step_label(ladder, step);
  }
  out.variant = variant_of(study, study.methods.front(), out.settings);
  return out;
}

double interaction(const Plan& plan, const Results& r, std::size_t k) {
  const double base = r.runs[plan.base.front()].values[k];
  std::vector<double> at_limits;
  for (const Correction& c : corrections(plan, r, k, 0, {})) at_limits.push_back(c.by);
  const double guess = base != 0 ? products(at_limits) / std::abs(base) : 0;
  if (plan.refined.empty() || plan.refined.front().steps.size() < 2) return guess;
  const Together& joint = plan.refined.front();
  double sum = base;
  std::vector<double> changes;
  for (const OnCurve& at : joint.steps) changes.push_back(value_of(plan, r, at, k) - base), sum += changes.back();
  const double found = std::abs(r.runs[joint.run].values[k] - sum), here = products(changes);
  if (!std::isfinite(found) || !(here > 0)) return guess;
  return std::max(tuning::kSafety * found * std::max(1.0, products(at_limits) / here), tuning::kLeastShare * guess);
}

}  // namespace mortise::study
