#include "study/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "study/limit.h"
#include "study/tuning.h"

namespace mortise::study {
namespace {

std::string joined(const std::string& a, const std::string& b) { return a.empty() || b.empty() ? a + b : a + ", " + b; }

// Of the error of a scene the first line is told behind the place in the study.
void make_scene(const Study& study, Planned& run, const SourceLoc& at) {
  if (!study.benchmark.empty()) return;
  try {
    run.variant = variant_of(study, study.methods[run.method], run.settings);
  } catch (const Error& e) {
    if (at.line == 0 || run.label.empty() || std::string(e.what()).starts_with(at.file)) throw;
    throw Error(e.code(), at, run.label + " makes no scene:\n  " + e.what());
  }
}

std::size_t add(const Study& study, Plan& plan, std::size_t method, const Settings& settings, const std::string& label, const SourceLoc& at) {
  Planned run{method, settings, joined(study.methods[method].name, label), {}};
  make_scene(study, run, at);
  plan.runs.push_back(std::move(run));
  return plan.runs.size() - 1;
}

void one_at_a_time(const Study& study, Plan& plan) {
  for (std::size_t m = 0; m < study.methods.size(); ++m) {
    const std::string& method = study.methods[m].name;
    plan.base.push_back(add(study, plan, m, {}, "as it is", study.methods[m].at));
    for (std::size_t l = 0; l < study.ladders.size(); ++l) {
      const Ladder& ladder = study.ladders[l];
      Curve curve{joined(method, study.ladders.size() > 1 || method.empty() ? ladder.name : ""), m, l, {}};
      for (const Ladder::Step& s : ladder.steps) curve.runs.push_back(add(study, plan, m, s.settings, step_label(ladder, s), ladder.at));
      plan.curves.push_back(std::move(curve));
    }
  }
}

// Curve by curve, along the first ladder; the last ladder's steps change fastest from curve to curve.
void combinations(const Study& study, Plan& plan) {
  std::vector<Ladder::Step> rests{{}};
  for (std::size_t l = 1; l < study.ladders.size(); ++l) {
    std::vector<Ladder::Step> next;
    for (const Ladder::Step& rest : rests)
      for (const Ladder::Step& s : study.ladders[l].steps) {
        next.push_back({rest.settings, joined(rest.label, step_label(study.ladders[l], s))});
        next.back().settings.insert(next.back().settings.end(), s.settings.begin(), s.settings.end());
      }
    rests = std::move(next);
  }
  const Ladder& first = study.ladders.front();
  for (std::size_t m = 0; m < study.methods.size(); ++m)
    for (const Ladder::Step& rest : rests) {
      Curve curve{joined(study.methods[m].name, rest.label), m, 0, {}};
      for (const Ladder::Step& s : first.steps) {
        Settings all = s.settings;
        all.insert(all.end(), rest.settings.begin(), rest.settings.end());
        curve.runs.push_back(add(study, plan, m, all, joined(step_label(first, s), rest.label), first.at));
      }
      plan.curves.push_back(std::move(curve));
    }
}

}  // namespace

std::string step_label(const Ladder& ladder, const Ladder::Step& step) {
  const bool named = ladder.name != step.settings.front().first;
  return ladder.name + (named ? " " : "=") + step.label;
}

std::string label_of(const Settings& settings) {
  std::string out;
  for (const auto& [path, value] : settings) out = joined(out, path + "=" + value);
  return out;
}

Plan plan_of(const Study& study) {
  if (study.ladders.empty()) throw Error(Exit::usage, "nothing is varied: give --vary key=value1,value2,... (in a study's file: 'ladders:')");
  if (study.repeats < 1) throw Error(Exit::usage, "--repeat counts from 1");
  if (study.quantities.empty()) throw Error(Exit::usage, "no quantity to compare: give --qoi group/name (in a study's file: 'quantities:')");
  if (!study.benchmark.empty()) {
    if (std::any_of(study.quantities.begin(), study.quantities.end(), [](const Quantity& q) { return q.reference.has_value(); }))
      throw Error(Exit::usage, "a benchmark has its own references");
    if (study.methods.size() > 1 || !study.methods.front().name.empty())
      throw Error(Exit::usage, "a benchmark has its own methods: choose among them with --set methods=a,b");
    if (!study.over_resolved.empty()) throw Error(Exit::usage, "a benchmark has its own references: over_resolved is for scenes");
    if (study.one_at_a_time && study.ladders.size() > 1) throw Error(Exit::usage, "a benchmark has combinations only: plan: combinations");
  }
  for (const Quantity& q : study.quantities)
    if (study.benchmark.empty() && q.body.empty() && q.value.find('/') == std::string::npos)
      throw Error(Exit::usage, q.place,
                  "quantity '" + q.name + "' names no body: a field of points is asked for as '{value: " + q.value +
                      ", body: NAME, over: max}', a number as group/name");
  std::set<std::string> varied;
  for (const Ladder& ladder : study.ladders) {
    std::set<std::string> own;
    for (const Ladder::Step& step : ladder.steps)
      for (const auto& [path, value] : step.settings) own.insert(path);
    for (const std::string& path : own)
      if (!varied.insert(path).second) throw Error(Exit::usage, ladder.at, "'" + path + "' is varied by two ladders");
  }
  Plan plan;
  if (study.one_at_a_time && study.benchmark.empty())
    one_at_a_time(study, plan);
  else
    combinations(study, plan);
  over_resolved(study);
  return plan;
}

Settings over_resolved(const Study& study) {
  for (const Ladder& ladder : study.ladders) {
    if (study.over_resolved.empty() || ladder.sizes.empty()) continue;
    const auto told = [&](const std::string& text) { return Error(Exit::usage, study.over_resolved_at, "over_resolved: " + text); };
    double finest = 0, here = 0;
    for (const auto& [path, value] : ladder.steps.back().settings)
      for (const auto& [other, fine] : study.over_resolved)
        if (path == other) finest = any_number(value), here = any_number(fine);
    if (!(here > 0)) throw told("it says nothing of '" + ladder.name + "', a ladder of this study");
    const double first = any_number(ladder.steps.front().settings.front().second);
    const double ratio = first > finest ? finest / here : here / finest;
    if (!(ratio >= tuning::kOverResolved * (1 - 1e-9)))
      throw told(fmt::format("'{}' is {:.3g} times finer than the finest of its ladder; a reference needs {:g} times", ladder.name, ratio,
                             tuning::kOverResolved));
  }
  return study.over_resolved;
}

}  // namespace mortise::study
