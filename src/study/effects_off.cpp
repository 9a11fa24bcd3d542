#include "study/effects_off.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/csv_cell.h"
#include "engine/effect_tables.h"
#include "run/signals.h"
#include "scene/scene.h"
#include "scene/suggest.h"
#include "study/report.h"

namespace mortise::study {
namespace {

// The effect and all that follow it, in whatever chain.
std::vector<std::string> with_followers(const Params& effects, const std::string& name) {
  std::vector<std::string> out{name};
  for (std::size_t i = 0; i < out.size(); ++i)
    for (const auto& [other, block] : effects.entries()) {
      const Params* follows = block.kind() == Params::Kind::table ? block.find("follows") : nullptr;
      if (follows && follows->as_text() == out[i] && !std::count(out.begin(), out.end(), other)) out.push_back(other);
    }
  return out;
}

// The message of the first of the errors, without its place.
std::string first_error(const Error& e) {
  std::string text = e.what();
  if (const std::size_t at = text.find("error: "); at != std::string::npos) text = text.substr(at + 7);
  return text.substr(0, text.find('\n'));
}

std::string change_text(double before, double now) {
  if (!std::isfinite(now)) return "gone";
  constexpr double kRounding = 1e-9;  // of sums that are added up in another order
  if (std::abs(now - before) <= kRounding * std::abs(before)) return "none";
  return before != 0 ? fmt::format("{:+.3g} %", 100 * (now / before - 1)) : fmt::format("{:+.3g}", now);
}

std::string name_of(const WithoutEffect& w) { return w.effects.empty() ? "as it is" : scene::join(w.effects, " and "); }

}  // namespace

std::vector<WithoutEffect> run_without_effects(const Study& study, const Place& place, const Told& told) {
  run::install_signal_handlers();
  if (study.scene.empty()) throw Error(Exit::usage, "--effects is for scenes, not for benchmarks");
  if (study.quantities.empty()) throw Error(Exit::usage, "no quantity to compare: give --qoi group/name");
  const scene::Scene scene = scene::read_scene(study.scene, study.set, engine::effect_tables());
  std::vector<WithoutEffect> out(1);
  for (const auto& [name, block] : scene.root.at("effects").entries()) out.push_back({with_followers(scene.root.at("effects"), name), "", {}});
  std::vector<Planned> plans;
  for (WithoutEffect& w : out) {
    Planned p{0, {}, w.effects.empty() ? "as it is" : "without " + scene::join(w.effects, " and ")};
    try {
      p.variant = variant_of(study, {"", w.effects, {}}, {});
    } catch (const Error& e) {
      if (w.effects.empty()) throw;
      w.needed = first_error(e);
    }
    plans.push_back(std::move(p));
  }
  const auto all = static_cast<std::size_t>(std::count_if(out.begin(), out.end(), [](const WithoutEffect& w) { return w.needed.empty(); }));
  for (std::size_t i = 0, done = 0; i < out.size(); ++i) {
    if (!out[i].needed.empty()) continue;
    out[i].run = execute(plans[i], place, study.repeats, {study.limit});
    if (i > 0 && out[i].run.code == static_cast<int>(Exit::scene)) {  // what only the engine finds: a joint that a drive names
      out[i].needed = out[i].run.message;
      continue;
    }
    measure_all(study, place, out[i].run, i > 0);
    told.run(++done, all, out[i].run);
    if (i == 0 && out[0].run.failed()) throw Error(Exit::solve, "the scene as it is failed: " + out[0].run.message);
  }
  return out;
}

std::string effects_table(const Study& study, const std::vector<WithoutEffect>& runs) {
  const RunResult& whole = runs.front().run;
  std::size_t wide = 20;
  for (const WithoutEffect& w : runs) wide = std::max(wide, name_of(w).size());
  std::string out = fmt::format("{:{}} {:>10} {:>11}", "effect that is off", wide, "CPU time", "time saved"), rows, hints;
  for (const Quantity& q : study.quantities) out += fmt::format("  {:>14}", q.name.size() > 24 ? q.name.substr(0, 23) + "…" : q.name);
  out += "\n";
  for (const WithoutEffect& w : runs) {
    out += fmt::format("{:{}} ", name_of(w), wide);
    if (!w.needed.empty()) {
      out += "cannot be left out: " + w.needed + "\n";
      continue;
    }
    if (w.run.failed()) {
      out += "failed: " + w.run.message + "\n";
      continue;
    }
    const double saved = 1 - w.run.seconds / whole.seconds;
    out += fmt::format("{:>10} {:>11}", seconds_text(w.run.seconds), w.effects.empty() ? "" : fmt::format("{:.0f} %", 100 * saved));
    double most = 0;
    for (std::size_t k = 0; k < study.quantities.size(); ++k) {
      const double before = whole.values[k], now = w.run.values[k];
      out += fmt::format("  {:>{}}", w.effects.empty() ? fmt::format("{:.6g}", before) : change_text(before, now),
                         std::max<std::size_t>(14, std::min<std::size_t>(study.quantities[k].name.size(), 24)));
      most = std::max(most, std::isfinite(now) && before != 0 ? std::abs(now / before - 1) : (now == before ? 0 : INFINITY));
    }
    out += "\n";
    constexpr double kWorthIt = 0.05, kSmall = 0.01;  // of time saved, of change
    if (!w.effects.empty() && saved > kWorthIt && most < kSmall)
      hints += fmt::format("without {} the scene takes {:.0f} % less time, and no quantity changes by more than {:.2g} %\n", name_of(w), 100 * saved,
                           100 * most);
  }
  return out + (hints.empty() ? "" : "\n" + hints);
}

std::string effects_csv(const Study& study, const std::vector<WithoutEffect>& runs) {
  std::string out = "off,cpu_seconds,cpu_seconds_slowest,time_saved,quantity,value,change,status,reason\n";
  const RunResult& whole = runs.front().run;
  const auto text = [](std::string s) {
    std::replace(s.begin(), s.end(), '"', '\'');
    return "\"" + s + "\"";
  };
  for (const WithoutEffect& w : runs)
    for (std::size_t k = 0; k < study.quantities.size(); ++k) {
      const bool ran = w.needed.empty() && !w.run.failed();
      const double v = ran ? w.run.values[k] : NAN;
      out += fmt::format("{},{},{},{},{},{},{},{},{}\n", text(name_of(w)), csv_cell(ran ? w.run.seconds : NAN), csv_cell(ran ? w.run.slowest : NAN),
                         csv_cell(ran ? 1 - w.run.seconds / whole.seconds : NAN), text(study.quantities[k].name), csv_cell(v),
                         csv_cell(v / whole.values[k] - 1),
                         !w.needed.empty() ? "needed"
                         : w.run.failed()  ? "failed"
                                           : "done",
                         text(w.needed.empty() ? w.run.message : w.needed));
    }
  return out;
}

}  // namespace mortise::study
