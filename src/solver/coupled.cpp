#include "solver/coupled.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "linalg/gmres.h"
#include "solver/kernels.h"
#include "solver/timed.h"
#include "solver/tuning.h"

namespace mortise::solver {
// M of the frozen Hessian at q, without negative curvature.
void Coupled::factor(const device::Buffer<Vec3>& q, const EnvMask& whose, Linearised& at) {
  EnvMask wanted = whose;
  // What keeps no factors would feel that a neighbour has the matrix assembled anew.
  for (std::size_t e = 0; e < wanted.size(); ++e) wanted[e] = active_[e] && !(factored_[e] && linear_.keeps_factors());
  if (!any(wanted)) return;
  system_.linearise(q.view(), {true, curvature_.wanted()}, at);
  device::Fetch fetch;
  system_.matrix(at, q.view(), wanted, A_, fetch, fetch);
  fetch.now("coupled");
  const std::vector<double> none(wanted.size(), 0.0);
  const EnvMask good = linear_.prepare({A_, {}, {}, none, none, q.view()}, wanted);
  for (std::size_t e = 0; e < wanted.size(); ++e) {
    if (!wanted[e]) continue;
    factored_[e] = good[e];
    if (!good[e]) active_[e] = 0;
  }
}

// dq_ along which the residual of `at` vanishes to first order.
void Coupled::direction(const device::Buffer<Vec3>& q, Linearised& at, const StepReports& report, const std::function<void()>& stop) {
  system_.potential.linearise(q.view(), effects::Want::jacobian(effects::Curvature(true, 1)), at, true);
  system_.right_hand_side(at, {}, r0_);
  clear_envs(r0_, active_, 0, system_.rows.env);
  x_.resize(system_.rows.count());
  std::optional<model::Only> only;
  const linalg::GmresResult gmres = linalg::gmres(
      system_.jacobian(at, false), linalg::awaited([&](device::View<const Vec3> in, device::View<Vec3> out) { linear_.apply(A_, in, out, active_); }),
      std::as_const(r0_).view(), x_.view(), system_.rows.env, std::vector<double>(system_.model.envs, tuning::kCoupledForcing), tuning::kMostProducts,
      [&](const EnvMask& going) {
        stop();
        only.reset();
        only.emplace(system_.model, going);
      });
  only.reset();
  for (Index e = 0; e < system_.model.envs; ++e)
    if (active_[e]) report[e].cg += gmres.of_env[e];
  products_ = gmres.of_env;
  for (Index e = 0; e < system_.model.envs; ++e) factored_[e] = gmres.of_env[e] <= tuning::kGoodProducts;
  system_.to_blocks(std::as_const(x_).view(), std::as_const(still_).view(), active_, dq_);
}

// |M^-1 r|^2 of every environment.
std::vector<double> Coupled::natural_level(const Linearised& at) {
  device::Buffer<Vec3> r, z(system_.rows.count());
  system_.right_hand_side(at, {}, r);
  linear_.apply(A_, std::as_const(r).view(), z.view(), active_);
  return dot(std::as_const(z).view(), std::as_const(z).view(), system_.rows.env);
}

// Takes a step along dq_ that lowers the level of every active environment, and the residual r with it; those where there is none give up.
void Coupled::monotone_step(device::Buffer<Vec3>& q, Residual& r, Linearised& at, Linearised& near, EnvTable& envs, const StepReports& report) {
  const model::Model& model = system_.model;
  std::vector<double> alpha(model.envs, 1.0);
  device::Fetch fetch;
  system_.potential.max_step(std::as_const(dq_).view(), at, {alpha, fetch});
  arcs_.ask(std::as_const(q).view(), dq_, fetch);
  fetch.now("coupled");
  arcs_.begin(std::as_const(q).view(), dq_, active_, alpha, at);
  system_.potential.reach(at);
  for (Index e = 0; e < model.envs; ++e)
    if (!active_[e]) alpha[e] = 0;
  const std::vector<double> before = natural_level(at);
  for (int k = 1; any(active_); ++k) {
    arcs_.advance(std::as_const(q).view(), dq_, alpha, trial_);
    const EnvMask finite = finite_energies(at);
    std::vector<double> after(model.envs, INFINITY);
    Residual next;
    if (any(finite)) {
      next = system_.linearise(std::as_const(trial_).view(), {}, near, true);
      after = natural_level(near);
    }
    EnvMask again(model.envs, 0);
    for (Index e = 0; e < model.envs; ++e) {
      const double level = 1 - tuning::kNaturalShare * alpha[e];
      if (alpha[e] == 0 || (finite[e] && system_.convergence.finite(next, e) && after[e] <= level * level * before[e])) continue;
      alpha[e] *= 0.5;
      again[e] = 1;
    }
    if (!any(again)) {
      for (Index e = 0; e < model.envs; ++e) {
        if (!active_[e]) continue;
        envs[e].alpha = alpha[e];
        report[e].alpha = std::min(report[e].alpha, alpha[e]);
      }
      q.swap(trial_);
      r = next;
      return;
    }
    for (Index e = 0; e < model.envs; ++e) {
      report[e].line_search += again[e];
      if (again[e] && k >= tuning::kMonotoneTries) active_[e] = 0, alpha[e] = 0;
    }
    arcs_.bend_again(std::as_const(q).view(), dq_, again, alpha, at);
  }
}

// Where the energies at trial_ are finite, of the active environments.
EnvMask Coupled::finite_energies(const Linearised& at) {
  Energies energies;
  device::Fetch fetch;
  system_.potential.energies(std::as_const(trial_).view(), at, energies, fetch);
  fetch.now("coupled");
  EnvMask out = active_;
  for (std::size_t e = 0; e < out.size(); ++e) {
    double sum = 0;
    for (const std::vector<double>& part : energies) sum += part[e];
    if (!std::isfinite(sum)) out[e] = 0;
  }
  return out;
}

void Coupled::solve(device::Buffer<Vec3>& q, double relative, Linearised& at, Linearised& near, EnvTable& envs, const StepReports& report,
                    const std::function<void()>& stop, const Watch& watch) {
  const model::Model& model = system_.model;
  still_.resize(model.blocks);
  still_.zero();
  active_ = envs.mask(EnvState::stuck);
  factored_.assign(model.envs, 0);
  std::vector<Index> short_steps(model.envs, 0);  // in a row
  for (Index e = 0; e < model.envs; ++e) {
    if (!active_[e]) continue;
    factored_[e] = linear_.ready(e);
    curvature_.make_convex(e);
  }
  std::optional<model::Only> only(std::in_place, model, active_);
  const auto narrow = [&] {  // the last to give up leaves its state as it is
    if (any(active_)) only.reset(), only.emplace(model, active_);
  };
  Residual r = system_.linearise(q.view(), {}, at, true);
  for (Index e = 0; e < model.envs; ++e)
    if (active_[e] && !system_.convergence.finite(r, e)) envs.fail(e, system_.not_finite(at, e)), active_[e] = 0;
  for (Index it = 0; it < tuning::kCoupledIterations; ++it) {
    stop();
    watch.begin(r, it, active_);
    for (Index e = 0; e < model.envs; ++e) {
      if (!active_[e]) continue;
      if (const std::string gone = system_.gone_for_good(r, e); !gone.empty())
        envs.fail(e, gone), active_[e] = 0;
      else if (system_.solved(r, e, relative, envs[e].step))
        envs[e].state = EnvState::solved, active_[e] = 0;
    }
    if (!any(active_)) return;
    narrow();
    factor(q, active_, at);
    if (!any(active_)) return;
    narrow();
    const Timed timed(system_.clock, "solver", "coupled");
    direction(q, at, report, stop);
    std::vector<double> longest(model.envs, 0.0);
    device::Fetch fetch;
    system_.convergence.see_step(std::as_const(dq_).view(), r, active_, fetch);
    largest(std::as_const(dq_).view(), model.env_blocks, {longest, fetch});
    fetch.now("coupled");
    std::vector<double> before(model.envs);
    for (Index e = 0; e < model.envs; ++e) {
      before[e] = system_.convergence.largest_force(r, e);
      if (!active_[e]) continue;
      envs[e].step = longest[e];
      if (!std::isfinite(longest[e])) active_[e] = 0, clear_blocks(dq_, model.env_blocks[e], model.env_blocks[e + 1]);
    }
    narrow();
    monotone_step(q, r, at, near, envs, report);
    narrow();
    system_.linearise(q.view(), {}, at, true);
    if (!any(active_)) return;
    for (Index e = 0; e < model.envs; ++e) {
      if (!active_[e]) continue;
      ++report[e].newton;
      envs[e].force = before[e];
      if (envs[e].alpha != 1) factored_[e] = 0;
      short_steps[e] = envs[e].alpha < tuning::kShort ? short_steps[e] + 1 : 0;
    }
    watch.end(active_, products_);
    for (Index e = 0; e < model.envs; ++e)
      if (short_steps[e] >= tuning::kMostShort) active_[e] = 0;
  }
}

}  // namespace mortise::solver
