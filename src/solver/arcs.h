#pragma once
// Ways on which stiff bodies turn. Their points go straight in a step of Newton's method, q + alpha dq, and a body that turns by theta is stretched
// by theta^2/2 on that: its stiffness would cut the way of a ball that rolls to hundredths. Where one turns by more than kArc the way ends where
// the arc does, on which it only turns, and leads there straight, so that it can be looked along for what is met. Half a way is one of its own, to
// the middle of the arc: Armijo's condition holds along the arc, whose tangent at q is dq.
#include <vector>

#include "solver/envs.h"
#include "solver/system.h"

namespace mortise::solver {

class Arcs {
 public:
  explicit Arcs(System& system) : system_(system) {}

  // Asks how far bodies turn along dq; `fetch` brings it.
  void ask(device::View<const Vec3> q, const device::Buffer<Vec3>& dq, device::Fetch& fetch);
  // Bends ways dq of the environments of `whose` on which they turn far, and says in alpha how far those lead. Asks what potential.max_step() asks.
  void begin(device::View<const Vec3> q, const device::Buffer<Vec3>& dq, const EnvMask& whose, std::vector<double>& alpha, Linearised& at);
  // Bends the ways alpha dq of the environments of `whose`, and lowers alpha to how far they lead then. Others that are bent stay so.
  void bend(device::View<const Vec3> q, const device::Buffer<Vec3>& dq, const EnvMask& whose, std::vector<double>& alpha, Linearised& at);
  bool bent(Index env) const { return !bent_.empty() && bent_[env]; }
  // trial: where the ways lead; where alpha is 0 it is q.
  void advance(device::View<const Vec3> q, const device::Buffer<Vec3>& dq, const std::vector<double>& alpha, device::Buffer<Vec3>& trial) const;

 private:
  System& system_;
  std::vector<double> turning_, share_;  // per environment: along dq [rad]; of the bent way
  EnvMask bent_;
  device::Buffer<Vec3> way_;
};

}  // namespace mortise::solver
