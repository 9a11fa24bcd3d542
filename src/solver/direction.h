#pragma once
// The Newton direction: (P J P + I - P) d = -P (g + J c), and the way d + c of all blocks. J is the Hessian H with as much of its negative curvature
// as leaves it positive definite; of environments that take the whole Jacobian it is H + U, with U not symmetric, as long as that leads downhill.
#include "solver/curvature_policy.h"
#include "solver/linear.h"
#include "solver/system.h"

namespace mortise::solver {

class Direction {
 public:
  Direction(System& system, Linear& linear, CurvaturePolicy& curvature) : system_(system), linear_(linear), curvature_(curvature) {}

  // In the running environments, from q, where `at` is linearised with a matrix; wanted: per environment the residual at which Newton stops [N].
  // Where there is none the environment fails. In two halves: what is only told of the way comes with `fetch`, between them.
  // `ask`: what else is to be known of the way; it is asked here where the host waits for that anyway, which is said by `true`.
  bool begin(const device::Buffer<Vec3>& q, const Residual& r, const std::vector<double>& wanted, Linearised& at, EnvTable& envs,
             const StepReports& report, device::Fetch& fetch, const std::function<void(device::Fetch&)>& ask = {});
  void end(EnvTable& envs);
  // Before that: the right-hand side of the state of `at`, on the guess that no support moves; its size comes with `fetch`.
  void foresee(const Linearised& at, device::Fetch& fetch);
  void forget() { foreseen_ = false; }  // another state comes

  // What Newton's next direction needs of its iterate.
  effects::Want want(const EnvTable& envs);

  device::Buffer<Vec3>& way() { return dq_; }
  const std::vector<double>& slope() const { return slope_; }  // per environment: gradient . way [J]
  // What supports still have to move; empty where none does.
  device::View<const Vec3> supports() const { return supports_move_ ? support_.view() : device::View<const Vec3>{}; }
  linalg::BlockMatrix& matrix() { return matrix_; }  // work space, for whoever needs one

 private:
  void solve(const device::Buffer<Vec3>& q, const std::vector<double>& wanted, EnvMask todo, bool whole, Linearised& at, EnvTable& envs,
             const StepReports& report, Aside& aside);
  void carry(const Linearised& at, const EnvTable& envs, device::Fetch& fetch);
  System& system_;
  Linear& linear_;
  CurvaturePolicy& curvature_;
  linalg::BlockMatrix matrix_;
  bool supports_move_ = false;
  device::Buffer<Vec3> support_, rhs_, x_, dq_, offset_;
  std::vector<double> slope_, longest_;  // per environment [J], [m]
  bool foreseen_ = false;                // rhs_ is that of the iterate without supports,
  std::vector<double> rhs2_;             // and its squared size
  device::Buffer<std::uint8_t> moving_;  // environments that want what moves
  EnvMask measured_;                     // environments of which they are known
};

}  // namespace mortise::solver
