#pragma once
// Round stiff bodies on hinges with motors, pressed by stiff ones (cams, friction wheels): where facets stand for a round surface, what presses jumps
// from corner to corner, by up to half an edge s off the place where it would touch. The torque of the motor is wrong by as much of the force,
//
//     facet_torque = max N s / 2 / max |tau|
//
// N: all that presses the body across the axis of its hinge in a state (along it, as on the flat face of a disk, no place has a torque), tau: of its
// motor in two states one after the other, as what starts at once takes any. Of facets that lie less deep below the surface than contact reaches, by
// depth / (depth + kEvens d_hat), as more than one corner bears then. Soft bodies lie on several facets at once, and are left out.
#include <string>
#include <vector>

#include "audit/moving_body.h"
#include "base/archive.h"
#include "base/snapshot.h"
#include "model/input.h"

namespace mortise::audit {

class FacetTorque {
 public:
  explicit FacetTorque(const model::ModelInput& input);
  void state(const Snapshot& said, const std::vector<double>& points, const std::vector<MovingBody>& bodies);
  double share() const;  // of the body where it is most; NaN without such bodies
  void checkpoint(Archive& archive);

 private:
  struct Wheel {
    std::size_t body;
    double off;          // s / 2, so far as the layer leaves it [m]
    std::string torque;  // "drive/NAME_torque"
    Vec3 axis;           // of the hinge, at the start
  };
  std::vector<double> start_;  // places of all points [m]
  std::vector<Wheel> wheels_;
  std::vector<double> off_, torque_;  // largest so far [N m]
  std::vector<double> last_;          // torques in the last state [N m]
};

}  // namespace mortise::audit
