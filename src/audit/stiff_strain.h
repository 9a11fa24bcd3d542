#pragma once
// Stiff bodies are strained a little by what acts on them (effects/affine_body): of a long one that moves little its end has gone by that strain as
// well. With y the points of a body and x those of the rigid motion nearest to them,
//
//     strain = max |y - x| / max(w, kStillStiff R),      w: farthest way of a point since the start, R: distance of the farthest from their middle
//     [m]
//
// of the worst body at the last state: what impacts do for an instant is no error of where bodies are.
#include <cmath>
#include <vector>

#include "base/archive.h"
#include "base/snapshot.h"
#include "model/input.h"

namespace mortise::audit {

class StiffStrain {
 public:
  explicit StiffStrain(const model::ModelInput& input);
  void state(const Snapshot& said);
  double share() const;  // NaN without stiff bodies
  void checkpoint(Archive& archive);

 private:
  struct Body {
    std::size_t first;  // point
    std::vector<Vec3> rest;
    double radius;  // [m]
  };
  std::vector<Body> bodies_;
  std::vector<double> displacement_;  // of all points at the last state [m]; empty: none since the run went on
  double before_ = NAN;               // that, of the state from which it went on
};

}  // namespace mortise::audit
