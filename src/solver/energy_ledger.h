#pragma once
// The energies of a step, in every environment: what is known at the present iterate, and what the step gained from nowhere.
//
// Backward Euler loses energy where potentials are convex between the ends of a step. Where they are not (a body slips past an edge within one
// step, a contact opens on another side than it closed) a step can gain some, from nowhere. With M (v1 - v0)/dt = -grad Phi(q1) + supports,
// v1 = (q1 - q0)/dt, what a step gains over the work of supports and loads is exactly
//
//   gain = sum over stores [ Phi(q1) - Phi(q0) - grad Phi(q1) . (q1 - q0) ]  -  1/2 |v1 - v0|_M^2,
//
// and the last term is the energy of inertia at q1, as 1/2 |v0|_M^2 is that at q0. Supports and driven ties
// did the work of what they bear at q1 on their way, motors that of their forces at q1. Of smooth motion, this work is too large by about half of
// what these forces change by in a step, along the way of that step: of what is accelerated by 1/2 |v1 - v0|_M^2, of what is stretched by as much.
// BDF2 bounds no energy: with M a its force at q1, T(q1) - T(q0) - M a . (q1 - q0) stands in the place of the last term, and motors, supports and
// driven ties do the work of the mean of their forces at q0 and q1, or a force that falls along a smooth motion would seem to be a gain. A step of it
// that gains too much is taken anew by backward Euler, which is no less accurate where a body strikes or lets go.
// What steps lost lately they may gain back. Backward Euler, up to a share of what there is: what rolls over facets loses more where one touches than
// it gains while another lets go, and half steps there are no more accurate. BDF2, what its first step lost: after a step of first order velocities
// of what turns are those of half a step before, for which that step loses twice its share of energy. Refused it, a body that turns would take every
// other step by first order.
#include "base/archive.h"
#include "solver/envs.h"
#include "solver/potential.h"
#include "solver/tuning.h"

namespace mortise::solver {

// Of an environment [J].
struct StepEnergy {
  double gain = 0;            // what the integrator itself added
  double there = 0;           // energy that there was
  double work = 0;            // of supports, driven ties and motors
  double work_lag = 0;        // what that errs by in a step of first order, as forces change in it
  double in_doubt = 0;        // of what motors and supports did, in a step of second order
  double owed = 0;            // what steps lost lately, as far as this one may gain it
  bool second_order = false;  // the step
  // share: of what there was, that comes from nowhere.
  double may_gain(double share) const { return share * there + in_doubt + owed; }
};

class EnergyLedger {
 public:
  EnergyLedger(const model::Model& model, Potential& potential);

  void begin_solve() { known_.clear(), start_.clear(), took_part_.assign(model_.envs, 0), gone_ = started_ = took_part_; }
  // The environment is not where its energies are known any more.
  void forget(Index env) { gone_[env] = 1; }

  // Finds the energies at the present iterate q.
  void find(device::View<const Vec3> q, const Linearised& at, device::Fetch& fetch);
  const Energies& known() const { return known_; }
  // A way from the present iterate is about to be searched in the environments of `whose`.
  void begin_search(const EnvMask& whose);
  // The present iterate is now where energies are `there`. Of effects that freeze something, they are a matter of one iteration.
  void accept(Energies&& there);

  // Per environment: the sum over all effects [J]; scale: of magnitudes.
  std::vector<double> sum(const Energies& of, std::vector<double>* scale = nullptr) const;

  // The step ends at q, which is the present iterate.
  void close(device::View<const Vec3> q, const Linearised& at);
  // The environments of `whose` accept the state that `at` was filled at.
  void accept(const EnvMask& whose, const Linearised& at);
  void checkpoint(Archive& archive);
  // Should every step lose energy? Only then it is measured.
  bool measures() const { return measures_; }
  const StepEnergy& of_step(Index env) const { return step_[env]; }
  double total(Index env) const { return total_[env]; }  // Phi at the end [J]

 private:
  const model::Model& model_;
  Potential& potential_;
  bool measures_ = false;
  Energies known_, start_;              // at the present iterate; where the step begins
  EnvMask took_part_, started_, gone_;  // started_: energies are known where the step begins
  std::vector<StepEnergy> step_;
  std::vector<double> total_;
  // What does work: motors, supports and driven ties; and, of the latter, what accelerates bodies that go where the scene says.
  enum Driver { motors, supports, ties, given };
  void gradient_of(Driver driver, const Linearised& at, device::Buffer<Vec3>& sum) const;  // that it does its work against [N]
  std::vector<Driver> drivers_;
  bool remembers_ = false;        // something drives, so that its forces are known at both ends of a step:
  device::Buffer<Vec3> last_[4];  // drivers' gradients at the last accepted state [N]
  std::vector<double> lately_;    // energy there was lately: drivers take and bring it, and at every turn there is next to none [J]
  // What steps lost lately and did not gain back [J]: all, and the first of second order, -1 after one of first order.
  std::vector<double> owed_, owed_second_;
};

// A step that makes energy from nowhere is tried again with half its length, as long as the gain falls to about a quarter, as that of backward
// Euler does; after one try in vain no more of this step.
class EnergyGuard {
 public:
  // allowed: share of the energy there is, that may be gained.
  bool wants_halving(const StepEnergy& e, double allowed);
  void accepted() { last_ = INFINITY; }
  // After an accepted step: is one of twice its length worth a try? It gains four times as much.
  bool lets_double(const StepEnergy& e, double allowed) const {
    return !helps_ || e.second_order || !(tuning::kGainGrows * e.gain > e.may_gain(allowed));
  }

 private:
  double last_ = INFINITY;  // of the step of twice the length [J]
  bool helps_ = true;
};

}  // namespace mortise::solver
