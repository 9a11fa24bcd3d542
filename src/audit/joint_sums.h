#pragma once
// The inertia of joints. With phi_j the velocity of a body that goes with a unit of the coordinate theta_j of a joint, a its acceleration and < , >
// the product by mass, over all bodies that hang on them
//
//     M_jk = sum <phi_j, phi_k>,     J_j = sum <phi_j, a>      [kg m^2, N m; of slides kg, N]
//
// J is what drives, springs, loads and contacts do along the joints, whatever else moves the bodies (Kane's equations). Soft bodies count as points.
#include <Eigen/Dense>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "audit/holds.h"
#include "audit/moving_body.h"
#include "model/input.h"

namespace mortise::audit {

class JointSums {
 public:
  // Of joints that lead, by name, over the bodies that `counts`.
  JointSums(const model::ModelInput& input, const Holds& holds, std::vector<std::string> joints,
            const std::function<bool(const std::string&)>& counts);
  struct Sums {
    Eigen::MatrixXd M;
    Eigen::VectorXd J;
    std::vector<bool> touches, stopped;  // a body that hangs on it
    std::vector<double> size;            // radius of the first of these [m]
  };
  Sums of(const std::vector<double>& points, const std::vector<MovingBody>& bodies) const;
  bool empty() const { return carried_.empty() || joints_.empty(); }

 private:
  struct Carried {
    std::size_t number;
    Mat3 inertia;  // at rest, about the centre of mass; none of soft bodies [kg m^2]
  };
  Holds holds_;
  std::vector<std::string> joints_;
  std::vector<Carried> carried_;
  std::map<std::string, std::vector<Vec3>> rest_;  // of all bodies [m]
};

// Joints with kinematic drives that lead.
std::vector<std::string> kinematic_joints(const Params& effects, const Holds& holds);
// What the drive of one does, without regard to direction, and no less than rounding does to the j-th of these sums in a step h [N m, N].
double driving(const Snapshot& said, const std::string& joint, const JointSums::Sums& sums, std::size_t j, double h);

}  // namespace mortise::audit
