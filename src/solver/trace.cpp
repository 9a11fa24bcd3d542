#include "solver/trace.h"

#include <cmath>

namespace mortise::solver {

std::string name_block(const model::Model& model, Index block) {
  for (const model::Body& body : model.bodies) {
    if (block < body.block_begin || block >= body.block_end) continue;
    const Index i = block - body.block_begin;
    const std::string of = " of '" + body.name + "'";
    if (body.type == model::BodyType::soft) return "node " + std::to_string(i) + of;
    return (i == 0 ? std::string("the position") : "axis " + std::to_string(i)) + of;
  }
  return "block " + std::to_string(block);
}

Index worst_block(const model::Model& model, const device::Buffer<Vec3>& v, Index env) {
  const std::vector<Vec3> host = v.download();
  const std::vector<Mat3> P = model.projector.download();
  Index worst = model.env_blocks[env];
  double largest = -1;
  for (Index b = worst; b < model.env_blocks[env + 1]; ++b) {
    const double size = (P[b] * host[b]).norm();
    if (!std::isfinite(size)) return b;
    if (size > largest) largest = size, worst = b;
  }
  return worst;
}

}  // namespace mortise::solver
