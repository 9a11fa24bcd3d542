// Quantities that effects freeze during Newton (friction's normal forces) belong to a state q_lag. Newton's minimiser with them is
// q = G(q_lag); wanted is the fixed point. Plain repetition q_lag <- q diverges where friction pushes the contact that causes it
// (steep flanks: mu tan(slope) > 1), often into a cycle of two states. So
//
//   q_lag <- q_lag + w r,   r = G(q_lag) - q_lag,   w <- clamp(-w (r_old . (r - r_old)) / |r - r_old|^2, 0.1, 1)
//
// per environment, from w = 1 (Aitken's relaxation: Kuttler, Wall, Comput. Mech. 43, 2008, eq. 44). The way from q_lag to q is
// cut short of contact like every step, so that contact forces exist at q_lag.
#include <algorithm>

#include "solver/kernels.h"
#include "solver/newton.h"
#include "solver/timed.h"

namespace mortise::solver {

// Freezes at q; false if no effect has anything to freeze.
bool Newton::refresh_lagged(device::View<const Vec3> q) {
  bool any = false;
  for (const auto& effect : effects_) {
    const Timed timed(clock_, effect->name(), "lag");
    any |= effect->lag(q);
  }
  return any;
}

void Newton::relax_lagged(Index round) {
  constexpr double kLeast = 0.1;
  subtract(q_.view(), lag_q_.view(), lag_move_);
  if (round > 0) {
    device::Buffer<Vec3> change;
    subtract(lag_move_.view(), lag_last_.view(), change);
    std::vector<double> along(model_.envs, 0.0), square(model_.envs, 0.0);
    device::Fetch fetch;
    dot(lag_last_.view(), change.view(), model_.env_blocks, {along, fetch});
    dot(change.view(), change.view(), model_.env_blocks, {square, fetch});
    fetch.now();
    for (Index e = 0; e < model_.envs; ++e)
      if (square[e] > 0) lag_share_[e] = std::clamp(-lag_share_[e] * along[e] / square[e], kLeast, 1.0);
  }
  lag_last_.copy_from(lag_move_);
  if (*std::min_element(lag_share_.begin(), lag_share_.end()) == 1) {  // frozen at q already
    lag_q_.copy_from(q_);
    return;
  }
  std::vector<double> share = lag_share_;
  device::Fetch fetch;
  for (const auto& effect : effects_) effect->max_step(lag_q_.view(), lag_move_.view(), {share, fetch});
  fetch.now();
  add_scaled(lag_move_.view(), share, std::as_const(model_.block_env).view(), lag_q_);
  refresh_lagged(lag_q_.view());
}

}  // namespace mortise::solver
