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

Index worst_block(const model::Model& model, const device::Buffer<Vec3>& v) {
  const std::vector<Vec3> host = v.download();
  const std::vector<Mat3> P = model.projector.download();
  Index worst = 0;
  double most = -1;
  for (std::size_t b = 0; b < host.size(); ++b) {
    const double size = (P[b] * host[b]).norm();
    if (!std::isfinite(size)) return static_cast<Index>(b);
    if (size > most) most = size, worst = static_cast<Index>(b);
  }
  return worst;
}

}  // namespace mortise::solver
