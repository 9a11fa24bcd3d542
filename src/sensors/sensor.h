#pragma once
#include <string>
#include <vector>

#include "model/input.h"
#include "sensors/grid.h"

namespace mortise::sensors {

// What a sensor reads of one state. Vectors are in the sensor's frame: x along a row, y along a column, z out of the body.
struct Reading {
  Frame frame;                                                     // now
  std::vector<double> pressure;                                    // per taxel: -F_z / A [Pa]
  std::vector<double> shear;                                       // 2 per taxel: F_x / A, F_y / A [Pa]
  std::vector<double> force;                                       // 3 per taxel: contact and friction on it [N]
  std::vector<double> displacement;                                // 3 per taxel: of its material against the frame, since the start [m]
  std::vector<double> area;                                        // per taxel: of its surface now [m^2]; 0 where the grid reaches beyond the body
  Vec3 wrench_force = Vec3::Zero(), wrench_moment = Vec3::Zero();  // on the whole body, about the frame's origin [N, N m]
};

// One entry of the scene's `sensors`: a grid of taxels that moves with a body.
class Sensor {
 public:
  // first_point: number of the body's first node among all points.
  Sensor(std::string name, const Params& params, const model::ModelInput& input, const model::BodyInput& body, Index first_point);

  // points, contact, friction: 3 per point of the model [m, N]; the forces may be empty, where no effect reports them.
  Reading read(const std::vector<double>& points, const std::vector<double>& contact, const std::vector<double>& friction) const;

  const std::string& name() const { return name_; }
  const std::string& body() const { return body_; }
  const GridSpec& spec() const { return spec_; }
  double rest_area() const { return grid_.whole_area(); }  // of the surface under the grid, at rest [m^2]
  std::size_t bytes() const { return grid_.bytes() + rest_.size() * sizeof(Vec3) + base_.size() * sizeof(Index); }

 private:
  Vec3 local(const Frame& frame, const Vec3& x) const { return frame.axes.transpose() * (x - frame.origin); }

  std::string name_, body_;
  GridSpec spec_;
  TaxelGrid grid_;
  Index first_;
  std::vector<Vec3> rest_;
  std::vector<Index> base_;  // nodes that the frame moves with
};

}  // namespace mortise::sensors
