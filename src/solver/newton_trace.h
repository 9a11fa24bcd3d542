#pragma once
// Keeps what Newton's iterations do in a StepReport, when asked to.
#include "solver/curvature_policy.h"
#include "solver/system.h"

namespace mortise::solver {

class NewtonTrace {
 public:
  NewtonTrace(System& system, const CurvaturePolicy& curvature) : system_(system), curvature_(curvature) {}

  // At q, where `at` is linearised, in the environments of `whose`.
  void begin(const effects::StepInfo& info, device::View<const Vec3> q, const Residual& r, Index iteration, const Linearised& at,
             const EnvMask& whose, const StepReports& report);
  // The step from there; products: with the whole Jacobian, per environment; empty without.
  void end(const EnvTable& envs, const EnvMask& whose, const std::vector<Index>& products, const StepReports& report);

 private:
  System& system_;
  const CurvaturePolicy& curvature_;
};

}  // namespace mortise::solver
