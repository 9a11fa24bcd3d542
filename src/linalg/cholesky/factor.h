#pragma once
// The numbers of A = L L^T, supernode by supernode (multifrontal; Duff, Reid, ACM TOMS 9(3), 1983; Liu, SIAM Review 34(1), 1992): a supernode's panel
// and what it leaves to its parent are one dense matrix
//     F = [F11    ]      F11 = L11 L11^T,   L21 = F21 L11^-T,   left to the parent: F22 - L21 L21^T
//         [F21 F22]
// to which its children have added what they left. Branches of the tree are tasks, large panels are divided into tiles; every number is the sum of
// the same products in the same order whatever the threads do. In single precision a factor takes half of the time and memory and is a
// preconditioner, no solution.
#include <memory>
#include <vector>

#include "linalg/cholesky/supernodes.h"

namespace mortise::linalg::cholesky {

template <class Real>
class Factor {
 public:
  // `value`: the blocks of A in the order in which its structure was given. False where A is not positive definite, or too nearly not for Real, or
  // not finite. Throws std::bad_alloc.
  bool compute(const Supernodes& t, const Mat3* value);
  // x = A^-1 b after compute() has succeeded; may be the same.
  void solve(const Supernodes& t, const Vec3* b, Vec3* x);

  std::size_t bytes() const { return (panel_size_ + place_.size() + left_.size()) * sizeof(Real); }
  // (smallest / largest diagonal entry of L)^2: a rough estimate of the reciprocal condition.
  double reciprocal_condition() const { return reciprocal_condition_; }

 private:
  std::unique_ptr<Real[]> panels_;
  std::size_t panel_size_ = 0;
  std::vector<Real> place_, left_;  // of a solve: by place; what supernodes leave to their parents
  double reciprocal_condition_ = 0;
};

extern template class Factor<double>;
extern template class Factor<float>;

}  // namespace mortise::linalg::cholesky
