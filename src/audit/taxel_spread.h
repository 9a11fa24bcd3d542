#pragma once
// What taxels on a stiff body make of where it is pressed. A force on a node is shared out over the triangles around it (sensors/grid.h), which is
// what a soft surface does whose pressure is as fine as its mesh; a stiff one has triangles as large as one likes, since they change nothing else,
// and what presses on its middle shows at its corners. Of a force, roughly
//
//     min(1, kSpread a / t)
//
// lies in other taxels than it should, a: the area of a square of two of the triangles around its node, t: that of a taxel.
#include <span>
#include <vector>

#include "model/input.h"

namespace mortise::audit {

class TaxelSpread {
 public:
  explicit TaxelSpread(const model::ModelInput& input);
  // Share of the forces on a grid that lies in the wrong taxels, of the grid where it is largest. contact_force: of all points [N]. NaN: nothing
  // presses on a grid of a stiff body.
  double of(std::span<const double> contact_force) const;

 private:
  struct Node {
    std::size_t point;
    double share;
  };
  std::vector<std::vector<Node>> grids_;
};

}  // namespace mortise::audit
