#pragma once
#include <fmt/format.h>

#include <string>

namespace mortise::testing {

// A ball falls by 20 mm on a gel pad. In truth it comes back to where it was, but for 0.4 %.
inline std::string dropped(const std::string& inertia, const std::string& under) {
  return fmt::format(R"(
mortise: 1
name: drop
time: {{step: 1 ms, steps: 100}}
materials: {{steel: {{density: 7800}}, gel: {{youngs_modulus: 0.3 MPa, poisson_ratio: 0.4, density: 1000}}}}
bodies:
  ball: {{type: stiff, shape: {{sphere: {{radius: 8 mm, edge_length: 3 mm}}}}, material: steel, position: [0, 0, 38 mm]}}
{}
effects:
  gravity: {{}}
  inertia: {{integrator: {}}}
  affine_body: {{}}
  barrier_contact: {{}}
)",
                     under, inertia);
}
inline const std::string kPad =
    "  pad: {type: soft, shape: {box: {size: [30 mm, 30 mm, 10 mm], edge_length: 5 mm}}, material: gel, position: [0, 0, 5 mm]}";
inline const std::string kPadRests = "  elasticity: {}\n  pin: [{body: pad, where: {side: z_min}}]\n";

}  // namespace mortise::testing
