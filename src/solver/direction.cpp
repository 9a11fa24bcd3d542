#include "solver/direction.h"

#include <cmath>

#include "solver/kernels.h"
#include "solver/timed.h"

namespace mortise::solver {

void Direction::find(const device::Buffer<Vec3>& q, const Residual& r, const std::vector<double>& wanted, Linearised& at, EnvTable& envs, StepReport& report) {
  const model::Model& model = system_.model;
  system_.supports(q.view(), support_);
  supports_move_ = largest_of(r.support_gap) > 0;
  x_.resize(system_.rows.count());
  for (EnvMask todo = envs.mask(EnvState::running); any(todo);) {
    device::Fetch fetch;
    system_.matrix(at, q.view(), todo, matrix_, fetch);
    device::Buffer<Vec3> Hc;
    if (supports_move_) system_.potential.product(at, std::as_const(support_).view(), Hc);
    system_.right_hand_side(at, std::as_const(Hc).view(), rhs_);
    std::vector<double> rhs2(envs.size(), 0.0);
    dot(std::as_const(rhs_).view(), std::as_const(rhs_).view(), system_.rows.env, {rhs2, fetch});
    fetch.now();
    for (Index e = 0; e < envs.size(); ++e)
      if (todo[e]) clear_blocks(x_, system_.rows.env[e], system_.rows.env[e + 1]);
    {
      const Timed timed(system_.clock, "solver", "linear_solve");
      todo = linear_.solve({matrix_, std::as_const(rhs_).view(), x_.view(), rhs2, wanted, q.view()}, todo, curvature_, envs, report);
    }
    if (!any(todo)) break;
    for (Index e = 0; e < envs.size(); ++e)
      if (todo[e]) curvature_.soften(e);
    ++report.softened;
    system_.potential.linearise(q.view(), {true, curvature_.wanted()}, at);
  }
  const EnvMask running = envs.mask(EnvState::running);
  system_.to_blocks(std::as_const(x_).view(), std::as_const(support_).view(), running, dq_);
  std::vector<double> longest(envs.size(), 0.0);
  slope_.assign(envs.size(), 0.0);
  device::Fetch fetch;
  largest(std::as_const(dq_).view(), model.env_blocks, {longest, fetch});
  system_.convergence.see_step(std::as_const(dq_).view(), r, running, fetch);
  dot(std::as_const(at.gradient).view(), std::as_const(dq_).view(), model.env_blocks, {slope_, fetch});
  fetch.now();
  for (Index e = 0; e < envs.size(); ++e) {
    if (!running[e]) continue;
    envs[e].step = longest[e];
    if (std::isfinite(longest[e])) continue;
    envs.fail(e, "the Newton direction is not finite");
    clear_blocks(dq_, model.env_blocks[e], model.env_blocks[e + 1]);
  }
}

}  // namespace mortise::solver
