#pragma once
// How much of the Hessian's negative curvature the matrix keeps (effects/curvature.h), in every environment. A cut step shows that the
// quadratic model reaches too far: convex pieces are safer then. After a full one the exact Hessian is tried again, as it converges
// quadratically; where that matrix is not positive definite, less of it.
#include <algorithm>
#include <iterator>
#include <vector>

#include "effects/curvature.h"
#include "solver/tuning.h"

namespace mortise::solver {

class CurvaturePolicy {
 public:
  explicit CurvaturePolicy(Index envs) : concavity_(envs, 0.0) {}

  void begin_step() { std::fill(concavity_.begin(), concavity_.end(), 0.0); }
  // alpha: share of the last step that was taken; 0 before the first.
  void choose(Index env, double alpha) {
    double& s = concavity_[env];
    s = alpha < 1 ? 0 : s == 0 ? 1 : *(std::find(std::begin(tuning::kConcave), std::end(tuning::kConcave), s) - (s < 1));
  }
  void soften(Index env) {
    double& s = concavity_[env];
    s = *(std::find(std::begin(tuning::kConcave), std::end(tuning::kConcave), s) + (s > 0));
  }
  void make_convex(Index env) { concavity_[env] = 0; }

  double concavity(Index env) const { return concavity_[env]; }
  // For linearise(); stands until the next change.
  effects::Curvature wanted() {
    if (concavity_.size() == 1) return effects::Curvature(true, concavity_[0]);
    device_.upload(concavity_);
    return effects::Curvature(std::as_const(device_).view());
  }

 private:
  std::vector<double> concavity_;
  device::Buffer<double> device_;
};

}  // namespace mortise::solver
