#pragma once
// A block of steel that friction stops after v^2 / (2 mu g), v = 1 m/s, mu = 0.3, in a third of a second; steps of 10 ms.
namespace mortise::testing {

inline constexpr const char* kSlide = R"(
mortise: 1
name: slide
time: {step: 10 ms, steps: 1}
materials: {steel: {density: 7850}}
bodies:
  block: {type: stiff, shape: {box: {size: [60 mm, 40 mm, 20 mm], edge_length: 60 mm}}, material: steel, position: [0, 0, 10.005 mm], velocity: [1, 0, 0]}
  floor: {type: half_space}
effects:
  inertia: {}
  gravity: {}
  affine_body: {}
  barrier_contact: {d_hat: 0.01 mm}
  friction: {mu: 0.3}
)";

}  // namespace mortise::testing
