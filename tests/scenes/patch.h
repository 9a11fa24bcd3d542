#pragma once
// A block under a plate.
#include <string>

namespace mortise::testing {

// A block, 20 x 20 x 10 mm, between a plate and its supports: F = E A (travel + gap) / L.
inline constexpr const char* kPatch = R"(
mortise: 1
name: patch
time: {mode: static, steps: 1}
materials:
  gel: {model: linear, youngs_modulus: 0.1 MPa, poisson_ratio: 0.3, density: 1000}
bodies:
  block: {type: soft, shape: {box: {size: [20 mm, 20 mm, 10 mm], edge_length: 5 mm}}, material: gel, position: [10 mm, 10 mm, 5 mm]}
  plate: {type: stiff, shape: {box: {size: [30 mm, 30 mm, 4 mm], edge_length: 6 mm}}, material: gel, position: [10 mm, 10 mm, 12.2 mm]}
effects:
  elasticity: {}
  pin:
    - {body: block, where: {side: x_min}, axes: x}
    - {body: block, where: {side: y_min}, axes: y}
    - {body: block, where: {side: z_min}, axes: z}
    - {body: plate, where: {side: all}, motion: {time: [0, 1], translation: [[0, 0, 0], [0, 0, -0.7 mm]]}}
  CONTACT
solver: {relative_tolerance: 1e-10}
)";

inline std::string patch(const std::string& contact) {
  std::string out = kPatch;
  return out.replace(out.find("CONTACT"), 7, contact);
}

}  // namespace mortise::testing
