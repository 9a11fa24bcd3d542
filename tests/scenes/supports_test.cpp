// Supports on their way in statics.
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
