#include "solver/line_search.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "solver/kernels.h"
#include "solver/tuning.h"

namespace mortise::solver {
namespace {

// f, of some environments.
template <class F>
auto ask_of(const model::Model& model, const EnvMask& whose, const F& f) {
  const model::Only only(model, whose);
  return f(whose);
}

}  // namespace

void LineSearch::ask(device::View<const Vec3> q, device::Buffer<Vec3>& dq, device::View<const Vec3> c, Linearised& at, device::Fetch& fetch) {
  const model::Model& model = system_.model;
  alpha_.assign(model.envs, 1.0);
  system_.potential.max_step(std::as_const(dq).view(), at, {alpha_, fetch});
  arcs_.ask(q, dq, fetch);
  const std::vector<double> none(model.envs, 0.0);
  Merit& m = merit_ = {none, none, none, none, none, none};
  for (std::size_t k = 0; k < at.gradients.size(); ++k) energy_rounding(at.gradients[k].view(), q, model.env_blocks, {m.rounding, fetch});
  if (c.n > 0) {
    device::Buffer<Vec3> Hdq;
    system_.potential.product(at, std::as_const(dq).view(), Hdq, !model.ties.driven());  // driven blocks have ways of their own
    dot(std::as_const(dq).view(), std::as_const(Hdq).view(), model.env_blocks, {m.curvature, fetch});
    dot(c, c, model.env_blocks, {m.cc, fetch});
    largest(c, model.env_blocks, {m.farthest, fetch});
  }
}

void LineSearch::begin(device::View<const Vec3> q, device::Buffer<Vec3>& dq, device::View<const Vec3> c, Linearised& at, EnvTable& envs,
                       device::Fetch& fetch, bool asked) {
  const model::Model& model = system_.model;
  for (bool done = false; !done;) {
    try {
      if (!std::exchange(asked, false)) ask(q, dq, c, at, fetch);
      fetch.now("way");
      done = true;
    } catch (const Failure& f) {  // of what supports prescribe: of one environment, without which it is tried again
      envs.fail(f.env, f.reason);
      clear_blocks(dq, model.env_blocks[f.env], model.env_blocks[f.env + 1]);
      if (!envs.any(EnvState::running)) return;
    }
  }
  EnvMask turn(model.envs, 0);
  for (Index e = 0; e < model.envs; ++e) turn[e] = envs.is(e, EnvState::running) && !(merit_.cc[e] > 0 && model.ties.driven());
  arcs_.begin(q, dq, turn, alpha_, at);
  system_.potential.reach(at);
}

Energies LineSearch::find_energies(Linearised& at, const EnvMask& whose, bool next, device::Fetch& fetch) {
  const model::Only only(system_.model, whose);
  Energies here;
  system_.potential.energies(std::as_const(trial_).view(), at, here, fetch);
  if (next) system_.potential.foresee(std::as_const(trial_).view(), at, fetch);
  fetch.now("trial energies");
  return here;
}

void LineSearch::end(device::Buffer<Vec3>& q, device::Buffer<Vec3>& dq, const std::vector<double>& slope, Linearised& at, EnvTable& envs,
                     const StepReports& report, const Forces& forces) {
  landed_ = false;
  if (!envs.any(EnvState::running)) return;
  const model::Model& model = system_.model;
  std::vector<double>& alpha = alpha_;
  Merit& merit = merit_;
  // rho makes the quadratic model of the merit decrease over the full step and its slope negative.
  merit.slope = slope;
  for (Index e = 0; e < model.envs; ++e) {
    if (!(merit.cc[e] > 0)) continue;
    merit.rho[e] = std::max(0.0, 2 * (2 * merit.slope[e] + merit.curvature[e]) / merit.cc[e]);
    merit.slope[e] -= merit.rho[e] * merit.cc[e];
  }
  for (Index e = 0; e < model.envs; ++e)
    if (!envs.is(e, EnvState::running) || (!forces.refused.empty() && forces.refused[e])) alpha[e] = 0;

  EnvMask searching(model.envs, 0);
  for (Index e = 0; e < model.envs; ++e) searching[e] = alpha[e] > 0;
  // Energies at q come with those of the first trial state.
  Energies there;
  std::vector<double> before;
  device::Fetch fetch;
  energies_.find(std::as_const(q).view(), at, fetch);
  const auto begin = [&] {
    energies_.begin_search(envs.mask(EnvState::running));
    there = energies_.known(), before = energies_.sum(there);
  };
  bool placed = false;  // trial_ is what alpha says
  const auto stay = [&](Index e) {
    alpha[e] = 0, searching[e] = 0, placed = false;
    for (std::size_t k = 0; k < there.size(); ++k) there[k][e] = energies_.known()[k][e];
  };
  const bool foresees = lands_;
  int k = 0;
  for (; any(searching); ++k) {
    arcs_.advance(std::as_const(q).view(), dq, alpha, trial_);
    placed = true;
    const Energies trial = find_energies(at, searching, k == 0 && foresees, fetch);
    if (k == 0) begin();
    for (std::size_t i = 0; i < trial.size(); ++i)
      for (Index e = 0; e < model.envs; ++e)
        if (searching[e]) there[i][e] = trial[i][e];
    std::vector<double> scale;
    const std::vector<double> after = energies_.sum(there, &scale);
    // What is tied is stiff in directions in which the weight of others acts: there rounding of positions shows in the energy before forces balance.
    // Where supports are on their way and meet nothing, all energy there is may be such rounding.
    const auto rounding = [&](Index e) { return tuning::kEnergyRounding * scale[e] + (model.ties.any() || merit.cc[e] > 0 ? merit.rounding[e] : 0); };
    const auto low_enough = [&](Index e) {
      const double left = (1 - alpha[e]) * (1 - alpha[e]);
      const double change = after[e] - before[e] + 0.5 * merit.rho[e] * (left - 1) * merit.cc[e];
      return std::isfinite(after[e]) && change <= tuning::kArmijo * alpha[e] * merit.slope[e] + rounding(e);
    };
    // A support that pushes a body into contact that no Hessian knows of yet has no finite rho beforehand: take the one for
    // which the shortened step is good enough, or the support would creep up to the range of the contact for ever.
    const auto pushes = [&](Index e) {
      return k >= tuning::kPushed && merit.farthest[e] > tuning::kPushing * envs[e].step && std::isfinite(after[e]);
    };
    // What only forces can say is asked in those environments in which it matters.
    const auto asked = [&](const auto& matters) {
      EnvMask out(model.envs, 0);
      for (Index e = 0; e < model.envs; ++e) out[e] = searching[e] && matters(e);
      return out;
    };
    const EnvMask far = asked([&](Index e) { return k == 0 && !forces.far.empty() && forces.far[e] && std::isfinite(after[e]); });
    const EnvMask astray = any(far) ? ask_of(model, far, [&](const EnvMask& whose) { return forces.astray(trial_, whose); }) : far;
    for (Index e = 0; e < model.envs; ++e)
      if (far[e] && astray[e]) stay(e), ++report[e].line_search;
    const EnvMask blind = asked([&](Index e) {
      return low_enough(e) && alpha[e] * std::abs(merit.slope[e]) <= rounding(e) && !(merit.cc[e] > 0) && k < tuning::kMostDoubts &&
             !forces.doubtful.empty() && forces.doubtful[e];
    });
    const std::vector<double> slope_there =
        any(blind) ? ask_of(model, blind, [&](const EnvMask& whose) { return forces.slope(trial_, whose); }) : std::vector<double>{};
    // So it does where all that is left is a vibration that has died away; how far it may be off is no reason to believe that it is.
    const auto says_nothing = [&](Index e) { return envs[e].unsymmetric() || alpha[e] * std::abs(merit.slope[e]) <= merit.rounding[e]; };
    const EnvMask higher =
        asked([&](Index e) { return !low_enough(e) && !pushes(e) && k == 0 && says_nothing(e) && forces.closer && std::isfinite(after[e]); });
    const EnvMask closer = any(higher) ? ask_of(model, higher, [&](const EnvMask& whose) { return forces.closer(trial_, whose); }) : higher;
    for (Index e = 0; e < model.envs; ++e) {
      if (!searching[e]) continue;
      const bool enough = blind[e]        ? slope_there[e] <= (1 - 2 * tuning::kArmijo) * std::abs(merit.slope[e])
                          : low_enough(e) ? true
                          : pushes(e)     ? true
                                          : higher[e] && closer[e];
      if (enough) {
        searching[e] = 0;
        continue;
      }
      placed = false;
      ++report[e].line_search;
      if (k < tuning::kMostHalvings) {
        alpha[e] *= 0.5;
      } else {
        // A direction that is not the energy's own may end in its rounding before its slope does.
        if (envs[e].unsymmetric())
          envs[e].state = EnvState::stuck;
        else
          envs.fail(e, "the line search found no descent");
        stay(e);
      }
    }
    arcs_.bend_again(std::as_const(q).view(), dq, searching, alpha, at);
  }
  if (k == 0) fetch.now("trial energies"), begin();
  lands_ = placed && k == 1;
  landed_ = lands_ && foresees;
  if (!placed) arcs_.advance(std::as_const(q).view(), dq, alpha, trial_);
  energies_.accept(std::move(there));
  for (Index e = 0; e < model.envs; ++e) {
    if (!envs.is(e, EnvState::running)) continue;
    envs[e].alpha = alpha[e], envs[e].energy = before[e];
    if (alpha[e] > 0) report[e].alpha = std::min(report[e].alpha, alpha[e]);
  }
  q.swap(trial_);
}

}  // namespace mortise::solver
