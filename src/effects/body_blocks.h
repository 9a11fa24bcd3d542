#pragma once
// What several effects need to know about the blocks of bodies.
#include <vector>

#include "model/model.h"

namespace mortise::effects {

// 1 for blocks that are positions (soft nodes, centres of stiff bodies), 0 for the columns (a1, a2, a3) of affine bodies: the
// generator of a rigid translation, d q_b / d c = weight[b] I.
inline std::vector<double> translation_weight(const model::Model& model) {
  std::vector<double> weight(model.blocks, 1.0);
  for (const model::Body& body : model.bodies)
    if (body.type == model::BodyType::stiff)
      for (Index b = body.block_begin + 1; b < body.block_end; ++b) weight[b] = 0;
  return weight;
}

// offset[e] = first element of environment e in a list ordered by environment, as device::env_sum wants it.
inline std::vector<Index> env_offsets(const std::vector<Index>& env_of_element, Index envs) {
  std::vector<Index> offset(envs + 1, 0);
  for (Index e : env_of_element) ++offset[e + 1];
  for (Index e = 0; e < envs; ++e) offset[e + 1] += offset[e];
  return offset;
}

}  // namespace mortise::effects
