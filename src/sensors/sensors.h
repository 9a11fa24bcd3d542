#pragma once
#include <vector>

#include "base/snapshot.h"
#include "sensors/sensor.h"

namespace mortise::sensors {

// The sensors that a scene names; none, and nothing is kept or computed, where it names none. They read what effects report and
// report their own groups `sensor_<name>`.
class Sensors {
 public:
  // Throws Error(Exit::scene) where a sensor lies beside its body.
  explicit Sensors(const model::ModelInput& input);

  bool empty() const { return sensors_.empty(); }
  const std::vector<Sensor>& all() const { return sensors_; }

  // Reads the state that effects reported, and adds the readings to it. points: 3 per point of the model [m].
  std::vector<Reading> read(Snapshot& state, const std::vector<double>& points) const;

 private:
  std::vector<Sensor> sensors_;
};

}  // namespace mortise::sensors
