#include "solver/rows.h"

#include <algorithm>

namespace mortise::solver {

bool Rows::number(const model::Model& model, bool is_static) {
  if (model.held == held_ && !env.empty()) return false;
  held_ = model.held;
  const std::vector<Mat3> projectors = model.projector.download();
  std::vector<Mat3> row_projector;
  of_block_host.assign(held_.size(), -1);
  of_row.clear();
  env.assign(1, 0);
  any_partial = false;
  for (Index e = 0; e < model.envs; ++e) {
    for (Index b = model.env_blocks[e]; b < model.env_blocks[e + 1]; ++b) {
      if (held_[b] == 2) continue;
      any_partial |= held_[b] == 1;
      of_block_host[b] = static_cast<Index>(of_row.size());
      of_row.push_back(b);
      row_projector.push_back(projectors[b]);
    }
    env.push_back(static_cast<Index>(of_row.size()));
  }
  loose.assign(model.envs, 0);
  for (const model::Body& body : model.bodies)
    if (is_static && std::all_of(held_.begin() + body.block_begin, held_.begin() + body.block_end, [](auto held) { return held == 0; })) loose[body.env] = 1;
  of_block.upload(of_block_host);
  block.upload(of_row);
  projector.upload(row_projector);
  return true;
}

}  // namespace mortise::solver
