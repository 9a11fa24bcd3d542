#include "run/together.h"

#include <sys/resource.h>

#include <algorithm>
#include <deque>

#include "engine/join.h"
#include "run/alone.h"
#include "run/environment.h"
#include "run/memory.h"
#include "run/shared_engine.h"
#include "run/stopwatch.h"

namespace mortise::run {
namespace {

struct Place {
  Turn turn;
  std::unique_ptr<Routine<Exit>> run;
  double cpu = 0;  // [s]
  bool ended = false;
  bool waits_for(Turn::Wants what) const { return !ended && turn.wants == what; }
};

class Loop {
 public:
  Loop(Together& all, const scene::Scene& scene, std::span<const scene::EffectTable> tables)
      : all_(all), engine_(engine::choose(all.options.at(0).device, all.options.at(0).threads)), places_(all.options.size()) {
    for (std::size_t i = 0; i < places_.size(); ++i)
      places_[i].run = std::make_unique<Routine<Exit>>(run_environment(all.options[i], scene, tables, *all.progress[i], places_[i].turn));
  }

  void go() {
    for (std::size_t i = 0; i < places_.size(); ++i) resume(i, [this, i] { places_[i].run->start(); });
    while (any(Turn::Wants::engine) || any(Turn::Wants::step)) {
      if (any(Turn::Wants::engine))
        admit();
      else
        step();
    }
  }

 private:
  bool any(Turn::Wants what) const {
    return std::any_of(places_.begin(), places_.end(), [&](const Place& p) { return p.waits_for(what); });
  }

  // Lets an environment go on to where it waits next, or to its end.
  template <class Go>
  void resume(std::size_t i, Go go) {
    Place& p = places_[i];
    const Stopwatch since;
    go();
    p.cpu += since.cpu();
    if (!p.run->done()) return;
    p.ended = true;
    EnvironmentEnd end;
    try {
      end.code = static_cast<int>(p.run->result());
    } catch (const Error& e) {
      end.code = static_cast<int>(e.code()), end.message = e.what();
    } catch (const std::bad_alloc&) {
      end.code = static_cast<int>(Exit::device), end.message = "out of memory";
    } catch (const std::exception& e) {
      end.code = static_cast<int>(Exit::internal), end.message = e.what();
    }
    p.run.reset();  // with all that it holds
    end.wall = begin_.wall(), end.cpu = p.cpu;
    all_.ended(i, end);
  }

  // Those that begin. What is wrong with one is found before it is beside others: one that has no model gets the reason; one whose bodies touch at
  // the start keeps an engine of its own, whose first step says so.
  void admit() {
    std::vector<std::size_t> joining;
    for (std::size_t i = 0; i < places_.size(); ++i)
      if (places_[i].waits_for(Turn::Wants::engine)) joining.push_back(i);
    for (std::size_t i : joining) {
      const Stopwatch since;
      Turn& turn = places_[i].turn;
      turn.device = engine_.device();
      turn.said.clear();
      std::unique_ptr<engine::Engine> trial;
      turn.outcome = engine_.try_alone(*turn.input, trial);
      if (turn.outcome.code == 0 && trial->begin().code == 0)
        *turn.made = engine_.add(*turn.input);
      else if (turn.outcome.code == 0)
        turn.outcome = engine_.try_alone(*turn.input, *turn.made);
      places_[i].cpu += since.cpu();
    }
    renew();
    for (std::size_t i : joining) resume(i, [this, i] { places_[i].turn.go_on(); });
  }

  void renew() {
    const Stopwatch since;
    const std::string remedy = "--together=K makes a model of every K environments";
    const std::string near = compare_memory(engine_.memory_needed(), engine_.device(), remedy);
    if (!near.empty() && !warned_) all_.progress.front()->note("warning: " + near + "; " + remedy);
    warned_ = warned_ || !near.empty();
    const engine::Outcome made = engine_.renew();
    if (made.code == static_cast<int>(Exit::device)) throw Error(Exit::device, made.message + "\n  " + remedy);
    if (made.code != 0) throw Error(static_cast<Exit>(made.code), made.message);
    share(since.cpu());
  }

  void step() {
    if (engine_.size() > 0 && engine_.worth_renewing()) renew();
    const Stopwatch since;
    engine::Outcome of_all;
    const auto member = [this](const Place& p) { return p.waits_for(Turn::Wants::step) && engine_.has(*p.turn.of); };
    const auto first = std::find_if(places_.begin(), places_.end(), member);
    if (first != places_.end()) of_all = engine_.step(first->turn.stop);
    const double wall = since.wall(), cpu = since.cpu() / std::max<double>(1, static_cast<double>(engine_.size()));
    std::vector<std::size_t> waiting;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      Place& p = places_[i];
      if (!p.waits_for(Turn::Wants::step)) continue;
      waiting.push_back(i);
      if (!member(p)) {
        take_step(p.turn);
        continue;
      }
      p.turn.outcome = engine_.outcome_of(*p.turn.of, of_all);
      p.turn.report = engine_.report_of(*p.turn.of);
      p.turn.wall = wall, p.turn.cpu = cpu;
      p.cpu += cpu;
    }
    for (std::size_t i : waiting) resume(i, [this, i] { places_[i].turn.go_on(); });
  }

  void share(double cpu) {
    const auto there = std::count_if(places_.begin(), places_.end(), [](const Place& p) { return !p.ended; });
    for (Place& p : places_)
      if (!p.ended) p.cpu += cpu / static_cast<double>(std::max<std::ptrdiff_t>(there, 1));
  }

  Together& all_;
  const Stopwatch begin_;
  SharedEngine engine_;
  bool warned_ = false;
  std::deque<Place> places_;
};

// Every environment holds a few files open.
void allow_files() {
  rlimit files = {};
  if (getrlimit(RLIMIT_NOFILE, &files) == 0 && files.rlim_cur < files.rlim_max) files.rlim_cur = files.rlim_max, setrlimit(RLIMIT_NOFILE, &files);
}

}  // namespace

void run_together(Together& environments, const scene::Scene& all, std::span<const scene::EffectTable> tables) {
  allow_files();
  Loop(environments, all, tables).go();
}

void check_together(const scene::Scene& all) {
  const Params* vary = all.root.at("environments").find("vary");
  for (std::size_t i = 0; vary && i < vary->items().size(); ++i) {
    const Params& path = vary->items()[i].at("path");
    if (const std::string why = engine::common_to_a_model(all.root, path.as_text()); !why.empty())
      throw Error(Exit::usage, path.where(),
                  "--together: " + path.as_text() + " cannot differ: " + why + "\n  without --together every environment has a model of its own");
  }
}

}  // namespace mortise::run
