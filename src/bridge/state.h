#pragma once
// What the solver says: the scene once, and the state before every control step; lines of JSON (README.md).
#include <string>
#include <vector>

#include "base/snapshot.h"
#include "bridge/message.h"
#include "geometry/placement.h"
#include "model/input.h"
#include "sensors/sensors.h"

namespace mortise::bridge {

class State {
 public:
  State(const model::ModelInput& input, const sensors::Sensors& sensors);

  struct Facts {
    std::string scene;
    long environment = -1;                             // of a scene that has several
    long episode = 0, every = 1, steps = 0, step = 0;  // step: from which it goes on
    double time_step = 0;                              // [s]
  };
  std::string hello(const Facts& facts, const std::vector<Drive>& drives) const;
  // said: what effects and sensors reported; points: 3 per point of the model [m].
  std::string line(long step, double time, const Snapshot& said, const std::vector<double>& points,
                   const std::vector<sensors::Reading>& readings) const;

 private:
  struct Body {
    std::string name;
    std::vector<Vec3> rest;
    std::size_t first;
    geometry::Placement placed;  // its shape, as the scene says
  };
  std::vector<Body> bodies_;  // stiff ones
  std::vector<std::string> joints_;
  const sensors::Sensors& sensors_;
};

}  // namespace mortise::bridge
