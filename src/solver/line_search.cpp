#include "solver/line_search.h"

#include <algorithm>
#include <cmath>

#include "solver/kernels.h"
#include "solver/tuning.h"

namespace mortise::solver {

LineSearch::Merit LineSearch::begin(device::View<const Vec3> q, device::Buffer<Vec3>& dq, const std::vector<double>& slope,
                                    device::View<const Vec3> c, Linearised& at, EnvTable& envs, std::vector<double>& alpha) {
  const model::Model& model = system_.model;
  device::Fetch fetch;
  system_.potential.max_step(std::as_const(dq).view(), at, {alpha, fetch});
  energies_.find(q, at, fetch);
  const std::vector<double> none(model.envs, 0.0);
  Merit m{slope, none, none, none, none};
  // What is tied is stiff in directions in which the weight of others acts: there rounding of positions shows in the energy before forces balance.
  for (std::size_t k = 0; k < at.gradients.size() && model.ties.any(); ++k)
    energy_rounding(at.gradients[k].view(), q, model.env_blocks, {m.rounding, fetch});
  std::vector<double> curvature = none;
  if (c.n > 0) {
    device::Buffer<Vec3> Hdq;
    system_.potential.product(at, std::as_const(dq).view(), Hdq, !model.ties.driven());  // driven blocks have ways of their own
    dot(std::as_const(dq).view(), std::as_const(Hdq).view(), model.env_blocks, {curvature, fetch});
    dot(c, c, model.env_blocks, {m.cc, fetch});
    largest(c, model.env_blocks, {m.farthest, fetch});
  }
  fetch.now();
  energies_.begin_search(envs.mask(EnvState::running));
  // rho makes the quadratic model of the merit decrease over the full step and its slope negative.
  for (Index e = 0; e < model.envs; ++e) {
    if (!(m.cc[e] > 0)) continue;
    m.rho[e] = std::max(0.0, 2 * (2 * m.slope[e] + curvature[e]) / m.cc[e]);
    m.slope[e] -= m.rho[e] * m.cc[e];
  }
  return m;
}

void LineSearch::step(device::Buffer<Vec3>& q, device::Buffer<Vec3>& dq, const std::vector<double>& slope, device::View<const Vec3> c, Linearised& at,
                      EnvTable& envs, const StepReports& report, const Forces& forces) {
  const model::Model& model = system_.model;
  std::vector<double> alpha;
  Merit merit;
  for (bool done = false; !done;) {
    alpha.assign(model.envs, 1.0);
    try {
      merit = begin(std::as_const(q).view(), dq, slope, c, at, envs, alpha);
      done = true;
    } catch (const Failure& f) {  // of what supports prescribe: of one environment, without which it is tried again
      envs.fail(f.env, f.reason);
      clear_blocks(dq, model.env_blocks[f.env], model.env_blocks[f.env + 1]);
      energies_.forget(f.env);
      if (!envs.any(EnvState::running)) return;
    }
  }
  const std::vector<double> before = energies_.sum(energies_.known());
  for (Index e = 0; e < model.envs; ++e)
    if (!envs.is(e, EnvState::running)) alpha[e] = 0;

  EnvMask far_enough(model.envs, 0);
  for (int k = 0;; ++k) {
    advance(std::as_const(q).view(), std::as_const(dq).view(), alpha, model, trial_);
    Energies there;
    device::Fetch fetch;
    system_.potential.energies(std::as_const(trial_).view(), at, there, fetch);
    fetch.now();
    std::vector<double> scale_there;
    const std::vector<double> after = energies_.sum(there, &scale_there);
    bool ok = true;
    EnvMask closer, astray;           // once looked at,
    std::vector<double> slope_there;  // once asked for
    for (Index e = 0; e < model.envs; ++e) {
      if (alpha[e] == 0 || far_enough[e]) continue;
      far_enough[e] = 1;  // unless what follows says otherwise
      const double left = (1 - alpha[e]) * (1 - alpha[e]);
      const double change = after[e] - before[e] + 0.5 * merit.rho[e] * (left - 1) * merit.cc[e];
      const double rounding = tuning::kEnergyRounding * scale_there[e] + merit.rounding[e];
      if (k == 0 && !forces.far.empty() && forces.far[e] && std::isfinite(after[e])) {
        if (astray.empty()) astray = forces.astray(trial_);
        if (astray[e]) {
          alpha[e] = 0;
          ok = false;
          ++report[e].line_search;
          continue;
        }
      }
      if (std::isfinite(after[e]) && change <= tuning::kArmijo * alpha[e] * merit.slope[e] + rounding) {
        const bool blind = alpha[e] * std::abs(merit.slope[e]) <= rounding && !(merit.cc[e] > 0) && k < tuning::kMostDoubts;
        if (!blind || forces.doubtful.empty() || !forces.doubtful[e]) continue;
        if (slope_there.empty()) slope_there = forces.slope(trial_);
        if (slope_there[e] <= (1 - 2 * tuning::kArmijo) * std::abs(merit.slope[e])) continue;
      } else if (k >= tuning::kPushed && merit.farthest[e] > tuning::kPushing * envs[e].step && std::isfinite(after[e])) {
        // A support that pushes a body into contact that no Hessian knows of yet has no finite rho beforehand: take the one for
        // which the shortened step is good enough, or the support would creep up to the range of the contact for ever.
        continue;
      } else if (k == 0 && envs[e].whole && forces.closer && std::isfinite(after[e])) {
        if (closer.empty()) closer = forces.closer(trial_);
        if (closer[e]) continue;
      }
      ok = false;
      far_enough[e] = 0;
      ++report[e].line_search;
      if (k < tuning::kMostHalvings) {
        alpha[e] *= 0.5;
      } else {
        // A direction that is not the energy's own may end in its rounding before its slope does.
        if (envs[e].whole)
          envs[e].state = EnvState::stuck;
        else
          envs.fail(e, "the line search found no descent");
        alpha[e] = 0;
      }
    }
    if (ok) {
      energies_.accept(std::move(there));
      break;
    }
  }
  for (Index e = 0; e < model.envs; ++e) {
    if (!envs.is(e, EnvState::running)) continue;
    envs[e].alpha = alpha[e], envs[e].energy = before[e];
    if (alpha[e] > 0) report[e].alpha = std::min(report[e].alpha, alpha[e]);
  }
  q.swap(trial_);
}

}  // namespace mortise::solver
