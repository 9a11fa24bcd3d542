#pragma once
// The blocks that are free to move, numbered: rows of the matrix. Environments own contiguous ranges.
#include <cstdint>
#include <vector>

#include "device/device.h"
#include "model/model.h"

namespace mortise::solver {

class Rows {
 public:
  // Numbers anew where supports have changed since; says whether.
  bool number(const model::Model& model, bool is_static);

  Index count() const { return env.back(); }
  Index envs() const { return static_cast<Index>(env.size()) - 1; }

  std::vector<Index> env;                      // offsets: environment e owns rows [env[e], env[e+1])
  std::vector<Index> of_block_host, of_row;    // -1: no row; block of every row
  device::Buffer<Index> of_block, block;
  device::Buffer<Mat3> projector;              // of every row
  bool any_partial = false;                    // some block is held in some directions
  std::vector<std::uint8_t> loose;             // per environment: statics, and a body without any support, held by contact alone

 private:
  std::vector<std::uint8_t> held_;  // the model's when rows were numbered
};

}  // namespace mortise::solver
