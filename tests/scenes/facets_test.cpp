// Facets of what presses, against the force that is missing for them (audit/facet_depth.h).
#include <fmt/format.h>

#include "audit/field_errors.h"
#include "audited.h"
#include "rig.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

struct Pressed {
  double force;
  audit::FieldErrors::Result errors;
};

// A stiff body is pressed into a pad by 1 mm.
Pressed press(const std::string& body, const std::string& effects, const std::string& supports = "supports/tip_z") {
  Rig rig(fmt::format(R"(
mortise: 1
name: facets
time: {{mode: static, steps: 2}}
materials:
  gel: {{youngs_modulus: 0.2 MPa, poisson_ratio: 0.35, density: 1050}}
  steel: {{density: 7850}}
bodies:
  pad: {{type: soft, order: 2, shape: {{box: {{size: [20 mm, 20 mm, 8 mm], edge_length: 2.5 mm}}}}, material: gel, position: [0, 0, -4 mm]}}
  tip: {{type: stiff, {}, material: steel}}
effects:
  elasticity: {{}}
  barrier_contact: {{d_hat: 0.01 mm}}
{})",
                      body, effects));
  audit::FieldErrors errors(rig.input);
  Captured said;
  for (int i = 1; i <= 2; ++i) rig.step(), said = rig.fields(), errors.state(said, i / 2.0);
  return {said.has(supports) ? std::abs(said.at(supports)) : 0, errors.result()};
}

std::string pins(double down) {
  return fmt::format(
      "  pin:\n    - {{body: pad, where: {{side: z_min}}}}\n    - {{body: tip, where: {{side: all}}, motion: {{time: [0, 1], translation: [[0, 0, "
      "0], "
      "[0, 0, {} mm]]}}}}\n",
      -down);
}

std::string ball(double edge) { return fmt::format("shape: {{sphere: {{radius: 8 mm, edge_length: {} mm}}}}, position: [0, 0, 8.1 mm]", edge); }
std::string cylinder(double edge, const std::string& how) {
  return fmt::format("shape: {{cylinder: {{radius: 5 mm, height: 12 mm, edge_length: {} mm}}}}, {}", edge, how);
}

}  // namespace

TEST(Facets, OfABallAreWhatItsForceFallsShortBy) {
  const double truth = press(ball(0.7), pins(1.1)).force;
  for (const double edge : {4.5, 3.0, 2.0}) {
    const Pressed coarse = press(ball(edge), pins(1.1));
    const double missing = 1 - coarse.force / truth, told = 1.5 * coarse.errors.facets;
    EXPECT_GT(missing, 0.02);
    EXPECT_GT(told, 0.6 * missing) << edge;
    EXPECT_LT(told, 2 * missing + 0.02) << edge;
  }
}

// A cylinder's count where it lies, and not where it stands on its end; a box has none.
TEST(Facets, CountWhereTheyPress) {
  const Pressed lies = press(cylinder(3, "position: [0, 0, 5.1 mm], rotation: {axis: [1, 0, 0], angle: 90 deg}"), pins(1.1));
  const Pressed stands = press(cylinder(3, "position: [0, 0, 6.1 mm]"), pins(0.6));
  EXPECT_GT(lies.errors.facets, 0.05);
  EXPECT_LT(stands.errors.facets, 0.002);
  EXPECT_TRUE(std::isnan(press("shape: {box: {size: [10 mm, 10 mm, 10 mm], edge_length: 5 mm}}, position: [0, 0, 5.1 mm]", pins(0.6)).errors.facets));
}

// A flat follower on a spring, on an eccentric disc that a motor turns: without facets the torque is N e sin(angle).
TEST(Facets, LetTorqueJump) {
  for (const double edge : {5.0, 2.0}) {
    Rig rig(fmt::format(R"(
mortise: 1
name: cam
time: {{step: 4 ms, steps: 150}}
materials: {{steel: {{density: 7850}}}}
bodies:
  cam:
    {{type: stiff, shape: {{cylinder: {{radius: 20 mm, height: 10 mm, edge_length: {} mm}}}}, material: steel,
     rotation: {{axis: [1, 0, 0], angle: 90 deg}}, position: [0, 0, -4 mm]}}
  follower: {{type: stiff, shape: {{box: {{size: [50 mm, 10 mm, 10 mm], edge_length: 10 mm}}}}, material: steel, position: [0, 0, 21.1 mm]}}
effects:
  inertia: {{}}
  gravity: {{}}
  affine_body: {{}}
  joint:
    - {{name: shaft, type: revolute, body: cam, at: [0, 0, 0], axis: [0, 1, 0]}}
    - {{name: guide, type: prismatic, body: follower, at: [0, 0, 21.1 mm], axis: [0, 0, 1]}}
  drive:
    - {{joint: shaft, mode: kinematic, angle: {{time: [0, 0.6], value: [0, 6.2832]}}}}
    - {{joint: guide, mode: passive, stiffness: 500, rest: -10 mm}}
  barrier_contact: {{pairs: [[cam, follower]]}}
)",
                        edge));
    double worst = 0, largest = 0;
    int step = 0;
    const audit::EnergyAudit::Result energy = audited(rig, 150, [&](const solver::StepReport&, const Captured& said) {
      if (++step < 5) return;  // it starts at once
      const double torque = said.at("drive/shaft_torque"), N = said.at("barrier_contact/force_follower_z");
      worst = std::max(worst, std::abs(std::abs(torque) - std::abs(N * 4e-3 * std::sin(said.at("joint/shaft_angle")))));
      largest = std::max(largest, std::abs(torque));
    });
    EXPECT_GT(worst, 0.1 * largest) << edge;
    EXPECT_GT(energy.facet_torque, 0.5 * worst / largest) << edge;
    EXPECT_LT(energy.facet_torque, 2 * worst / largest) << edge;
  }
}

// What presses a disc along its axis has no torque, wherever it does: 20 N on the flat face, rubbed with mu = 0.4, ask for 2/3 mu N R.
TEST(Facets, AreNotWhatAFlatFaceLiesOn) {
  Rig rig(R"(
mortise: 1
name: disc
time: {step: 5 ms, steps: 60}
bodies:
  slide: {type: stiff, shape: {box: {size: [20 mm, 20 mm, 10 mm], edge_length: 20 mm}}, mass: 0.1, position: [0, 0, 25 mm]}
  disc: {type: stiff, shape: {cylinder: {radius: 15 mm, height: 8 mm, edge_length: 4 mm}}, mass: 0.1, position: [0, 0, 4.05 mm]}
  floor: {type: half_space}
effects:
  inertia: {}
  affine_body: {}
  joint:
    - {name: z, type: prismatic, body: slide, axis: [0, 0, -1]}
    - {name: h, type: revolute, body: disc, to: slide, axis: [0, 0, 1], at: [0, 0, 15 mm]}
  drive:
    - {joint: z, mode: effort, force: {time: [0, 50 ms], value: [0, 20]}, damping: 2}
    - {joint: h, mode: kinematic, angle: {time: [0, 0.1, 0.3], value: [0, 0, 0.8]}}
  mortar_contact: {pairs: [{slave: disc, master: floor}]}
  friction: {follows: mortar_contact, mu: 0.4}
)");
  double torque = 0;
  const audit::EnergyAudit::Result energy =
      audited(rig, 60, [&](const solver::StepReport&, const Captured& said) { torque = std::abs(said.at("drive/h_torque")); });
  EXPECT_NEAR(torque, 2.0 / 3 * 0.4 * 20 * 0.015, 0.04 * 0.08);
  EXPECT_FALSE(energy.facet_torque > 0.01);
}
