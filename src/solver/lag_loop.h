#pragma once
// Quantities that effects freeze during Newton (friction's normal forces) belong to a state q_lag. Newton's minimiser with them is
// q = G(q_lag); wanted is the fixed point. Plain repetition q_lag <- q diverges where friction pushes the contact that causes it
// (steep flanks: mu tan(slope) > 1), often into a cycle of two states. So
//
//   q_lag <- q_lag + w r,   r = G(q_lag) - q_lag,   w <- clamp(-w (r_old . (r - r_old)) / |r - r_old|^2, 0.1, 1)
//
// per environment, from w = 1 (Aitken's relaxation: Kuttler, Wall, Comput. Mech. 43, 2008, eq. 44). The way from q_lag to q is
// cut short of contact like every step, so that contact forces exist at q_lag. There is no point in solving a round far beyond what refreshing
// changes.
#include "solver/system.h"
#include "solver/tuning.h"

namespace mortise::solver {

class LagLoop {
 public:
  LagLoop(System& system, double settled, bool lags);

  // The step starts at q, whose lagged quantities are held.
  void begin_solve(const device::Buffer<Vec3>& q);
  // The relative tolerance of the present round, and the one wanted in the end.
  double relative(Index env) const { return relative_[env]; }
  double wanted() const { return wanted_; }
  // What rounds are solved to at the finest: so closely are forces that do not lag known in the end.
  double finest() const;

  // The environment is solved to the present tolerance at q, where refreshed quantities leave `relative_residual` of the forces.
  void refreshed(Index env, double relative_residual);
  // Do its rounds come no nearer any more? Some run in circles, where sticking as well as slipping changes what it hangs on.
  bool idle(Index env) const { return idle_[env] >= tuning::kLagPatience; }
  // The state of the next round's lagged quantities in the environments of `whose`; elsewhere they are those of q, which `at` holds already.
  // `near`: work space.
  void relax(const device::Buffer<Vec3>& q, const EnvMask& whose, Linearised& near, Linearised& at);
  const device::Buffer<Vec3>& state() const { return q_; }  // q_lag
  // Lagged quantities in the environment are those of q after all.
  void restart(Index env, const device::Buffer<Vec3>& q);

 private:
  System& system_;
  const bool lags_;
  const double wanted_;
  Index round_ = 0;
  std::vector<double> relative_, relaxation_;  // per environment; w
  std::vector<double> nearest_;                // relative residual that refreshing left at best
  std::vector<Index> idle_;                    // rounds since then
  device::Buffer<Vec3> q_, move_, last_;       // q_lag, r, r_old
};

}  // namespace mortise::solver
