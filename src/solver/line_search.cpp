#include <algorithm>
#include <cmath>

#include "solver/kernels.h"
#include "solver/newton.h"
#include "solver/timed.h"

namespace mortise::solver {

// Returns the shortest accepted step.
double Newton::line_search(StepReport& report, const Residual& r, double relative, bool supports_move) {
  constexpr double kArmijo = 1e-4;
  constexpr int kMost = 40;
  std::vector<double> alpha(model_.envs, 1.0);
  device::Fetch fetch;
  for (const auto& effect : effects_) {
    const Timed timed(clock_, effect->name(), "max_step");
    effect->max_step(q_.view(), dq_.view(), {alpha, fetch});
  }
  find_energies(q_.view(), known_, fetch);
  std::vector<double> slope = slope_, rho(model_.envs, 0.0), cc(model_.envs, 0.0), curvature(model_.envs, 0.0);
  if (supports_move) {
    device::Buffer<Vec3> Hdq;
    for (linalg::StencilSet* set : sets_) stencil_product(*set, dq_.view());
    assembler_.gradient(sets_, model_.blocks, Hdq);
    dot(dq_.view(), Hdq.view(), model_.env_blocks, {curvature, fetch});
    dot(support_.view(), support_.view(), model_.env_blocks, {cc, fetch});
  }
  fetch.now();
  if (start_.empty()) start_ = known_;
  const std::vector<double> before = sum(known_);
  if (supports_move) {
    // rho makes the quadratic model of the merit decrease over the full step and its slope negative.
    for (Index e = 0; e < model_.envs; ++e) {
      if (!(cc[e] > 0)) continue;
      rho[e] = std::max(0.0, 2 * (2 * slope[e] + curvature[e]) / cc[e]);
      slope[e] -= rho[e] * cc[e];
    }
  }
  for (Index e = 0; e < model_.envs; ++e)
    if (model_.envs > 1 && convergence_.solved(r, e, relative) && r.support_gap[e] == 0) alpha[e] = 0;

  for (int k = 0;; ++k) {
    advance(q_.view(), dq_.view(), alpha, model_, trial_);
    Energies there;
    find_energies(trial_.view(), there, fetch);
    fetch.now();
    const std::vector<double> after = sum(there);
    bool ok = true;
    for (Index e = 0; e < model_.envs; ++e) {
      if (alpha[e] == 0) continue;
      const double left = (1 - alpha[e]) * (1 - alpha[e]);
      const double change = after[e] - before[e] + 0.5 * rho[e] * (left - 1) * cc[e];
      const double rounding = 1e-13 * energy_scale_[e];
      if (std::isfinite(after[e]) && change <= kArmijo * alpha[e] * slope[e] + rounding) continue;
      // A support that pushes a body into contact that no Hessian knows of yet has no finite rho beforehand: take the one for
      // which the shortened step is good enough, or the support would creep up to the range of the contact for ever.
      if (k >= 2 && cc[e] > 0 && std::isfinite(after[e])) continue;
      alpha[e] *= 0.5;
      ok = false;
    }
    if (ok) {
      remember(std::move(there));
      break;
    }
    ++report.line_search;
    if (k == kMost) throw Failure{"the line search found no descent"};
  }
  double least = 1;
  for (double a : alpha)
    if (a > 0) least = std::min(least, a);
  report.alpha = std::min(report.alpha, least);
  q_.swap(trial_);
  return least;
}

}  // namespace mortise::solver
