#pragma once
// What sticks holds: where a step begins, the slip of a sample begins with the deflection that earlier steps left, so that what is held rests, as a
// spring does, and does not creep. With b_k, per point of the body with the finer surface, in creep distances e,
//
//     a = e sum_k w_k b_k                                over the sample's points of that body,
//     u = P (sum_k w_k (y_k - y_k^n) + a)                is what the law takes for its slip (law.h),
//     a' = u min(1, e/|u|)                               is left of it after the step: what slips further drags its spring along,
//     b_k <- b_k + sum_s m_s |w_sk| sigma (a' - P a)_s/e / sum_s m_s |w_sk|,       m_s = |mu lambda|, sigma = sum_k w_k = 1 or -1:
//
// means of what has changed only, so that a step without slip changes nothing, whatever the mesh. A point without samples forgets. What turns, or
// touches elsewhere, has b of another direction: it then slips by e once, as all did in every step without them.
// This is Coulomb's law as plasticity (Michalowski, Mroz, "Associated and non-associated sliding rules in contact friction problems", 1978).
#include "effects/friction/slips.h"
#include "model/model.h"

namespace mortise::effects::friction {

class Anchors {
 public:
  explicit Anchors(const model::Model& model);
  AnchorsView view(View<const double> creeps) const { return {deflection_.view(), model_.surface.body.view(), cell_.view(), creeps}; }
  // The environments that are worked on accept q, where `slips` has the samples; env_offset: of these.
  void keep(const Slips& slips, const std::vector<Index>& env_offset, Positions q);
  void checkpoint(Archive& archive);

 private:
  const model::Model& model_;
  device::Buffer<double> cell_;
  device::Buffer<Vec3> deflection_;  // b of every point [1]
};

}  // namespace mortise::effects::friction
