#pragma once
#include <string>
#include <vector>

#include "base/archive.h"
#include "sensors/sensors.h"

namespace mortise::run {

// Draws what sensors read: FOLDER/sensor_<name>_0042.png shows pressure as colour, seen from outside with `up` upwards, and shear as
// lines that start in the middle of taxels. The colour scale ends at the largest pressure of the frames so far.
class SensorMaps {
 public:
  // Creates the folder. Throws Error(Exit::file).
  SensorMaps(const sensors::Sensors& sensors, const std::string& folder);
  void draw(long frame, double time);
  void checkpoint(Archive& archive);

 private:
  const sensors::Sensors& sensors_;
  std::string folder_;
  std::vector<double> pressure_, shear_;  // largest so far, per sensor [Pa]
};

}  // namespace mortise::run
