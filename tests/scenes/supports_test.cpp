// Supports on their way: in statics, and beside steps that fall back to first order.
#include "rig.h"

using namespace mortise;
using namespace mortise::testing;

// Where they meet nothing, all energy there is may be rounding: a roller 8 m above a pad took 46 iterations a step.
TEST(Supports, ThatMeetNothingTakeAStepAtOnce) {
  Rig rig(R"(
mortise: 1
name: far
time: {mode: static, steps: 3}
materials: {steel: {density: 7850}, gel: {youngs_modulus: 0.3 MPa, poisson_ratio: 0.45, density: 1050}}
bodies:
  pad: {type: soft, shape: {box: {size: [24 mm, 6 mm, 4 mm], edge_length: 1 mm}}, material: gel, position: [0, 0, -2 mm]}
  roller: {type: stiff, shape: {cylinder: {radius: 8 mm, height: 6 mm, edge_length: 2 mm}}, material: steel, rotation: {axis: [1, 0, 0], angle: 90 deg}, position: [0, 0, 8]}
effects:
  elasticity: {}
  pin:
    - {body: pad, where: {side: z_min}}
    - {body: roller, where: {side: all}, motion: {time: [0, 0.5, 1], translation: [[0, 0, 0], [0, 0, -0.52 mm], [0.3 mm, 0, -0.52 mm]]}}
  mortar_contact: {pairs: [{slave: pad, master: roller}]}
  friction: {follows: mortar_contact, mu: 0.5}
)");
  for (int i = 0; i < 3; ++i) EXPECT_LE(rig.step().newton, 2);
}

// Where a box that strikes and slips makes a step fall back to backward Euler, the belt under it goes on by BDF2: of its acceleration the step would
// make a half, and the one after it 7/4.
TEST(Supports, GoOnWhereAStepFallsBack) {
  Rig rig(R"(
mortise: 1
name: belt
time: {step: 5 ms, steps: 40}
materials: {wood: {density: 700}}
bodies:
  box: {type: stiff, shape: {box: {size: [80 mm, 60 mm, 50 mm], edge_length: 20 mm}}, material: wood, position: [0, 0, 25.2 mm]}
  belt: {type: stiff, shape: {box: {size: [2 m, 200 mm, 20 mm], edge_length: 200 mm}}, material: wood, position: [0, 0, -10 mm]}
effects:
  inertia: {integrator: bdf2}
  gravity: {}
  affine_body: {}
  pin: [{body: belt, where: {side: all}, motion: {time: [0, 0.2], translation: [[0, 0, 0], [30 mm, 0, 0]], interpolation: smooth}}]
  barrier_contact: {}
  friction: {follows: barrier_contact, mu: 0.8}
)");
  const double mass = 700 * 2 * 0.2 * 0.02;
  int first_order = 0;
  for (int i = 1; i <= 38; ++i) {
    first_order += rig.step().first_order;
    const Captured f = rig.fields();
    const double s = i * 0.005 / 0.2, a = 0.03 * (6 - 12 * s) / (0.2 * 0.2);
    if (i > 2) EXPECT_NEAR(f.at("supports/belt_x") + f.at("friction/force_belt_x"), mass * a, 0.02 * mass * 4.5) << i;
    if (i == 3) rig.resume();
  }
  EXPECT_GT(first_order, 0) << "else this test shows nothing";
}
