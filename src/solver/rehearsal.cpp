#include "solver/rehearsal.h"

#include <algorithm>
#include <map>

#include "base/pass_on.h"

namespace mortise::solver {
namespace {

// Names of kernels launched by `work`.
template <class Work>
std::vector<std::string> launched(Work work) {
  std::map<std::string, long long> before;
  for (const device::LaunchCount& l : device::launch_counts()) before[l.name] = l.launches;
  work();
  std::vector<std::string> out;
  for (const device::LaunchCount& l : device::launch_counts())
    if (l.launches > before[l.name]) out.push_back(l.name);
  return out;
}

}  // namespace

std::vector<Rehearsed> rehearse(const model::Model& model, Potential& potential) {
  Linearised at = potential.linearised();
  potential.linearise(model.q.view(), effects::Want::frozen(), at);
  potential.sample(at);
  device::Buffer<Vec3> still(model.blocks);
  still.zero();
  std::vector<Rehearsed> out;
  for (std::size_t k = 0; k < at.of.size(); ++k) {
    effects::Effect& effect = *potential.effects()[k];
    effects::Linearisation& here = *at.of[k];
    Rehearsed r{std::string(effect.name()), {}, {}};
    r.kernels = launched([&] {
      for (std::size_t c = 0; c < k; ++c)
        if (potential.effects()[c]->name() == effect.follows()) effect.lag(at.of[c]->contact, here);
      effect.linearise(model.q.view(), {true, true}, here);
      effect.sample(here);
      std::vector<double> alpha(model.envs, 1.0), energy(model.envs, 0.0);
      device::Fetch fetch;
      effect.max_step(std::as_const(still).view(), here, {alpha, fetch});
      fetch.now("rehearsal");
      effect.reach(here);
      effect.energy(model.q.view(), here, {energy, fetch});
      fetch.now("rehearsal");
      PassOn silent(nullptr);
      effect.report(silent, here);
    });
    r.buffers = effect.plan();
    r.buffers.push_back({"linearisation", here.bytes()});
    out.push_back(std::move(r));
  }
  return out;
}

}  // namespace mortise::solver
