#pragma once
// Where Newton's method starts in a step. Beginning where the last step ended, all that moves evenly - what flies, what creeps under friction - would
// be brought to rest and set in motion again. Instead it starts where inertia alone would carry everything in this step, q^, and with supports where
// they are to be, in the environments where nothing is met on the way there and the potential is lower; where supports move, lower than with them
// alone moved, as they do work. Where supports are in the way, without them.
#include "solver/energy_ledger.h"
#include "solver/system.h"

namespace mortise::solver {

class FirstGuess {
 public:
  FirstGuess(System& system, EnergyLedger& energies) : system_(system), energies_(energies) {}

  // q is where the step begins, and `at` linearised there; moves q in the environments of `whose`.
  void find(const EnvMask& whose, device::Buffer<Vec3>& q, Linearised& at);

 private:
  // Moves q along `way` where that is free and lower than here, or than with the supports moved alone.
  EnvMask go(const EnvMask& whose, const device::Buffer<Vec3>& way, const device::Buffer<Vec3>* supports, device::Buffer<Vec3>& q, Linearised& at);
  // Sums at trial_ = q + alpha way, where alpha is 0 or 1 [J].
  std::vector<double> energies_behind(const device::Buffer<Vec3>& q, const device::Buffer<Vec3>& way, const std::vector<double>& alpha,
                                      const Linearised& at);

  System& system_;
  EnergyLedger& energies_;
  device::Buffer<Vec3> way_, supports_, trial_;
};

}  // namespace mortise::solver
