#pragma once
// What Newton's iterations did, one by one, for whoever wants to know why a step is slow.
#include <string>

#include "device/device.h"
#include "model/model.h"

namespace mortise::solver {

struct Iterate {
  double time = 0;  // at the end of the (sub)step [s]
  double dt = 0;    // its length [s]
  Index round = 0;  // of lagged quantities
  Index iteration = 0;
  Index env = 0;
  double residual = 0;   // largest force residual [N]
  double tolerance = 0;  // what it has to be below [N]
  double energy = 0;     // Phi [J]
  double concave = 0;    // share of negative curvature in the matrix
  Index products = 0;    // with the whole Jacobian, of the coupled iteration; 0: a step with the frozen matrix
  double step = 0;       // largest move of a block in the full Newton step [m]
  double alpha = 0;      // share of it that was taken
  std::string where;     // the block of the largest residual, or of one that is not finite
};

// "node 12 of 'pad'"; of a stiff body "the position of 'tool'" or "axis 2 of 'tool'".
std::string name_block(const model::Model& model, Index block);

// Block of the environment with the largest |P v|, or the first where it is not finite.
Index worst_block(const model::Model& model, const device::Buffer<Vec3>& v, Index env);

}  // namespace mortise::solver
