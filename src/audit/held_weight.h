#pragma once
// Weight that facets leave out of stiff round bodies which go as pins and kinematic drives say (shape_defect.h has the others): what holds them bears
// as much less. With d the share of its volume that a body lacks,
//
//     held_weight = d m g / max(F, m g)      F: the force that holds the body, or that touches it, in the state where that is largest
//
// of the body where it is most: beside what an indenter presses with its weight may be nothing.
#include <vector>

#include "base/archive.h"
#include "model/input.h"

namespace mortise::audit {

class HeldWeight {
 public:
  explicit HeldWeight(const model::ModelInput& input);
  void state(const std::vector<double>& forces);  // F of every body but half-spaces [N]
  double share() const;                           // NaN without such bodies
  void checkpoint(Archive& archive) { archive.io("held_weight.largest", largest_); }

 private:
  struct Body {
    std::size_t number;
    double weight, defect;  // m g [N], d
  };
  std::vector<Body> bodies_;
  std::vector<double> largest_;  // F of each of them so far [N]
};

}  // namespace mortise::audit
