#pragma once
// The blocks that are free to move, numbered: rows of the matrix. Environments own contiguous ranges.
#include <cstdint>
#include <vector>

#include "device/device.h"
#include "model/model.h"

namespace mortise::solver {

class Rows {
 public:
  // Numbers anew where supports or ties have changed since; says whether.
  bool number(const model::Model& model, bool is_static);

  Index count() const { return env.back(); }
  Index envs() const { return static_cast<Index>(env.size()) - 1; }

  std::vector<Index> env;                    // offsets: environment e owns rows [env[e], env[e+1])
  std::vector<Index> of_block_host, of_row;  // -1: no row; block of every row
  device::Buffer<Index> of_block, block;
  device::Buffer<Mat3> projector;   // of every row
  bool any_partial = false;         // some block is held in some directions
  std::vector<std::uint8_t> loose;  // per environment: statics, and a body that can move as a whole but for contact
  device::Buffer<Index> loose_row;  // of such bodies; environment e has [loose_env[e], loose_env[e+1]) of them
  std::vector<Index> loose_env;

  // Where blocks are tied: the rows of the matrix of all blocks that hang on some row, by which rows (linalg/elimination.h).
  struct Tied {
    std::vector<Index> of_block, offset{0}, column;
    std::vector<double> weight;
    Index count() const { return static_cast<Index>(offset.size()) - 1; }
  } tied;

 private:
  void number_tied(const model::Model& model);

  std::vector<std::uint8_t> held_;  // the model's when rows were numbered,
  Index ties_ = -1;                 // and which T its ties had
};

}  // namespace mortise::solver
