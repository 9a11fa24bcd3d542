#pragma once
#include <memory>
#include <vector>

#include "base/field_sink.h"
#include "sensors/sensor.h"

namespace mortise::sensors {

// The sensors that a scene names; none, and nothing is kept or computed, where it names none. They read what effects report, on the
// way to the field file, and add their own groups `sensor_<name>`.
class Sensors {
 public:
  // Throws Error(Exit::scene) where a sensor lies beside its body.
  explicit Sensors(const model::ModelInput& input);
  ~Sensors();

  bool empty() const { return sensors_.empty(); }
  const std::vector<Sensor>& all() const { return sensors_; }

  // A sink for the report of one state: takes note of the forces and passes everything on. Valid until the next call.
  FieldSink* watch(FieldSink* next);
  // The report is complete: every sensor adds its reading. points: 3 per point of the model [m].
  void finish(const std::vector<double>& points);
  const std::vector<Reading>& readings() const { return readings_; }  // of the last finish()

 private:
  class Watch;
  std::vector<Sensor> sensors_;
  std::unique_ptr<Watch> watch_;
  FieldSink* next_ = nullptr;
  std::vector<Reading> readings_;
};

}  // namespace mortise::sensors
