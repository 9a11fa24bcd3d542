#pragma once
// How far a Newton step goes, in every environment: q <- q + alpha (d + c), alpha from 1 down to what conservative CCD allows, then halved
// until Armijo's condition holds. While supports move (c, Newton's d + c below), it acts on the merit Phi + rho/2 |(1 - alpha) c|^2 with rho
// large enough that the direction descends: driving a support does work, so Phi alone may rise (Nocedal & Wright, 2nd ed., ch. 15.4; Li et al.
// 2020 use an augmented Lagrangian for the same purpose).
//
// Where what the slope promises is below the rounding of Phi (a light body beside a heavy one) and the iteration before gained little, the slope at
// the new state decides: phi'(alpha) <= (1 - 2 kArmijo) |phi'(0)|, which for a parabola is Armijo's condition (Hager, Zhang, SIAM J. Optim. 16, 2005,
// "approximate Wolfe").
#include <functional>

#include "solver/arcs.h"
#include "solver/energy_ledger.h"
#include "solver/system.h"

namespace mortise::solver {

class LineSearch {
 public:
  // What forces say of a trial state of some environments, with everything that is frozen or lags taken from that state itself.
  struct Forces {
    // Where they are closer to balance: the energy that is searched along the way of the whole Jacobian holds friction with the normal forces of the
    // iterate, and that of mortar contact its samples; it may rise although the way leads to the solution.
    std::function<EnvMask(const device::Buffer<Vec3>& trial, const EnvMask& whose)> closer;
    std::function<std::vector<double>(const device::Buffer<Vec3>& trial, const EnvMask& whose)> slope;  // along the way [J]
    EnvMask doubtful;  // where the iteration before gained little: the slope is asked for
    // Where they are so much farther from balance that the state is not taken at all, asked for where a full step leads far (loose_hold.h).
    std::function<EnvMask(const device::Buffer<Vec3>& trial, const EnvMask& whose)> astray;
    EnvMask far;
    EnvMask refused;  // where no step is taken
  };
  LineSearch(System& system, EnergyLedger& energies) : system_(system), energies_(energies), arcs_(system) {}

  // Moves q of the running environments along dq, from the state of `at`, in two halves. The first finds out how far dq may lead, brings `fetch`
  // with that, and readies `at`; c: what supports still have to move, none where empty. The second goes there; slope: gradient . dq [J]. Where
  // nothing descends the environment fails. asked: ask() was, with that fetch or an earlier one.
  void begin(device::View<const Vec3> q, device::Buffer<Vec3>& dq, device::View<const Vec3> c, Linearised& at, EnvTable& envs, device::Fetch& fetch,
             bool asked = false);
  void ask(device::View<const Vec3> q, device::Buffer<Vec3>& dq, device::View<const Vec3> c, Linearised& at, device::Fetch& fetch);
  void end(device::Buffer<Vec3>& q, device::Buffer<Vec3>& dq, const std::vector<double>& slope, Linearised& at, EnvTable& envs,
           const StepReports& report, const Forces& forces);
  // Did it go to a state that effects have foreseen?
  bool landed() const { return landed_; }

 private:
  // Of the merit, per environment: descent promised by the slope, what the supports add, and below what it says nothing. curvature: dq . H dq;
  // farthest: of the supports' ways that are left [m].
  struct Merit {
    std::vector<double> slope, rho, cc, rounding, curvature, farthest;
  };
  // At trial_, and what else `fetch` was asked for. next: and what the state is asked for when it is taken.
  Energies find_energies(Linearised& at, const EnvMask& whose, bool next, device::Fetch& fetch);

  System& system_;
  EnergyLedger& energies_;
  Arcs arcs_;
  std::vector<double> alpha_;           // per environment
  bool lands_ = true, landed_ = false;  // the last search ended at its first trial; and that one was foreseen
  Merit merit_;
  device::Buffer<Vec3> trial_;
};

}  // namespace mortise::solver
