#pragma once
// Where Newton's method starts in a step. Beginning where the last step ended, all that moves evenly - what flies, what creeps under friction - would
// be brought to rest and set in motion again. Instead it starts where inertia alone would carry everything in this step, q^, in the environments
// where nothing is met on the way there and the potential is lower.
#include "solver/energy_ledger.h"
#include "solver/system.h"

namespace mortise::solver {

class FirstGuess {
 public:
  FirstGuess(System& system, EnergyLedger& energies) : system_(system), energies_(energies) {}

  // q is where the step begins, and `at` linearised there; moves q in the environments of `whose`.
  void find(const EnvMask& whose, device::Buffer<Vec3>& q, Linearised& at);

 private:
  System& system_;
  EnergyLedger& energies_;
  device::Buffer<Vec3> way_, trial_;
};

}  // namespace mortise::solver
