#include "solver/rows.h"

#include <algorithm>
#include <numeric>

namespace mortise::solver {

bool Rows::number(const model::Model& model, bool is_static) {
  if (model.held == held_ && ties_ == model.ties.version() && !env.empty()) {
    if (any_partial) {  // lines that bodies slide along turn with what carries them
      const std::vector<Mat3> now = model.projector.download();
      std::vector<Mat3> of_rows;
      for (Index b : of_row) of_rows.push_back(now[b]);
      projector.upload(of_rows);
    }
    return false;
  }
  held_ = model.held;
  ties_ = model.ties.version();
  const std::vector<Mat3> projectors = model.projector.download();
  std::vector<Mat3> row_projector;
  of_block_host.assign(held_.size(), -1);
  of_row.clear();
  env.assign(1, 0);
  any_partial = false;
  for (Index e = 0; e < model.envs; ++e) {
    for (Index b = model.env_blocks[e]; b < model.env_blocks[e + 1]; ++b) {
      if (held_[b] >= 2) continue;
      any_partial |= held_[b] == 1;
      of_block_host[b] = static_cast<Index>(of_row.size());
      of_row.push_back(b);
      row_projector.push_back(projectors[b]);
    }
    env.push_back(static_cast<Index>(of_row.size()));
  }
  loose.assign(model.envs, 0);
  std::vector<Index> loose_rows;
  loose_env.assign(model.envs + 1, 0);
  for (const model::Body& body : model.bodies) {
    const auto first = held_.begin() + body.block_begin, last = held_.begin() + body.block_end;
    const auto free = [](auto held) { return held == 0; };
    // A stiff body is held as a whole or not at all; where ties leave it some freedom nothing else may.
    if (!is_static || !(body.type == model::BodyType::stiff ? std::any_of(first, last, free) : std::all_of(first, last, free))) continue;
    loose[body.env] = 1;
    for (Index b = body.block_begin; b < body.block_end; ++b)
      if (of_block_host[b] >= 0) loose_rows.push_back(of_block_host[b]), ++loose_env[body.env + 1];
  }
  std::partial_sum(loose_env.begin(), loose_env.end(), loose_env.begin());
  loose_row.upload(loose_rows);
  number_tied(model);
  of_block.upload(of_block_host);
  block.upload(of_row);
  projector.upload(row_projector);
  return true;
}

void Rows::number_tied(const model::Model& model) {
  tied = {};
  if (!model.ties.any()) return;
  tied.of_block.assign(held_.size(), -1);
  for (Index b = 0; b < model.blocks; ++b) {
    const std::size_t before = tied.column.size();
    for (const model::TieTerm& term : model.ties.terms(b)) {
      if (of_block_host[term.block] < 0) continue;
      tied.column.push_back(of_block_host[term.block]);
      tied.weight.push_back(term.weight);
    }
    if (tied.column.size() == before) continue;
    tied.of_block[b] = tied.count();
    tied.offset.push_back(static_cast<Index>(tied.column.size()));
  }
}

}  // namespace mortise::solver
