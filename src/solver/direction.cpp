#include "solver/direction.h"

#include <cmath>
#include <optional>

#include "solver/kernels.h"
#include "solver/timed.h"

namespace mortise::solver {

void Direction::foresee(const Linearised& at, device::Fetch& fetch) {
  system_.right_hand_side(at, {}, rhs_);
  rhs2_.assign(system_.model.envs, 0.0);
  dot(std::as_const(rhs_).view(), std::as_const(rhs_).view(), system_.rows.env, {rhs2_, fetch});
  foreseen_ = true;
}

// x_ of the environments of `todo`. What is not needed for it comes with the fetch of `aside`.
void Direction::solve(const device::Buffer<Vec3>& q, const std::vector<double>& wanted, EnvMask todo, bool whole, Linearised& at, EnvTable& envs,
                      const StepReports& report, Aside& aside) {
  while (any(todo)) {
    aside.done = false;
    std::optional<model::Only> only(std::in_place, system_.model, todo);
    device::Buffer<Vec3> Jc, Uc;
    if (supports_move_) {
      system_.potential.product(at, std::as_const(support_).view(), Jc);
      if (whole) system_.potential.unsymmetric_product(at, false, std::as_const(support_).view(), Uc), add(std::as_const(Uc).view(), Jc);
    }
    device::Fetch fetch;
    if (supports_move_ || !foreseen_) {
      system_.right_hand_side(at, std::as_const(Jc).view(), rhs_);
      rhs2_.assign(envs.size(), 0.0);
      dot(std::as_const(rhs_).view(), std::as_const(rhs_).view(), system_.rows.env, {rhs2_, fetch});
    }
    system_.matrix(at, q.view(), todo, matrix_, fetch, aside.fetch);
    fetch.now("right-hand side");
    clear_envs(x_, todo, 1, system_.rows.env);
    {
      const Timed timed(system_.clock, "solver", "linear_solve");
      const linalg::Operator J = system_.whole(at, matrix_);
      todo =
          linear_.solve({matrix_, std::as_const(rhs_).view(), x_.view(), rhs2_, wanted, q.view(), whole ? &J : nullptr, aside.ask ? &aside : nullptr},
                        todo, curvature_, envs, report);
    }
    if (!any(todo)) break;
    only.reset();
    for (Index e = 0; e < envs.size(); ++e)
      if (todo[e]) curvature_.soften(e), ++report[e].softened;
    foreseen_ = false;
    system_.potential.linearise(q.view(), want(envs), at);
  }
}

effects::Want Direction::want(const EnvTable& envs) {
  bool whole = false;
  EnvMask moving(envs.size(), 0);
  for (Index e = 0; e < envs.size(); ++e) {
    if (!envs.is(e, EnvState::running)) continue;
    moving[e] = envs[e].moving;
    whole = whole || envs[e].unsymmetric();
  }
  effects::Want out{true, curvature_.wanted(), whole};
  if (!any(moving)) return out;
  if (envs.size() == 1) return out.moving = true, out;
  moving_.upload(moving);
  out.moving = effects::Moving(std::as_const(moving_).view());
  return out;
}

bool Direction::begin(const device::Buffer<Vec3>& q, const Residual& r, const std::vector<double>& wanted, Linearised& at, EnvTable& envs,
                      const StepReports& report, device::Fetch& fetch, const std::function<void(device::Fetch&)>& ask) {
  system_.supports(q.view(), support_);
  supports_move_ = largest_of(r.support_gap) > 0;
  x_.resize(system_.rows.count());
  EnvMask plain = envs.mask(EnvState::running), whole = plain;
  for (Index e = 0; e < envs.size(); ++e) (envs[e].unsymmetric() ? plain : whole)[e] = 0;
  const auto measure = [&](device::Fetch& fetch) {
    measured_ = envs.mask(EnvState::running);
    longest_.assign(envs.size(), 0.0);
    carry(at, envs, fetch);
    largest(std::as_const(dq_).view(), system_.model.env_blocks, {longest_, fetch});
    system_.convergence.see_step(std::as_const(dq_).view(), r, measured_, fetch);
    clear_not_finite(dq_);  // the host hears of it after others have asked how far it may lead
  };
  // A failure of what is asked is that of the only environment; several are asked when all have their ways.
  Aside aside{fetch, {}};
  if (ask && envs.size() == 1) aside.ask = [&](device::Fetch& now) { measure(now), ask(now); };
  solve(q, wanted, plain, false, at, envs, report, aside);
  bool measured = aside.done;
  while (any(whole)) {
    solve(q, wanted, whole, true, at, envs, report, aside);
    if (aside.ask && !aside.done)
      aside.ask(fetch), aside.done = true;
    else if (!aside.done)
      measure(fetch);
    fetch.now("slope");
    // Uphill: with less negative curvature, and without any by its symmetric part alone.
    EnvMask uphill = whole, symmetric(envs.size(), 0);
    for (Index e = 0; e < envs.size(); ++e) {
      uphill[e] = whole[e] && envs.is(e, EnvState::running) && r.support_gap[e] == 0 && !(slope_[e] < 0);
      if (!uphill[e]) continue;
      if (curvature_.concavity(e) == 0) symmetric[e] = 1, uphill[e] = 0;
      curvature_.soften(e);
    }
    for (Index e = 0; e < envs.size(); ++e) report[e].softened += uphill[e];
    if (any(uphill)) system_.potential.linearise(q.view(), want(envs), at);
    measured = !any(uphill) && !any(symmetric);
    if (any(symmetric)) {
      solve(q, wanted, symmetric, false, at, envs, report, aside);
      measured = aside.done;
    }
    whole = uphill;
  }
  if (!measured) measure(fetch);
  foreseen_ = false;
  return aside.done;
}

void Direction::end(EnvTable& envs) {
  for (Index e = 0; e < envs.size(); ++e) {
    if (!measured_[e] || !envs.is(e, EnvState::running)) continue;
    envs[e].step = longest_[e];
    if (std::isfinite(longest_[e])) continue;
    envs.fail(e, "the Newton direction is not finite");
    clear_blocks(dq_, system_.model.env_blocks[e], system_.model.env_blocks[e + 1]);
  }
}

// From x_ to dq_ and its slope.
void Direction::carry(const Linearised& at, const EnvTable& envs, device::Fetch& fetch) {
  system_.to_blocks(std::as_const(x_).view(), std::as_const(support_).view(), envs.mask(EnvState::running), dq_);
  std::vector<double> more;  // of its own length
  for (Index e = 0; e < envs.size(); ++e) more.push_back(envs.is(e, EnvState::running) ? envs[e].stretch - 1 : 0);
  const bool other = std::any_of(more.begin(), more.end(), [](double m) { return m != 0; });
  if (!supports_move_ && other) add_scaled(std::as_const(dq_).view(), more, std::as_const(system_.model.block_env).view(), dq_);
  slope_.assign(envs.size(), 0.0);
  dot(std::as_const(at.gradient).view(), std::as_const(dq_).view(), system_.model.env_blocks, {slope_, fetch});
  if (!system_.model.ties.driven()) return;
  // What acts on tied blocks is not in `at.gradient`: of driven ones it has a way of its own.
  offset_.resize(system_.model.blocks);
  offset_.zero();
  system_.model.ties.add_offset_of(std::as_const(support_).view(), offset_.view());
  clear_envs(offset_, envs.mask(EnvState::running), 0, system_.model.env_blocks);
  for (const device::Buffer<Vec3>& g : at.gradients) dot(g.view(), std::as_const(offset_).view(), system_.model.env_blocks, {slope_, fetch});
}

}  // namespace mortise::solver
