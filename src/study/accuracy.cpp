#include "study/accuracy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "engine/effect_tables.h"
#include "run/signals.h"
#include "scene/environments.h"
#include "study/accuracy_budget.h"
#include "study/tuning.h"
#include "study/variant.h"

namespace mortise::study {
namespace {

class Search {
 public:
  Search(const Wanted& wanted, const Place& place, const std::function<void(const Attempt&, const std::vector<Quantity>&)>& told)
      : wanted_(wanted), place_(place), told_(told) {
    study_.scene = wanted.scene, study_.set = wanted.set, study_.methods.emplace_back();
    const scene::Scene scene = scene::read_scene(wanted.scene, wanted.set, engine::effect_tables());
    if (scene::environment_count(scene.root) > 0)
      throw Error(Exit::usage, "--accuracy: of a scene with 'environments' choose one in a scene of its own");
    const auto& bodies = scene.root.at("bodies").entries();
    for (const auto& [name, body] : bodies) {
      if (body.text("type") != "soft") continue;
      soft_ = true;
      if (body.integer("order") == 1) linear_.push_back(name);
    }
    study_.quantities = out_.quantities = quantities_of_goals(scene.root, wanted.goals);
    out_.goals = wanted.goals;
    take(auto_knobs(scene.root, out_.quantities));
    if (knobs_.empty()) throw Error(Exit::usage, "--accuracy: there is nothing to refine: no body has an edge_length, and nothing moves");
    for (const AutoKnob& k : knobs_)
      for (const AutoKnob::Path& p : k.paths)
        if (p.set)
          out_.notes.push_back(
              fmt::format("{} is {:.3g} mm in the run 'as it is': on thinner layers pressures scatter more from mesh to mesh", p.path, 1e3 * p.base));
  }

  Accuracy go() {
    const std::size_t first = run(centre_, 0);
    if (out_.attempts[first].run.failed()) throw Error(Exit::solve, "the scene as it is failed: " + out_.attempts[first].run.message);
    here_ = first;
    by_budget_ = budgets_tell(knobs_) && budgets_here();
    if (!by_budget_) {
      take(joined(knobs_));
      out_.attempts[first].levels = centre_;
    }
    out_.how = by_budget_
                   ? "what each run says of its own errors (error budget); facets of round surfaces and the integration of contact are not in it"
                   : "how numbers change from run to run";
    refine();
    finish();
    return std::move(out_);
  }

 private:
  void take(std::vector<AutoKnob> knobs) {
    knobs_ = std::move(knobs);
    out_.knobs.clear();
    for (const AutoKnob& k : knobs_) out_.knobs.push_back(k.name);
    finest_.assign(knobs_.size(), tuning::kMostLevels), centre_.assign(knobs_.size(), 0);
  }

  std::optional<std::vector<GoalBudget>> budgets_here() const { return goal_budgets(certificate_here(), out_.quantities); }
  std::string certificate_here() const { return place_.folder + "/runs/" + here().id + "/certificate.json"; }

  const RunResult& here() const { return out_.attempts[here_].run; }
  double left() const { return wanted_.most - out_.seconds; }
  std::vector<double> goals() const {
    std::vector<double> out;
    for (std::size_t q = 0; q < out_.goals.size(); ++q) out.push_back(out_.goal(q, here().values[q]));
    return out;
  }

  // expected: CPU time, 0 where it is not known.
  std::size_t run(const Levels& levels, double expected) {
    for (std::size_t i = 0; i < out_.attempts.size(); ++i)
      if (out_.attempts[i].levels == levels) return i;
    Attempt a;
    a.levels = levels;
    std::string label;
    Settings settings;
    for (std::size_t k = 0; k < knobs_.size(); ++k) {
      const Settings own = knobs_[k].settings(levels[k]);
      settings.insert(settings.end(), own.begin(), own.end());
      if (levels[k] != 0) label += (label.empty() ? "" : ", ") + knobs_[k].label(levels[k]);
    }
    if (expected > left()) {
      a.run.label = label, a.run.code = static_cast<int>(Exit::stopped), a.run.values.assign(out_.goals.size(), NAN);
      a.run.message = fmt::format("not run: it would take about {:.2g} s of CPU time, {:.2g} s are left", expected, std::max(0.0, left()));
    } else {
      Planned planned{0, settings, label.empty() ? "as it is" : label, {}};
      try {
        planned.variant = variant_of(study_, study_.methods.front(), settings);
        a.run = execute(planned, place_, 1, {0, std::max(1.0, left())});
        measure_all(study_, place_, a.run);
      } catch (const scene::SceneErrors& e) {  // of a scene that is coarser or finer than it can be
        if (label.empty()) throw;
        a.run.label = label, a.run.code = static_cast<int>(Exit::scene), a.run.message = e.what(), a.run.values.assign(out_.goals.size(), NAN);
      } catch (const Error& e) {
        if (label.empty() || (e.code() != Exit::usage && e.code() != Exit::scene)) throw;
        a.run.label = label, a.run.code = static_cast<int>(e.code()), a.run.message = e.what(), a.run.values.assign(out_.goals.size(), NAN);
      }
    }
    for (double v : a.run.values)
      if (!a.run.failed() && !std::isfinite(v)) a.run.code = static_cast<int>(Exit::solve), a.run.message = "it does not report what is looked for";
    out_.seconds += a.run.process;
    out_.attempts.push_back(a);
    told_(a, out_.quantities);
    return out_.attempts.size() - 1;
  }

  double size(std::size_t k, const Attempt& a) const {  // over that at the centre
    const RunResult& r = a.run;
    return knobs_[k].mesh && !knobs_[k].layer && r.dofs > 0 && r.dofs != here().dofs
               ? std::cbrt(static_cast<double>(here().dofs) / static_cast<double>(r.dofs))
               : knobs_[k].size(a.levels[k]) / knobs_[k].size(centre_[k]);
  }

  bool same(const RunResult& r) const { return r.dofs == here().dofs && r.values == here().values; }

  // From all runs in which only this knob is elsewhere than at the centre. Levels count from there.
  Climb climb_of(std::size_t k) const {
    Climb out;
    out.name = knobs_[k].name, out.ratio = knobs_[k].ratio, out.dearer = knobs_[k].dearer, out.finest = finest_[k] - centre_[k];
    out.rungs.push_back({0, 1, here().values, 1});
    std::vector<const Attempt*> along;
    for (const Attempt& a : out_.attempts) {
      Levels others = a.levels;
      others[k] = centre_[k];
      if (others == centre_ && a.levels[k] != centre_[k] && !a.run.failed()) along.push_back(&a);
    }
    const bool moves = std::any_of(along.begin(), along.end(), [&](const Attempt* a) { return !same(a->run); });
    for (const Attempt* a : along) {
      if (moves && same(a->run)) continue;  // the same meshes: nothing was refined
      const int level = a->levels[k] - centre_[k];
      out.add({level, size(k, *a), a->run.values, std::max(a->run.process, kLeastCost) / std::max(here().process, kLeastCost)});
    }
    out.blind = knobs_[k].mesh && soft_ && !along.empty() && !moves;
    return out;
  }

  std::vector<Climb> climbs_here() const {
    std::vector<Climb> out;
    if (!by_budget_) {
      for (std::size_t k = 0; k < knobs_.size(); ++k) {
        out.push_back(climb_of(k));
        if (const auto before = before_.find(here_); out[k].rungs.size() == 1 && before != before_.end()) out[k] = before->second[k];
      }
      return out;
    }
    out = climbs_of_budgets(knobs_, budgets_here().value_or(std::vector<GoalBudget>(out_.goals.size(), {INFINITY, INFINITY})));
    for (std::size_t k = 0; k < knobs_.size(); ++k) out[k].finest = finest_[k] - centre_[k], out[k].rungs.push_back({0, 1, here().values, 1});
    return out;
  }

  // A coarser run tells whether a knob matters at all, and is cheap; more of them what it tends to.
  void look_along(std::size_t k) {
    const auto neighbour = [&](int level) {
      Levels at = centre_;
      at[k] += level;
      if (at[k] > finest_[k] || knobs_[k].size(at[k]) == knobs_[k].size(level < 0 ? at[k] + 1 : at[k] - 1)) return;
      const double expected = std::max(here().process, kLeastCost) * std::pow(knobs_[k].ratio, -level * knobs_[k].dearer);
      if (expected > left()) return;
      const std::size_t i = run(at, expected);
      if (out_.attempts[i].run.failed() && level > 0) {
        finest_[k] = at[k] - 1;
        out_.notes.push_back(fmt::format("{}: {}", out_.attempts[i].run.label, out_.attempts[i].run.message));
      }
    };
    for (int level : {-1, -2, 1, 2}) {
      const Climb climb = climb_of(k);
      // Meshes that came out equal say nothing yet.
      const bool more = std::all_of(climb.rungs.begin(), climb.rungs.end(), [&](const Rung& r) { return r.values == here().values; });
      if (more || (climb.rungs.size() < 3 && !alone(climb))) neighbour(level);
    }
  }

  // Does a knob leave so little that it need not be looked at?
  bool alone(const Climb& climb, double share = tuning::kAlone) const {
    const std::vector<double> most = goals();
    for (std::size_t q = 0; q < most.size(); ++q)
      if (climb.error(q, 0) > share * most[q]) return false;
    return true;
  }

  // Knobs that left little before are looked at again only where all hangs on it, those that left nothing never.
  void look_around() {
    for (const bool all : {false, true}) {
      for (std::size_t k = 0; k < knobs_.size() && !by_budget_; ++k)
        if (!before_.contains(here_) || !alone(before_[here_][k], all ? tuning::kNothing : tuning::kAlone)) look_along(k);
      estimate_here();
      if (!holds()) break;
    }
    seen_.push_back(here_);
  }

  void estimate_here() {
    out_.climbs = climbs_here();
    std::vector<double>& estimates = out_.attempts[here_].estimates;
    estimates.clear();
    for (std::size_t q = 0; q < out_.goals.size(); ++q) estimates.push_back(estimate(out_.climbs, q, Levels(knobs_.size(), 0)));
  }

  // Where a number has not settled its estimate is what it scatters by, which may be far less than what it is wrong by.
  bool holds() const {
    const std::vector<double> most = goals();
    for (std::size_t q = 0; q < most.size(); ++q)
      if (!(out_.attempts[here_].estimates[q] * (settles(out_.climbs, q, most[q]) ? 1 : tuning::kUnknownOrder / tuning::kSafety) <= most[q]))
        return false;
    return true;
  }

  void refine() {
    for (;;) {
      look_around();
      if (holds()) return void(out_.reached = true);
      const double now = std::max(here().process, kLeastCost), most = left() / now / tuning::kForetold;
      const Chosen next = choose_levels(out_.climbs, goals(), tuning::kAim, Levels(knobs_.size(), 0), most);
      Levels to = centre_;
      double cost = next.cost;
      for (std::size_t k = 0; k < knobs_.size(); ++k) to[k] += next.levels[k];
      // Along ladders one knob at a time: its run tells for a part of the price what the others are worth there.
      if (!by_budget_) to = centre_, to[next.first] += next.levels[next.first], cost = out_.climbs[next.first].cost(next.levels[next.first]);
      // On meshes that are too coarse other knobs seem to tend where they do not, to ladders: of what is far off the mesh first.
      const std::size_t k = most_left(next.worst);
      if (to == centre_ || (!by_budget_ && !next.reached && knobs_[k].mesh && out_.climbs[k].cost(1) <= most)) {
        if (centre_[k] >= finest_[k])
          return void(out_.why_not =
                          fmt::format("'{}' does not settle, and {} is not refined any further", out_.quantities[next.worst].name, out_.knobs[k]));
        to = centre_, ++to[k], cost = out_.climbs[k].cost(1);
      }
      const std::size_t i = run(to, now * cost * tuning::kForetold);
      if (out_.attempts[i].run.failed()) return void(out_.why_not = out_.attempts[i].run.label + ": " + out_.attempts[i].run.message);
      before_.erase(i);
      if (!by_budget_)
        for (std::size_t n = 0; n < knobs_.size(); ++n) before_[i].push_back(out_.climbs[n].around(to[n] - centre_[n], out_.attempts[i].run.values));
      centre_ = to, here_ = i;
    }
  }

  // The knob that leaves most.
  std::size_t most_left(std::size_t q) const {
    std::size_t worst = 0;
    double most = -1;
    for (std::size_t k = 0; k < knobs_.size(); ++k) {
      const double error = out_.climbs[k].error(q, 0);
      if (error > most) most = error, worst = k;
    }
    return worst;
  }

  // The run that reaches all goals, else the one of those whose errors were looked at that comes nearest by all that is known in the end; of equal
  // ones the last.
  void finish() {
    const std::vector<double> asked = goals();  // as the last run has them
    std::size_t chosen = here_;
    double best = INFINITY;
    for (const std::size_t i : seen_) {
      if (out_.reached) break;
      centre_ = out_.attempts[i].levels, here_ = i;
      if (!by_budget_) estimate_here();  // a budget is of the run alone
      const std::vector<double>& estimates = out_.attempts[i].estimates;
      double worst = 0;
      for (std::size_t q = 0; q < estimates.size(); ++q) worst = std::max(worst, estimates[q] / asked[q]);
      if (worst <= best * (1 + tuning::kRounding)) best = worst, chosen = i;
    }
    out_.chosen = chosen;
    centre_ = out_.attempts[out_.chosen].levels, here_ = out_.chosen;
    out_.climbs = climbs_here();
    out_.doubt = doubt_of(certificate_here(), out_.quantities);
    for (std::size_t k = 0; k < knobs_.size(); ++k) {
      for (const auto& s : knobs_[k].settings(centre_[k])) out_.settings.push_back(s);
    }
    if (!out_.reached) hint_at_order(asked);
  }

  // Quadratic elements are no knob of ours, but often what a mesh of linear ones asks for.
  void hint_at_order(const std::vector<double>& asked) {
    for (std::size_t q = 0; q < asked.size(); ++q) {
      const AutoKnob& most = knobs_[most_left(q)];
      if (linear_.empty() || !most.mesh || !(out_.climbs[most_left(q)].error(q, 0) > tuning::kAlone * asked[q])) continue;
      std::string set;
      for (const std::string& body : linear_) set += fmt::format(" --set bodies.{}.order=2", body);
      return out_.notes.push_back(fmt::format("most of what '{}' lacks is left by a mesh of linear elements: quadratic ones may reach it sooner ({})",
                                              out_.quantities[q].name, set.substr(1)));
    }
  }

  static constexpr double kLeastCost = 0.05;  // CPU time of a process that does nothing [s]

  const Wanted& wanted_;
  const Place& place_;
  const std::function<void(const Attempt&, const std::vector<Quantity>&)>& told_;
  Study study_;
  std::vector<AutoKnob> knobs_;
  bool by_budget_ = false;
  bool soft_ = false;                // there are soft bodies, so that another mesh has other unknowns
  std::vector<std::string> linear_;  // those of linear elements
  Accuracy out_;
  Levels centre_;         // the run that neighbours are compared with
  std::size_t here_ = 0;  // its number
  std::vector<int> finest_;
  std::vector<std::size_t> seen_;                     // the centres so far
  std::map<std::size_t, std::vector<Climb>> before_;  // by centre: what was known of its knobs when it was chosen
};

}  // namespace

Accuracy find_accuracy(const Wanted& wanted, const Place& place, const std::function<void(const Attempt&, const std::vector<Quantity>&)>& told) {
  run::install_signal_handlers();
  return Search(wanted, place, told).go();
}

}  // namespace mortise::study
