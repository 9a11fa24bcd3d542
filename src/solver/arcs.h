#pragma once
// Ways on which stiff bodies turn. Their points go straight in a step of Newton's method, q + alpha dq, and a body that turns by theta is stretched
// by theta^2/2 on that: its stiffness would cut the way of a ball that rolls to hundredths. Where one turns by more than kArc the way ends where
// the arc does, on which it only turns, and leads there straight, so that it can be looked along for what is met. Half a way is one of its own, to
// the middle of the arc: Armijo's condition holds along the arc, whose tangent at q is dq. What supports move goes straight in either case: a share
// alpha of the way leaves 1 - alpha of theirs.
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
  // The shares of the environments of `whose` have changed: ways of theirs that are bent are bent anew, and alpha falls to how far they lead.
  void bend_again(device::View<const Vec3> q, const device::Buffer<Vec3>& dq, const EnvMask& whose, std::vector<double>& alpha, Linearised& at);
  // trial: where so much of the ways leads.
  void advance(device::View<const Vec3> q, const device::Buffer<Vec3>& dq, const std::vector<double>& alpha, device::Buffer<Vec3>& trial) const;

 private:
  void bend(device::View<const Vec3> q, const device::Buffer<Vec3>& dq, const EnvMask& whose, std::vector<double>& alpha, Linearised& at);

  System& system_;
  std::vector<double> turning_;  // per environment, along dq [rad]
  EnvMask bent_;
  device::Buffer<Vec3> way_;  // of what is bent: the share alpha of it that is gone ends on the arc of alpha dq
};

}  // namespace mortise::solver
