#pragma once
#include <string>
#include <vector>

#include "base/archive.h"
#include "base/params.h"
#include "sensors/sensors.h"

namespace mortise::run {

// Draws what sensors read: FOLDER/sensor_<name>_0042.png shows pressure as colour, seen from outside with `up` upwards, and shear as
// arrows that start in the middle of taxels. Scales that the scene does not set end at the largest values so far.
class SensorMaps {
 public:
  // `scene`: the whole. Creates the folder. Throws Error(Exit::file).
  SensorMaps(const Params& scene, const sensors::Sensors& sensors, const std::string& folder);
  // What every frame shows, whether it is drawn or not; one reading per sensor, of which pressure, shear and area count.
  void see(const std::vector<sensors::Reading>& readings);
  void draw(long frame, double time, const std::vector<sensors::Reading>& readings) const;
  void checkpoint(Archive& archive);

 private:
  struct Scale {
    double low, high;              // pressure at the ends of the colours [Pa]
    double shear_low, shear_high;  // least that has an arrow, and that of the longest [Pa]
  };
  Scale scale_of(std::size_t sensor) const;

  const Params scene_;
  const sensors::Sensors& sensors_;
  std::string folder_;
  std::vector<double> pressure_, shear_;  // largest so far, per sensor [Pa]
};

}  // namespace mortise::run
