// The step as a whole: moving supports, halving, failure that loses nothing, systems without a support of their own.
#include "rig.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

// A soft block between two stiff plates; the upper one is driven down by `travel`.
std::string pinch(const std::string& travel, const std::string& model) {
  return R"(
mortise: 1
name: pinch
time: {mode: static, steps: 4}
materials:
  rubber: {model: )" +
         model + R"(, youngs_modulus: 1 MPa, poisson_ratio: 0.3, density: 1000}
bodies:
  block: {type: soft, shape: {box: {size: [0.1, 0.1, 0.1], edge_length: 0.034}}, material: rubber}
  upper: {type: stiff, shape: {box: {size: [0.2, 0.2, 0.02], edge_length: 0.2}}, material: rubber, position: [0, 0, 0.0605]}
  lower: {type: stiff, shape: {box: {size: [0.2, 0.2, 0.02], edge_length: 0.2}}, material: rubber, position: [0, 0, -0.0605]}
effects:
  elasticity: {}
  affine_body: {stiffness: 10 MPa}
  pin:
    - {body: lower, where: {side: all}}
    - {body: upper, where: {side: all}, motion: {time: [0, 1], translation: [[0, 0, 0], [0, 0, )" +
         travel + R"(]]}}
  barrier_contact: {d_hat: 1 mm, stiffness: 50 kPa}
solver: {iterations: 60, halvings: 3, relative_tolerance: 1e-8, force_tolerance: 0 N}
)";
}

}  // namespace

// Without negative curvature in its matrix Newton's method needs several times the iterations here.
TEST(Solver, ExactHessianConvergesQuadratically) {
  Rig rig(R"(
mortise: 1
name: ball
time: {mode: static, steps: 5}
materials:
  rubber: {model: neo_hookean, youngs_modulus: 1 MPa, poisson_ratio: 0.4, density: 1000}
  hard: {model: neo_hookean, youngs_modulus: 100 MPa, poisson_ratio: 0.3, density: 1000}
bodies:
  pad: {type: soft, shape: {box: {size: [40 mm, 40 mm, 15 mm], edge_length: 5 mm}}, material: rubber}
  ball: {type: soft, shape: {sphere: {radius: 8 mm, edge_length: 3 mm}}, material: hard, position: [1 mm, 0.6 mm, 16 mm]}
effects:
  elasticity: {}
  pin:
    - {body: pad, where: {side: z_min}}
    - {body: ball, where: {box: {min: [-1, -1, 17 mm], max: [1, 1, 1]}}, motion: {time: [0, 1], translation: [[0, 0, 0], [0, 0, -5 mm]]}}
  barrier_contact: {d_hat: 0.5 mm, stiffness: 1 MPa}
)");
  Index most = 0;
  for (int i = 0; i < 5; ++i) most = std::max(most, rig.step().newton);
  std::printf("at most %d Newton iterations\n", static_cast<int>(most));
  EXPECT_LE(most, 14);
}

// Supports move in steps far larger than the gap; contact makes them wait, and they still arrive exactly.
TEST(Solver, DrivenPlatesReachTheirTargetsExactlyThroughContact) {
  Rig rig(pinch("-20 mm", "neo_hookean"));
  rig.steps(4);
  const Captured f = rig.fields();
  const auto u = f.point.at("displacement");
  const std::size_t block = rig.input.bodies[0].nodes.size(), upper = rig.input.bodies[1].nodes.size();
  for (std::size_t i = block; i < block + upper; ++i) EXPECT_NEAR(u[3 * i + 2], -0.020, 1e-15);
  for (std::size_t i = block + upper; i < u.size() / 3; ++i) EXPECT_EQ(u[3 * i + 2], 0);
  EXPECT_GT(f.at("barrier_contact/min_distance"), 0);
  EXPECT_NEAR(f.at("supports/upper_z"), -f.at("supports/lower_z"), 1e-6 * std::abs(f.at("supports/lower_z")));
  EXPECT_LT(f.at("supports/upper_z"), -100);
}

// H67: plates that would have to pass through each other end in a typed error within bounded time, and nothing has moved.
TEST(Solver, InfeasiblePinchStopsAndKeepsTheLastGoodState) {
  Rig rig(pinch("-200 mm", "neo_hookean"));
  int good = 0;
  std::vector<double> before;
  engine::Outcome outcome;
  solver::StepReport report;
  for (; good < 4; ++good) {
    before = rig.engine->points();
    outcome = rig.engine->step({}, report);
    if (outcome.code != 0) break;
  }
  ASSERT_EQ(outcome.code, static_cast<int>(Exit::solve)) << "it went through";
  EXPECT_NE(outcome.message.find("failed"), std::string::npos) << outcome.message;
  EXPECT_EQ(rig.engine->points(), before);
  EXPECT_EQ(rig.engine->steps_done(), good);
}

TEST(Solver, StopRequestLeavesTheStateOfTheLastStep) {
  Rig rig(pinch("-20 mm", "neo_hookean"));
  rig.step();
  const auto before = rig.engine->points();
  solver::StepReport report;
  int asked = 0;
  const engine::Outcome outcome = rig.engine->step([&] { return ++asked > 2; }, report);
  EXPECT_EQ(outcome.code, static_cast<int>(Exit::stopped));
  EXPECT_EQ(rig.engine->points(), before);
}

// H69: nothing resists the block's sideways motions, and rounding must not decide how far it goes along them.
TEST(Solver, BlockHeldByContactAloneStaysInItsPlace) {
  for (const std::string effect : {"barrier_contact={d_hat: 5 mm, stiffness: 0.1 MPa}",
                                   "mortar_contact={d_hat: 5 mm, pairs: [{slave: block, master: upper}, {slave: block, master: lower}]}"}) {
    Rig rig(R"(
mortise: 1
name: held
time: {mode: static, steps: 5}
materials:
  gel: {youngs_modulus: 0.1 MPa, poisson_ratio: 0.4, density: 1000}
bodies:
  block: {type: soft, shape: {box: {size: [1, 1, 0.5], edge_length: 0.25}}, material: gel}
  lower: {type: stiff, shape: {box: {size: [1.5, 1.5, 0.1], edge_length: 1.5}}, material: gel, position: [0, 0, -0.301]}
  upper: {type: stiff, shape: {box: {size: [1.5, 1.5, 0.1], edge_length: 1.5}}, material: gel, position: [0, 0, 0.301]}
effects:
  elasticity: {}
  pin:
    - {body: lower, where: {side: all}}
    - {body: upper, where: {side: all}, motion: {time: [0, 1], translation: [[0, 0, 0], [0, 0, -0.05]]}}
)",
            {"effects." + effect});
    rig.steps(5);
    const auto u = rig.fields().point.at("displacement");
    Vec3 mean = Vec3::Zero();
    const std::size_t nodes = rig.input.bodies[0].nodes.size();
    for (std::size_t i = 0; i < nodes; ++i) mean += Vec3(u[3 * i], u[3 * i + 1], u[3 * i + 2]) / static_cast<double>(nodes);
    std::printf("%s: %.1e %.1e\n", effect.substr(0, 6).c_str(), mean.x(), mean.y());
    EXPECT_LT(std::hypot(mean.x(), mean.y()), 1e-4) << effect;
  }
}

// Both linear solvers find the same equilibrium. Plates without friction let the block slide: how far is nobody's to say.
TEST(Solver, ConjugateGradientsAgreeWithTheDirectSolver) {
  Rig direct(pinch("-10 mm", "corotated"), {"solver.linear=direct"}),
      cg(pinch("-10 mm", "corotated"), {"solver.linear=cg", "solver.cg_tolerance=1e-10", "solver.cg_forcing=fixed"});
  direct.steps(2);
  cg.steps(2);
  EXPECT_GT(cg.engine->linear_solver().find("cg") == 0, 0);
  const auto a = direct.engine->points(), b = cg.engine->points();
  Vec3 slid = Vec3::Zero();
  const std::size_t n = direct.input.bodies[0].nodes.size();
  for (std::size_t i = 0; i < n; ++i) slid += Vec3(b[3 * i] - a[3 * i], b[3 * i + 1] - a[3 * i + 1], 0) / static_cast<double>(n);
  EXPECT_LT(slid.norm(), 1e-6);
  for (std::size_t i = 0; i < n; ++i)
    for (int k = 0; k < 3; ++k) ASSERT_NEAR(a[3 * i + k] + slid[k], b[3 * i + k], 1e-9);
}

// A bar under its supports' stretch: linear elasticity has one exact answer, sigma = E eps.
TEST(Solver, UniaxialStretchIsHookesLaw) {
  Rig rig(R"(
mortise: 1
name: bar
time: {mode: static, steps: 1}
materials:
  steel: {model: linear, youngs_modulus: 2 MPa, poisson_ratio: 0.25, density: 1000}
bodies:
  bar: {type: soft, shape: {box: {size: [0.1, 0.2, 0.4], edge_length: 0.1}}, material: steel}
effects:
  elasticity: {}
  pin:
    - {body: bar, where: {side: z_min}, axes: z}
    - {body: bar, where: {side: z_max}, axes: z, motion: {time: [0, 1], translation: [[0, 0, 0], [0, 0, 4 mm]]}}
    - {body: bar, where: {side: x_min}, axes: x}
    - {body: bar, where: {side: y_min}, axes: y}
solver: {relative_tolerance: 1e-13, force_tolerance: 0 N}
)");
  rig.step();
  const Captured f = rig.fields();
  const double stress = 2e6 * 0.004 / 0.4, area = 0.1 * 0.2;
  const auto& sigma = f.cell.at("cauchy_stress");
  for (std::size_t c = 0; c < sigma.size() / 6; ++c) {
    EXPECT_NEAR(sigma[6 * c + 2], stress, 1e-8 * stress);
    for (int k : {0, 1, 3, 4, 5}) EXPECT_NEAR(sigma[6 * c + k], 0, 1e-8 * stress);
  }
  const auto& support = f.point.at("support_force");
  double top = 0;
  for (std::size_t i = 0; i < rig.input.bodies[0].nodes.size(); ++i)
    if (rig.input.bodies[0].nodes[i][2] > 0.19) top += support[3 * i + 2];
  EXPECT_NEAR(top, stress * area, 1e-8 * stress * area);
}
