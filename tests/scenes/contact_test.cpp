// Contact and friction against closed forms.
#include "measured.h"
#include "rig.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

// A stiff block on a slope, given as a horizontal floor under inclined gravity of angle th.
std::string incline(double th, double mu) {
  return R"(
mortise: 1
name: incline
time: {step: 10 ms, steps: 100}
materials:
  steel: {density: 1000}
bodies:
  block: {type: stiff, shape: {box: {size: [0.2, 0.2, 0.1], edge_length: 0.05}}, material: steel, position: [0, 0, 0.0509]}
  floor: {type: half_space}
effects:
  inertia: {}
  gravity: {acceleration: [)" +
         std::to_string(9.81 * std::sin(th)) + ", 0, " + std::to_string(-9.81 * std::cos(th)) + R"(]}
  affine_body: {stiffness: 10 MPa}
  barrier_contact: {d_hat: 1 mm, stiffness: 10 kPa}
  friction: {follows: barrier_contact, mu: )" +
         std::to_string(mu) + R"(, creep_speed: 1e-5 m/s, lag_tolerance: 1e-5}
solver: {relative_tolerance: 1e-9, force_tolerance: 0 N}
)";
}

double slip(Rig& rig) { return rig.fields().point.at("displacement")[0]; }

}  // namespace

// B15: slope of 26.565 deg (tan = 0.5). Below that mu the block slides with a = g (sin th - mu cos th), above it rests.
TEST(Contact, BlockOnAnInclineSlidesWithTheRightAcceleration) {
  const double th = std::atan(0.5), mu = 0.2, g = 9.81, dt = 0.01;
  Rig rig(incline(th, mu));
  rig.steps(60);
  const double x0 = slip(rig);
  rig.step();
  const double x1 = slip(rig);
  rig.steps(20);
  const double x2 = slip(rig);
  rig.step();
  const double x3 = slip(rig);
  const double a = ((x3 - x2) - (x1 - x0)) / (dt * 21 * dt);
  EXPECT_NEAR(a, g * (std::sin(th) - mu * std::cos(th)), 0.005 * a);
}

// B16: with f1(y) = 2y - y^2 what sticks gives way by creep_speed dt (1 - sqrt(1 - tan th / mu)), once.
TEST(Contact, BlockOnAnInclineSticks) {
  const double th = std::atan(0.5), mu = 0.8;
  Rig rig(incline(th, mu));
  rig.steps(60);
  const double x0 = slip(rig);
  rig.steps(40);
  EXPECT_NEAR(slip(rig), x0, 1e-4 * 1e-5 * 0.4);
}

// B26: at rest the force through the interface below block k is the weight above it.
TEST(Contact, TowerCarriesItsWeight) {
  Rig rig(R"(
mortise: 1
name: tower
time: {step: 20 ms, steps: 200}
materials:
  rubber: {model: neo_hookean, youngs_modulus: 1 MPa, poisson_ratio: 0.3, density: 1000}
bodies:
  lower: {type: soft, shape: {box: {size: [0.1, 0.1, 0.1], edge_length: 0.034}}, material: rubber, position: [0, 0, 0.05095]}
  upper: {type: soft, shape: {box: {size: [0.08, 0.08, 0.1], edge_length: 0.027}}, material: rubber, position: [0, 0, 0.1519]}
  floor: {type: half_space}
effects:
  inertia: {}
  gravity: {acceleration: [0, 0, -9.81]}
  elasticity: {}
  barrier_contact: {d_hat: 1 mm, stiffness: 20 kPa}
solver: {relative_tolerance: 1e-9, force_tolerance: 1e-10 N}
)");
  rig.steps(200);
  const Captured f = rig.fields();
  const double lower = 0.001 * 1000 * 9.81, upper = 0.08 * 0.08 * 0.1 * 1000 * 9.81;
  measured("upper", f.at("barrier_contact/force_upper_z") / upper - 1), measured("lower", f.at("barrier_contact/force_lower_z") / lower - 1);
  EXPECT_NEAR(f.at("barrier_contact/force_upper_z"), upper, 1e-6 * upper);
  EXPECT_NEAR(f.at("barrier_contact/force_lower_z"), lower, 1e-6 * lower);
  EXPECT_NEAR(f.at("balance/barrier_contact_z"), lower + upper, 1e-6 * lower);
  EXPECT_NEAR(f.at("balance/defect_z"), 0, 1e-8);
}

// B27 under a load: the gap of a block pressed on a plane solves p/kappa = (1-t)(1/t - 1 - 2 ln t).
TEST(Contact, GapUnderUniformPressureIsThatOfTheBarrier) {
  Rig rig(R"(
mortise: 1
name: gap
time: {mode: static, steps: 1}
materials:
  rubber: {model: linear, youngs_modulus: 1 MPa, poisson_ratio: 0, density: 1000}
bodies:
  block: {type: soft, shape: {box: {size: [0.1, 0.1, 0.05], edge_length: 0.05}}, material: rubber, position: [0, 0, 0.0259]}
  floor: {type: half_space}
effects:
  elasticity: {}
  pin: [{body: block, where: {side: all}, axes: xy}]
  pressure_load: [{body: block, where: {side: z_max}, pressure: 1 kPa}]
  barrier_contact: {d_hat: 1 mm, stiffness: 10 kPa}
solver: {relative_tolerance: 1e-12, force_tolerance: 0 N}
)");
  rig.step();
  const Captured f = rig.fields();
  // p / kappa = 0.1: t = 0.82853.
  const auto u = f.point.at("displacement");
  double gap = INFINITY;
  for (std::size_t i = 0; i < u.size() / 3; ++i) gap = std::min(gap, rig.input.bodies[0].nodes[i][2] + u[3 * i + 2]);
  EXPECT_NEAR(gap / 1e-3, 0.82853, 1e-5);
  EXPECT_NEAR(f.at("balance/barrier_contact_z"), 10, 1e-9);
  // The block may not have moved a pinned direction.
  for (std::size_t i = 0; i < u.size() / 3; ++i) EXPECT_LT(std::abs(u[3 * i]) + std::abs(u[3 * i + 1]), 1e-15);
}

// B29: two free bodies collide; contact forces cancel, so momentum stays to round-off of the solve.
TEST(Contact, CollisionKeepsMomentum) {
  Rig rig(R"(
mortise: 1
name: collision
time: {step: 2 ms, steps: 60}
materials:
  rubber: {model: neo_hookean, youngs_modulus: 0.1 MPa, poisson_ratio: 0.4, density: 1000}
bodies:
  ball: {type: soft, shape: {sphere: {radius: 0.05, edge_length: 0.02}}, material: rubber, position: [-0.06, 0.01, 0], velocity: [1, 0, 0]}
  block: {type: stiff, shape: {box: {size: [0.1, 0.1, 0.1], edge_length: 0.05}}, material: rubber, position: [0.06, 0, 0], rotation: {axis: [1, 1, 0], angle: 30 deg}}
effects:
  inertia: {}
  elasticity: {}
  affine_body: {stiffness: 10 MPa}
  barrier_contact: {d_hat: 1 mm, stiffness: 50 kPa}
solver: {relative_tolerance: 1e-13, force_tolerance: 1e-13 N}
)");
  double before[3], most_pairs = 0;
  rig.step();
  const char* axes[] = {"inertia/momentum_x", "inertia/momentum_y", "inertia/momentum_z"};
  for (int k = 0; k < 3; ++k) before[k] = rig.fields().at(axes[k]);
  for (int n = 0; n < 59; ++n) {
    rig.step();
    most_pairs = std::max(most_pairs, rig.fields().at("barrier_contact/active_pairs"));
  }
  EXPECT_GT(most_pairs, 0) << "they never met";
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(rig.fields().at(axes[k]), before[k], 1e-10 * before[0]) << axes[k];
}

// A stiff box that spins on its face is stopped as one that is pressed evenly: T = mu m g r, r = 0.3826 a the mean distance of a square's points from
// its centre (on four corners it was 1.85 times that). What is pinned stays as it was meshed.
TEST(Contact, AStiffBoxPressesWithMoreThanItsCorners) {
  Rig rig(R"(
mortise: 1
name: spin
time: {step: 1 ms, steps: 50}
materials: {wood: {density: 1000}}
bodies:
  box: {type: stiff, shape: {box: {size: [30 mm, 30 mm, 10 mm], edge_length: 30 mm}}, material: wood, position: [0, 0, 5.03 mm], angular_velocity: [0, 0, 30]}
  post: {type: stiff, shape: {box: {size: [30 mm, 30 mm, 10 mm], edge_length: 30 mm}}, material: wood, position: [0.2, 0, 5.03 mm]}
  floor: {type: half_space}
effects: {inertia: {}, gravity: {}, affine_body: {}, barrier_contact: {}, friction: {mu: 0.3}, pin: [{body: post, where: {side: all}}]}
)");
  EXPECT_EQ(rig.input.bodies[0].nodes.size(), 98u);
  EXPECT_EQ(rig.input.bodies[1].nodes.size(), 8u);
  const double a = 0.03, m = 1000 * a * a * 0.01, lost = 0.3 * m * 9.81 * 0.3826 * a * 0.05;
  rig.steps(50);
  EXPECT_NEAR(m * a * a / 6 * 30 - rig.fields().at("inertia/angular_momentum_z"), lost, 0.12 * lost);
}
