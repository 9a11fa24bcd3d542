#pragma once
// What an iterate says of how its environment goes on. Those that are solved to the present tolerance settle; those that get nowhere are stuck, and
// go back to where the residual was least: the coupled iteration converges only from nearby, and iterations that run in a circle may end anywhere on
// it. What has taken too many iterations, or is hopeless, fails.
#include <functional>

#include "solver/creep_watch.h"
#include "solver/energy_ledger.h"
#include "solver/linear.h"
#include "solver/progress_watch.h"
#include "solver/saddle_policy.h"
#include "solver/system.h"

namespace mortise::solver {

class Outlook {
 public:
  Outlook(System& system, Linear& linear, EnergyLedger& energies, SaddlePolicy& saddle);

  void begin();  // iterations with the present lagged quantities
  // The environments that run, at q with the residual r; `wanted`: the relative tolerance of each.
  void look(const Residual& r, Index iteration, const std::function<double(Index)>& wanted, EnvTable& envs, device::Buffer<Vec3>& q);
  double nearest(Index env) const { return nearest_force_[env]; }  // least residual of these iterations [N]

 private:
  void keep_nearest(Index env, double force, const device::Buffer<Vec3>& q);
  bool needs_jacobian(Index env, Index iteration, const Residual& r, double wanted, const EnvStatus& now);
  bool wants_coupled(Index env, Index iteration, const Residual& r, double wanted, const ProgressWatch::Sight& sight, const EnvStatus& now);

  System& system_;
  const Options& options_;
  Linear& linear_;
  EnergyLedger& energies_;
  SaddlePolicy& saddle_;
  CreepWatch creep_;
  ProgressWatch progress_;
  std::vector<double> nearest_force_;  // per environment: least residual of these iterations [N], and where it was
  device::Buffer<Vec3> nearest_q_;
};

}  // namespace mortise::solver
