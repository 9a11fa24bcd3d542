#pragma once
#include <string>
#include <vector>

#include "sensors/sensors.h"

namespace mortise::run {

// Whether the grids of sensors lie where their bodies are pressed. On a curved body one whose normal points the wrong way lies on a real surface,
// the far one, and its map is empty for no reason that can be seen. Only a run knows where the forces are.
class SensorReach {
 public:
  void see(const std::vector<sensors::Reading>& readings);
  // Of sensors that felt hardly anything of the largest force on their body.
  std::vector<std::string> warnings(const sensors::Sensors& sensors) const;

 private:
  struct Largest {
    double on_body = 0, on_taxels = 0;  // [N]
  };
  std::vector<Largest> largest_;
};

}  // namespace mortise::run
