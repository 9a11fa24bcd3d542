#pragma once
// How smooth the contact pressure is from node to node. A pressure is smoother than what a mesh makes of it: a plane through the pressures of a
// node's neighbours misses that of the node by little. The root mean square of the misses over that of the pressures, at nodes all of whose
// neighbours are loaded too, was 1.4 to 1.8 times the true L2 error on Hertz contact with mortar and barrier methods of two mesh sizes
// (3.4 to 14 %), and zero to rounding in the patch test.
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "model/input.h"

namespace mortise::run {

class PressureError {
 public:
  explicit PressureError(const model::ModelInput& input);
  struct Result {
    double roughness = NAN;  // NaN where no node has a loaded ring
    long nodes = 0;          // that carry pressure
  };
  // contact_pressure of all points [Pa]; those of soft bodies are looked at.
  Result of(std::span<const double> pressure) const;

 private:
  std::vector<Vec3> rest_;                // of all points [m]
  std::vector<std::vector<Index>> ring_;  // per point: its neighbours on the surface; empty off soft surfaces
};

}  // namespace mortise::run
