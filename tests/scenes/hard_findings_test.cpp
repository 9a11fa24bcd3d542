// Found by the hard cases and the fuzzer.
#include "scenes/rig.h"

// A block hangs from a side that moves sideways: it keeps its weight, and a step takes a few Newton iterations.
TEST(MovingSupport, GravityStays) {
  mortise::testing::Rig rig(R"(
mortise: 1
time: {step: 5 ms, steps: 4}
materials: {gel: {youngs_modulus: 0.1 MPa, poisson_ratio: 0.4, density: 1000}}
bodies: {block: {type: soft, shape: {box: {size: [1, 1, 3], edge_length: 0.5}}, material: gel}}
effects:
  inertia: {}
  gravity: {}
  elasticity: {}
  pin: {body: block, where: {side: z_max}, motion: {time: [0, 0.8], translation: [[0, 0, 0], [0.4, 0, 0]]}}
)");
  for (int i = 0; i < 4; ++i) {
    EXPECT_LE(rig.step().newton, 5);
    EXPECT_NEAR(rig.fields().at("balance/gravity_z"), -3000 * 9.81, 1e-6);
  }
}

// The flat end of a turned cylinder: its edges and triangles share a plane only up to rounding, and still nothing intersects.
TEST(SelfContact, FlatSidesDoNotIntersectThemselves) {
  mortise::testing::Rig rig(R"(
mortise: 1
time: {step: 3.80235 ms, steps: 1}
materials: {gel: {youngs_modulus: 3.65031 MPa, poisson_ratio: 0.324714, density: 359.296}}
bodies:
  tube:
    type: soft
    shape: {cylinder: {radius: 0.705174, height: 2.16499, edge_length: 0.647673}}
    material: gel
    position: [0.139226, 0.381516, 1.33997]
    self_contact: true
effects: {inertia: {}, elasticity: {}, barrier_contact: {d_hat: 0.0200199, stiffness: 1.93597 MPa, form: classic}}
)");
  EXPECT_LE(rig.step().newton, 5);
}

// A strip that is folded onto itself, with default settings: it may stop, but never crosses itself.
TEST(SelfContact, IsOnByDefault) {
  const std::string scene = R"(
mortise: 1
time: {mode: static, steps: 10}
materials: {sheet: {youngs_modulus: 1 MPa, poisson_ratio: 0.3, density: 1000}}
bodies: {strip: {type: soft, shape: {box: {size: [80 mm, 10 mm, 1 mm], edge_length: 4 mm}}, material: sheet}}
effects:
  elasticity: {}
  pin:
    - {body: strip, where: {box: {min: [-41 mm, -10 mm, -1 mm], max: [-9 mm, 10 mm, 1 mm]}}}
    - body: strip
      where: {side: x_max}
      motion:
        time: [0, 0.25, 0.5, 0.75, 1]
        translation: [[0, 0, 0], [-15 mm, 0, 25 mm], [-40 mm, 0, 30 mm], [-60 mm, 0, 22 mm], [-60 mm, 0, -3 mm]]
        rotation: {axis: [0, -1, 0], centre: [40 mm, 0, 0], angle: [0, 45 deg, 90 deg, 135 deg, 180 deg]}
  barrier_contact: {d_hat: 0.3 mm, stiffness: 100 kPa}
)";
  mortise::testing::Rig rig(scene);
  rig.steps(9);
  try {
    rig.step();
    ADD_FAILURE() << "the driven end has passed through the held part";
  } catch (const mortise::Error& e) {
    EXPECT_NE(std::string(e.what()).find("two parts of 'strip' meet"), std::string::npos) << e.what();
  }
  mortise::testing::Rig through(scene, {"bodies.strip.self_contact=false"});
  through.steps(10);
}
