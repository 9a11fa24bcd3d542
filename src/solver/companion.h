#pragma once
// What goes beside a simulation, to first order in what it differs by (follow.cpp): parameters of its own, or some of what the leader leaves undone
// done.
namespace mortise::solver {

class Simulation;

struct Departure {
  bool fits = false;      // what effects fit to solutions is what the leader has fitted; else nothing may be fitted
  double residual = 0;    // share of what the leader's equations, with nothing lagged, have left that is taken away
  double integrator = 0;  // share of the way from the integrator to one of the next higher order
};

struct BesideTime {
  double wall = 0, cpu = 0;  // [s]
};

struct Companion {
  Simulation* of;
  Departure by;
};

}  // namespace mortise::solver
