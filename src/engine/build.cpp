// One build of the engine: compiled by g++ into the program, by nvcc into the CUDA module.
#include "engine/build.h"

#include "base/added_fields.h"
#include "base/complaints.h"
#include "effects/commanded.h"
#include "effects/contact/start_check.h"
#include "effects/list.h"
#include "engine/bandwidth.h"
#include "linalg/cholesky/openblas.h"
#include "model/model.h"
#include "solver/simulation.h"

namespace mortise::engine {
namespace {

Outcome guarded(const std::function<void()>& work) {
  try {
    work();
  } catch (const solver::Stopped&) {
    return {static_cast<int>(Exit::stopped), "stopped", false};
  } catch (const effects::contact::StartError& e) {
    return {static_cast<int>(e.code()), e.what(), e.located(), e.obj()};
  } catch (const Error& e) {
    return {static_cast<int>(e.code()), e.what(), e.located()};
  } catch (const std::bad_alloc&) {
    return {static_cast<int>(Exit::device), "out of memory", false};
  } catch (const std::exception& e) {
    return {static_cast<int>(Exit::internal), e.what(), false};
  }
  return {};
}

// Rows of one are rows of the other.
void require_same_freedoms(const model::Model& a, const model::Model& b) {
  if (a.envs != 1 || b.envs != 1) throw Error(Exit::usage, "one environment at a time");
  if (a.blocks != b.blocks || a.points != b.points || a.held != b.held)
    throw Error(Exit::usage, "it changes meshes, or what is held: there is no derivative with respect to it");
}

class Build : public Engine {
 public:
  explicit Build(const model::ModelInput& input)
      : model_(input), effects_(make_effects()), simulation_(model_, effects_, solver::read_options(input.scene)) {}

  Outcome begin() override {
    return guarded([&] { simulation_.begin(); });
  }
  void command(const std::vector<model::Command>& commands) override {
    for (const auto& effect : effects_)
      if (auto* commanded = dynamic_cast<effects::Commanded*>(effect.get())) commanded->command(commands);
  }
  Outcome step(const std::function<bool()>& stop_asked, const solver::StepReports& report) override {
    const device::Transfers before = device::transfers();
    const device::Waits waited = device::waits();
    const Outcome outcome = guarded([&] { simulation_.step(stop_asked, report); });
    step_transfers_ = step_transfers_ + (device::transfers() - before);
    for (const auto& [who, n] : device::waits()) {
      const auto old = waited.find(who);
      if (const long long more = n - (old == waited.end() ? 0 : old->second); more > 0) step_waits_[who] += more;
    }
    return outcome;
  }
  Outcome lead(const std::vector<Engine*>& others) override {
    return guarded([&] {
      std::vector<solver::Simulation*> simulations;
      for (Engine* other : others) {
        Build& build = static_cast<Build&>(*other);
        require_same_freedoms(model_, build.model_);
        simulations.push_back(&build.simulation_);
      }
      simulation_.lead(std::move(simulations));
    });
  }
  Outcome mend(effects::Fault fault, double share) override {
    return guarded([&] { simulation_.mend(fault, share); });
  }
  void rest(Index env) override { simulation_.rest(env); }
  std::string lost(Index env) const override { return simulation_.lost(env); }
  Outcome adjoint(const solver::Functional& of, solver::Adjoint& out) override {
    return guarded([&] {
      try {
        out = simulation_.adjoint(of);
      } catch (const solver::Failure& failure) {
        throw Error(Exit::solve, failure.reason);
      }
    });
  }
  void report(const FieldSinks& sinks) override {
    std::vector<std::unique_ptr<AddedFields>> added(sinks.size());
    std::vector<FieldSink*> through(sinks.size(), nullptr);
    for (Index e = 0; e < sinks.size(); ++e)
      if (sinks.wanted(e)) added[e] = std::make_unique<AddedFields>(&sinks[e]), through[e] = added[e].get();
    simulation_.report(FieldSinks(through));
    for (const auto& a : added)
      if (a) a->finish();
  }
  std::vector<double> points() override {
    device::Buffer<Vec3> y;
    model_.points_of(model_.q.view(), y);
    std::vector<double> out;
    for (const Vec3& x : y.download()) out.insert(out.end(), {x[0], x[1], x[2]});
    return out;
  }
  using Engine::checkpoint;
  Outcome checkpoint(const std::vector<Archive*>& of) override {
    return guarded([&] { simulation_.checkpoint(of); });
  }
  double time(Index env) const override { return simulation_.time(env); }
  long steps_done(Index env) const override { return simulation_.steps_done(env); }
  solver::Clock clock() const override { return simulation_.clock(); }
  std::vector<std::pair<std::string, long long>> launches() const override {
    std::vector<std::pair<std::string, long long>> out;
    for (const device::LaunchCount& l : device::launch_counts()) out.emplace_back(l.name, l.launches);
    return out;
  }
  device::Transfers transfers() const override { return device::transfers(); }
  device::Transfers step_transfers() const override { return step_transfers_; }
  std::vector<std::pair<std::string, long long>> step_waits() const override { return {step_waits_.begin(), step_waits_.end()}; }
  std::size_t peak_memory() const override { return device::memory_use().peak; }
  std::vector<PlanItem> plan() override {
    std::vector<PlanItem> out;
    for (const solver::Rehearsed& r : simulation_.rehearse()) {
      PlanItem item{r.effect, {}, r.kernels};
      for (const effects::PlanItem& b : r.buffers) item.buffers.emplace_back(b.what, b.bytes);
      out.push_back(std::move(item));
    }
    return out;
  }
  std::string linear_solver() const override { return simulation_.newton().linear_solver() + " (" + simulation_.newton().linear_reason() + ")"; }

 private:
  // Only what the scene names, in the order of the list. Motors and followers build on others: where one of these is wrong, they are not judged.
  solver::EffectList make_effects() {
    solver::EffectList out;
    Complaints wrong;
    const Params& wanted = model_.input.scene.at("effects");
    for (const effects::Kind& kind : effects::list()) {
      const bool builds_on_others = kind.role == effects::Role::motor || kind.role == effects::Role::follower;
      if (const Params* block = wanted.find(kind.name); block && (wrong.empty() || !builds_on_others))
        wrong.gather([&] { out.push_back(kind.make(*block, model_)); });
    }
    wrong.raise();
    return out;
  }

  model::Model model_;
  solver::EffectList effects_;
  solver::Simulation simulation_;
  device::Transfers step_transfers_;
  device::Waits step_waits_;
};

Outcome create(const model::ModelInput& input, std::unique_ptr<Engine>& out) {
  return guarded([&] { out = std::make_unique<Build>(input); });
}

void set_threads(int n) {
  device::set_threads(n);
  linalg::ready_openblas();
}

Outcome select(int number, bool debug) {
  return guarded([&] { device::select(number, debug); });
}

Outcome bandwidth(Index edge, Bandwidth& out) {
  return guarded([&] { measure_bandwidth(edge, out); });
}

}  // namespace

const Api& build_api() {
  static const Api api{kApiVersion, device::devices, device::architectures, select, set_threads, create, bandwidth};
  return api;
}

}  // namespace mortise::engine
