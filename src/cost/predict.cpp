#include "cost/predict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>

#include "base/version.h"
#include "cost/tuning.h"
#include "engine/choose.h"
#include "output/hardware.h"

namespace mortise::cost {
namespace {

double iterations_of_a_step(const Work& w) {
  if (!w.contact) return tuning::kIterationsFree;
  return w.statics ? tuning::kIterationsStatic : w.drives ? tuning::kIterationsDriven : tuning::kIterations;
}

std::string today() {
  const std::time_t now = std::time(nullptr);
  char date[16];
  std::strftime(date, sizeof date, "%F", std::localtime(&now));
  return date;
}

// "0.35 s", "41 s", "2.6 h"
std::string time_text(double s) {
  if (s < 120) return fmt::format("{:.2g} s", s < 99.5 ? s : 10 * std::round(s / 10));
  return s < 7200 ? fmt::format("{:.2g} min", s / 60) : fmt::format("{:.2g} h", s / 3600);
}

}  // namespace

double iteration_seconds(const Work& w) {
  const double solve = w.iterates ? tuning::kPerIterated * w.blocks : tuning::kPerFactor * w.factor;
  return tuning::kPerIteration + tuning::kPerTet * w.tets + tuning::kPerQuadraticTet * w.quadratic + tuning::kPerTriangle * w.triangles + solve;
}

std::optional<Prediction> from_past(const Work& w, const std::string& physics, const std::string& kind, const std::vector<Past>& runs) {
  const Past *same = nullptr, *alike = nullptr;
  for (const Past& r : runs) {
    if (r.physics == physics && (!same || r.steps >= std::min(w.steps, same->steps))) same = &r;  // the last that goes as far
    if (r.kind == kind) alike = &r;
  }
  const double steps = static_cast<double>(w.steps);
  if (same) {
    const double taken = static_cast<double>(same->steps), whole = std::min(1.0, taken / steps);
    return Prediction{same->seconds * steps / taken, tuning::kAgain * std::pow(tuning::kSpread, 1 - whole),
                      fmt::format("this scene took {} for {} steps on this machine on {}{}", time_text(same->seconds), same->steps, same->date,
                                  same->version == version() ? "" : ", with mortise " + same->version)};
  }
  if (alike && alike->iterations > 0) {
    const double iterations = static_cast<double>(alike->iterations) / static_cast<double>(alike->steps);
    const double each = iteration_seconds(w) * alike->seconds / (static_cast<double>(alike->iterations) * alike->model);
    return Prediction{
        steps * iterations * each, tuning::kSameKind,
        fmt::format("{} steps of {:.1f} Newton iterations, as the same bodies and effects with other numbers took on {}, and {} each by "
                    "the sizes of both",
                    w.steps, iterations, alike->date, time_text(each))};
  }
  return {};
}

std::optional<Prediction> from_trial(const Work& w, const Trial& t) {
  if (t.steps == 0) return {};
  const double steps = static_cast<double>(w.steps), taken = static_cast<double>(t.steps), left = steps - taken, part = taken / steps;
  if (left <= 0) return Prediction{t.seconds, tuning::kAgain, fmt::format("all {} steps were just tried", t.steps)};
  // The farther the trial went, the more what comes is like it, in the logarithm; contact that has not begun yet is what it cannot know.
  const double weight = std::sqrt(part);
  const double iterations = std::exp(weight * std::log(std::max(t.later_iterations, 1.0)) + (1 - weight) * std::log(iterations_of_a_step(w)));
  return Prediction{
      t.seconds + left * iterations * t.each, tuning::kAgain * std::pow(tuning::kSpread, 1 - part),
      fmt::format("{} of {} steps were just tried, {:.1f} Newton iterations each and {} an iteration; {:.1f} are expected of the others", t.steps,
                  w.steps, static_cast<double>(t.iterations) / taken, time_text(t.each), iterations)};
}

std::optional<Prediction> from_scout(const Work& w, const Trial& t, const Scouted& s, double each_by_sizes) {
  const double count = static_cast<double>(w.steps), taken = static_cast<double>(t.steps), left = count - taken;
  const double seen = static_cast<double>(s.steps.size());
  if (seen <= taken) return {};
  const Passed tried = s.until(taken), end = s.until(seen), half = s.until(0.5 * (taken + seen));
  // Iterations of the scene for one of the scout's, by the steps that both took as far as they go.
  double more = 1;
  if (t.iterations > 0 && tried.iterations > 0) more = std::pow(static_cast<double>(t.iterations) / tried.iterations, std::sqrt(taken / count));
  // Where the scout was stopped, what follows is like the later half of what it saw.
  const double rate = (end.iterations - half.iterations) / (0.5 * (seen - taken));
  const double iterations = more * (end.iterations - tried.iterations + (count - seen) * rate);
  // Iterations with contact take longer than those before it by as much as they do for the scout.
  const Passed first = s.until(std::max(taken, 1.0));
  double each = t.each > 0 ? t.each : each_by_sizes;
  if (t.each > 0 && first.iterations > 0 && end.iterations > tried.iterations) {
    const double grown = (end.seconds - tried.seconds) / (end.iterations - tried.iterations) / (first.seconds / first.iterations);
    each *= std::clamp(grown, 1.0, tuning::kMostGrown);
  }
  return Prediction{t.seconds + iterations * each, tuning::kScouted * std::pow(tuning::kSpread, (count - seen) / left),
                    fmt::format("{} of {} steps were just tried; {:.0f} of the others were seen with edges {:g} times as long, and {:.1f} Newton "
                                "iterations of {} are expected of each",
                                t.steps, w.steps, seen - taken, s.edges, iterations / left, time_text(each))};
}

Prediction from_sizes(const Work& w, const Speed& s) {
  const double iterations = iterations_of_a_step(w), each = iteration_seconds(w) * s.slowness;
  return {static_cast<double>(w.steps) * iterations * each, tuning::kSpread,
          fmt::format(
              "{} steps of {:.1f} Newton iterations, as such scenes take, and {} each by the sizes of the meshes; this machine takes {:.2f} times "
              "the reference's time for a small scene ({}{})",
              w.steps, iterations, time_text(each), s.slowness, s.now ? "measured now" : "measured on " + s.date,
              s.load > 1 ? fmt::format(", load {:.1f}", s.load) : "")};
}

std::string text(const Prediction& p) {
  return fmt::format("about {} of CPU time in the steps ({} to {}): {}", time_text(p.seconds), time_text(p.seconds / p.factor),
                     time_text(p.seconds * p.factor), p.from);
}

std::string predict(const model::ModelInput& input, engine::Engine& engine) {
  const Work work = work_of(input, engine.linear_solver());
  if (const auto past = from_past(work, same_physics(input.scene), same_kind(input.scene), kept_runs())) return text(*past);
  engine::choose("cpu", 1);  // what the sizes were timed on
  try {
    const Speed speed = speed_of_machine();
    const double each = iteration_seconds(work) * speed.slowness;
    Prediction best = from_sizes(work, speed);
    Trial trial;
    const auto go_on = [&](double until) {
      if (each <= tuning::kLongestIteration) trial = try_steps(engine, work.steps, until, trial);
      if (const auto tried = from_trial(work, trial)) best = *tried;
    };
    go_on(tuning::kTrial);
    if (best.seconds - trial.seconds <= tuning::kTrial) return text(best);
    const double most = std::max(tuning::kScout, tuning::kScoutShare * best.seconds);
    const double edges = coarse_enough(input, engine.linear_solver(), best.seconds, most);
    const Scouted scouted = edges > 1 ? scout(input.scene, edges, most) : Scouted{};
    if (const auto seen = from_scout(work, trial, scouted, each)) return text(*seen);
    // Nothing that could be coarser: the scene itself goes on.
    go_on(tuning::kTrial + most);
    return text(best);
  } catch (const Error& e) {
    return std::string("not known: ") + e.what();
  }
}

void learn(const model::ModelInput& input, const std::string& linear_solver, int threads, long steps, long iterations, double cpu_seconds) {
  if (steps <= 0 || !(cpu_seconds > 0)) return;
  keep({same_physics(input.scene), same_kind(input.scene), version(), output::hardware().cpu, today(), threads, steps, iterations, cpu_seconds,
        iteration_seconds(work_of(input, linear_solver))});
}

}  // namespace mortise::cost
