#pragma once
// Where Newton's method starts in a step. Beginning where the last step ended, all that moves evenly - what flies, what creeps under friction - would
// be brought to rest and set in motion again. Instead it starts where inertia alone would carry everything in this step, q^, and with supports where
// they are to be, in the environments where nothing is met on the way there and the potential is lower; where supports move, lower than with them
// alone moved, as they do work. Where they are in the way, it starts at q^ with supports where they were.
#include "solver/energy_ledger.h"
#include "solver/system.h"

namespace mortise::solver {

class FirstGuess {
 public:
  FirstGuess(System& system, EnergyLedger& energies) : system_(system), energies_(energies) {}

  // Moves the environments of `whose`, in which a step begins; returns those that it could. at: frozen at q.
  EnvMask find(const EnvMask& whose, device::Buffer<Vec3>& q, Linearised& at);
  // Did they all go to a state that effects have foreseen?
  bool landed() const { return landed_; }

 private:
  // Takes the way from q where that is good; returns where. supports: their part of the way, which leads to their targets; empty: they stay. free:
  // how far the way leads, where that is known.
  EnvMask go(const EnvMask& whose, const device::Buffer<Vec3>& way, device::View<const Vec3> supports, std::vector<double> free,
             device::Buffer<Vec3>& q, Linearised& at);

  System& system_;
  EnergyLedger& energies_;
  bool lands_ = true, landed_ = false;  // the last guess was taken; and was foreseen
  bool driven_ = false;                 // supports moved in the last step
  device::Buffer<Vec3> way_, with_supports_, supports_, trial_, moved_;
};

}  // namespace mortise::solver
