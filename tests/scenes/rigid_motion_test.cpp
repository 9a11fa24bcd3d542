// Bodies that slide, roll, turn and fly, against closed forms: what robots are made of.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "audit/measured_body.h"
#include "geometry/primitives.h"
#include "measured.h"
#include "rig.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

constexpr double kGravity = 9.81;

// Centre, axes and their rates of a stiff body from where its points are: x = p + A X, X from the centre at rest.
struct Affine {
  Vec3 p;
  Mat3 A;
};
Affine pose_of(const Rig& rig, const std::string& name, const Vec3& centre) {
  std::size_t first = 0;
  for (const model::BodyInput& b : rig.input.bodies) {
    if (b.name != name) {
      first += b.nodes.size();
      continue;
    }
    const std::vector<double> x = rig.engine->points();
    const std::size_t n = b.nodes.size();
    Eigen::MatrixXd X(n, 4), Y(n, 3);
    for (std::size_t i = 0; i < n; ++i) {
      X.row(i) << 1, (b.nodes[i] - centre).transpose();
      for (int c = 0; c < 3; ++c) Y(i, c) = x[3 * (first + i) + c];
    }
    const Eigen::MatrixXd fit = X.colPivHouseholderQr().solve(Y);
    return {fit.row(0).transpose(), fit.bottomRows(3).transpose()};
  }
  ADD_FAILURE() << "no body " << name;
  return {};
}
Vec3 spin(const Affine& before, const Affine& after, double h) {
  const Eigen::AngleAxisd turn(Mat3(after.A * before.A.inverse()));
  return turn.angle() / h * turn.axis();
}

std::string number(double x) {
  char out[40];
  std::snprintf(out, sizeof out, "%.17g", x);
  return out;
}

std::string ramp(double mu) {
  const double th = M_PI / 6;
  return R"(
mortise: 1
time: {step: 10 ms, steps: 100}
materials: {steel: {density: 1000}}
bodies:
  block: {type: stiff, shape: {box: {size: [0.2, 0.2, 0.1], edge_length: 0.1}}, material: steel, position: [0, 0, 0.0509]}
  floor: {type: half_space}
effects:
  inertia: {}
  gravity: {acceleration: [)" +
         number(kGravity * std::sin(th)) + ", 0, " + number(-kGravity * std::cos(th)) + R"(]}
  affine_body: {stiffness: 10 MPa}
  barrier_contact: {d_hat: 1 mm, stiffness: 10 kPa}
  friction: {follows: barrier_contact, mu: )" +
         number(mu) + "}\n";
}

}  // namespace

// Hundreds of steps: seconds, and minutes where memory is guarded.
class LongMotion : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* device = std::getenv("MORTISE_TEST_DEVICE");
    if (device != nullptr && std::string(device) == "debug") GTEST_SKIP() << "too slow on this device";
  }
};

// A block on a ramp of 30 deg goes with a = g (sin th - mu cos th), or rests, as mu is below or above tan th = 0.577.
TEST(RigidMotion, ARampOfThirtyDegreesLetsGoBelowItsTangent) {
  const double th = M_PI / 6, h = 0.01;
  for (int i = 0; i <= 7; ++i) {
    const double mu = i / 7.0, a = kGravity * (std::sin(th) - mu * std::cos(th));
    Rig rig(ramp(mu));
    const Vec3 centre(0, 0, 0.0509);
    rig.steps(40);  // it has come down
    const double x0 = pose_of(rig, "block", centre).p[0];
    rig.step();
    const double x1 = pose_of(rig, "block", centre).p[0];
    rig.steps(39);
    const double x2 = pose_of(rig, "block", centre).p[0];
    rig.step();
    const double x3 = pose_of(rig, "block", centre).p[0];
    measured("mu_" + std::to_string(i) + "_7", i <= 4 ? ((x3 - x2) - (x1 - x0)) / (40 * h * h) : (x3 - x1) / (40 * h));
    measured("mu_" + std::to_string(i) + "_7_exact", i <= 4 ? a : 0);
    if (i <= 4)
      EXPECT_NEAR(((x3 - x2) - (x1 - x0)) / (40 * h * h), a, 0.005 * a) << "mu " << i << "/7";
    else
      EXPECT_NEAR((x3 - x1) / (40 * h), 0, 1e-4 * 1e-5) << "mu " << i << "/7";
  }
}

// A box on a disc that turns faster and faster slips where w^2 r = mu g (its tangential acceleration is 3 % of that and counts by its square).
TEST_F(LongMotion, ATurntableLetsGoWhereItThrowsHarderThanFrictionHolds) {
  const double r = 1.5, mu = 0.5, w0 = 1.75, alpha = 0.1, h = 0.01;
  std::string time, angle;
  const int n = 150;
  for (int k = 0; k <= n; ++k) {
    const double t = k * h;
    time += (k ? ", " : "") + number(t), angle += (k ? ", " : "") + number(w0 * t + 0.5 * alpha * t * t);
  }
  Rig rig(R"(
mortise: 1
time: {step: 10 ms, steps: 150}
materials: {steel: {density: 1000}}
bodies:
  disc: {type: stiff, shape: {cylinder: {radius: 2, height: 0.1, edge_length: 0.5}}, material: steel, position: [0, 0, -0.05]}
  box: {type: stiff, shape: {box: {size: [0.1, 0.1, 0.05], edge_length: 0.05}}, material: steel, position: [1.5, 0, 0.0259], velocity: [0, )" +
          number(w0 * r) + R"(, 0], angular_velocity: [0, 0, )" + number(w0) + R"(]}
effects:
  inertia: {}
  gravity: {}
  affine_body: {}
  pin: [{body: disc, where: {side: all}, motion: {time: [)" +
          time + "], rotation: {axis: [0, 0, 1], angle: [" + angle + R"(]}}}]
  barrier_contact: {d_hat: 1 mm}
  friction: {follows: barrier_contact, mu: 0.5}
)");
  double slipped = 0, before = 0;
  for (int k = 0; k < n && slipped == 0; ++k) {
    rig.step();
    const double radius = pose_of(rig, "box", Vec3(r, 0, 0.0259)).p.head<2>().norm();
    if (k > 20 && (radius - before) / h > 1e-3) slipped = w0 + alpha * (k + 1) * h;
    before = radius;
  }
  measured("slips_at", slipped), measured("slips_at_exact", std::sqrt(mu * kGravity / r));
  EXPECT_NEAR(slipped, std::sqrt(mu * kGravity / r), 0.02 * slipped);
}

// A ball that starts sliding at v0 slows down by mu g and turns by 5 mu g t / 2 R, until it rolls at t = 2 v0 / 7 mu g with 5 v0 / 7.
TEST_F(LongMotion, ABowlingBallSlidesThenRolls) {
  const double v0 = 5, mu = 0.2, R = 0.1, h = 2e-3, rolls = 2 * v0 / (7 * mu * kGravity);
  Rig rig(R"(
mortise: 1
time: {step: 2 ms, steps: 500}
bodies:
  ball: {type: stiff, shape: {sphere: {radius: 0.1, edge_length: 0.01}}, mass: 1, inertia: {moments: [4e-3, 4e-3, 4e-3]}, position: [0, 0, 0.1005], velocity: [5, 0, 0]}
  floor: {type: half_space}
effects:
  inertia: {integrator: bdf2}  # backward Euler loses (w h)^2 / 2 of a turn's rate per step, 13 % here
  gravity: {}
  affine_body: {}
  barrier_contact: {d_hat: 1 mm}
  friction: {follows: barrier_contact, mu: 0.2}
)");
  const auto state = [&](int steps, Vec3& v, Vec3& w) {
    rig.steps(steps - 10);
    const Affine a = pose_of(rig, "ball", Vec3(0, 0, 0.1005));
    rig.steps(10);
    const Affine b = pose_of(rig, "ball", Vec3(0, 0, 0.1005));
    v = (b.p - a.p) / (10 * h), w = spin(a, b, 10 * h);
  };
  Vec3 v, w;
  state(260, v, w);  // the velocities of the ten steps' middle
  const double t = 255 * h;
  EXPECT_NEAR(v[0], v0 - mu * kGravity * t, 0.01 * v[0]);
  EXPECT_NEAR(w[1], 2.5 * mu * kGravity * t / R, 0.01 * w[1]);
  state(130, v, w);
  measured("rolls_with", v[0]), measured("rolls_with_exact", 5 * v0 / 7), measured("rolls_turn", w[1] * R);
  ASSERT_GT(385 * h, rolls);
  EXPECT_NEAR(v[0], 5 * v0 / 7, 0.01 * v[0]);
  EXPECT_NEAR(w[1] * R, v[0], 0.01 * v[0]);
  EXPECT_LT(std::abs(v[1]), 0.01 * v0);
}

// A belt over half a drum, pulled over it against a weight: T2 / T1 = exp(mu pi R / (R + t / 2)): friction acts on its inner side, tension in its
// middle.
TEST_F(LongMotion, ABeltSlidesOverADrumAsTheCapstanSays) {
  const double R = 0.05, thick = 0.5e-3, wide = 4e-3, tail = 0.02, mu = 0.3, gap = 2e-5, T1 = 1;
  const double middle = R + gap + 0.5 * thick, length = M_PI * middle + 2 * tail;
  geometry::TetMesh belt = geometry::box(Vec3(length, wide, thick), std::array<Index, 3>{72, 2, 1});
  for (Vec3& x : belt.points) {
    const double s = x[0] + 0.5 * length - tail, reach = middle + x[2], angle = std::clamp(s / middle, 0.0, M_PI);
    const double straight = s < 0 ? s : s > M_PI * middle ? M_PI * middle - s : 0;
    x = Vec3(-reach * std::cos(angle), x[1], reach * std::sin(angle) + straight);
  }
  const std::string scene = R"(
mortise: 1
time: {step: 8 ms, steps: 50}
materials: {rubber: {youngs_modulus: 20 MPa, poisson_ratio: 0.3, density: 1000}}
bodies:
  drum: {type: stiff, mass: 1, shape: {cylinder: {radius: 50 mm, height: 12 mm, edge_length: 5 mm}}, rotation: {axis: [1, 0, 0], angle: 90 deg}}
  belt: {type: soft, shape: {box: {size: [1, 1, 1], edge_length: 1}}, material: rubber}
effects:
  inertia: {}
  elasticity: {}
  affine_body: {}
  barrier_contact: {d_hat: 0.1 mm}
  friction: {follows: barrier_contact, mu: 0.3, creep_speed: 0.1 mm/s}
  pin:
    - {body: drum, where: {side: all}}
    - {body: belt, where: {box: {min: [0.04, -1, -0.021], max: [0.06, 1, -0.0199]}}, axes: z, motion: {time: [0.04, 0.4], translation: [[0, 0, 0], [0, 0, -9 mm]]}}
  pressure_load: [{body: belt, where: {box: {min: [-0.06, -1, -0.021], max: [-0.04, 1, -0.0199]}}, traction: [0, 0, )" +
                            number(-T1 / (wide * thick)) + R"(], traction_factor: {time: [0, 0.04], value: [0, 1]}}]
)";
  model::ModelInput input = engine::make_input(scene::read_scene_text(scene, "belt.yaml", {}, engine::effect_tables()).root);
  model::set_mesh(input.bodies[1], belt);
  Rig rig(std::move(input));
  rig.steps(30);
  double sum = 0, least = INFINITY, most = 0;
  for (int k = 0; k < 20; ++k) {
    rig.step();
    const double T2 = -rig.fields().at("supports/belt_z");
    sum += T2, least = std::min(least, T2), most = std::max(most, T2);
  }
  const double expected = std::exp(mu * M_PI * R / (R + 0.5 * thick));
  measured("ratio", sum / 20 / T1), measured("ratio_exact", expected);
  EXPECT_NEAR(sum / 20 / T1, expected, 0.02 * expected) << least << " to " << most;
}

// A body that nothing touches. Backward Euler keeps sum m x x v but for h sum m v' x v in every step, which comes from its own update and is exact to
// rounding; the second-order formula loses two orders less. Both come to Euler's equations as steps get shorter.
TEST_F(LongMotion, AngularMomentumOfATumblingBodyIsThatOfTheIntegrator) {
  const auto scene = [](double h, const std::string& integrator) {
    return R"(
mortise: 1
time: {step: )" +
           number(h) + R"(, steps: 1000}
bodies:
  body: {type: stiff, shape: {box: {size: [0.1, 0.2, 0.3], edge_length: 0.3}}, mass: 1, inertia: {moments: [1e-2, 8e-3, 4e-3], products: [1e-3, 0, 0]},
         velocity: [0.3, 0.2, -0.1], angular_velocity: [0.5, 6, 0.3]}
effects:
  inertia: {integrator: )" +
           integrator + R"(}
  affine_body: {}
solver: {relative_tolerance: 1e-12}
)";
  };
  Mat3 I;
  I << 1e-2, 1e-3, 0, 1e-3, 8e-3, 0, 0, 0, 4e-3;
  const Mat3 S = 0.5 * I.trace() * Mat3::Identity() - I;  // int rho X X^T
  const auto momentum = [](Rig& rig) { return vector(rig.fields(), "inertia/angular_momentum_"); };
  {
    const double h = 2e-3;
    Rig rig(scene(h, "backward_euler"));
    const Vec3 start = I * Vec3(0.5, 6, 0.3);
    Affine q[3] = {pose_of(rig, "body", Vec3::Zero())};
    rig.step();
    q[1] = pose_of(rig, "body", Vec3::Zero());
    Vec3 L = momentum(rig);
    EXPECT_LT((L - start).norm(), 0.03 * start.norm());
    double worst = 0;
    for (int n = 0; n < 50; ++n) {
      rig.step();
      q[2] = pose_of(rig, "body", Vec3::Zero());
      const Vec3 v = (q[1].p - q[0].p) / h, v1 = (q[2].p - q[1].p) / h;
      const Mat3 B = (q[1].A - q[0].A) / h, B1 = (q[2].A - q[1].A) / h;
      Vec3 lost = v1.cross(v);
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) lost += S(i, j) * B1.col(i).cross(B.col(j));
      const Vec3 now = momentum(rig);
      worst = std::max(worst, (now - L - h * lost).norm() / L.norm());
      EXPECT_LT((now - L - h * lost).norm(), 1e-9 * L.norm()) << n;
      L = now, q[0] = q[1], q[1] = q[2];
    }
    measured("beside_its_own_loss", worst);
  }
  // Euler's equations, by small steps of Runge and Kutta: where the body is after 0.4 s.
  const double T = 0.4;
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  const Vec3 kept = I * Vec3(0.5, 6, 0.3);
  const auto rate = [&](const Eigen::Quaterniond& q) {
    const Vec3 w = q * (I.inverse() * (q.conjugate() * kept));
    Eigen::Quaterniond d = Eigen::Quaterniond(0, w[0], w[1], w[2]) * q;
    d.coeffs() *= 0.5;
    return d;
  };
  const int steps = 4000;
  const auto ahead = [](const Eigen::Quaterniond& q, const Eigen::Quaterniond& d, double h) {
    Eigen::Quaterniond out;
    out.coeffs() = q.coeffs() + h * d.coeffs();
    return out;
  };
  for (int n = 0; n < steps; ++n) {
    const double h = T / steps;
    const auto a = rate(turn), b = rate(ahead(turn, a, h / 2)), c = rate(ahead(turn, b, h / 2)), d = rate(ahead(turn, c, h));
    turn.coeffs() += h / 6 * (a.coeffs() + 2 * b.coeffs() + 2 * c.coeffs() + d.coeffs());
    turn.normalize();
  }
  for (const auto& [integrator, order] : {std::pair<std::string, double>{"backward_euler", 0.8}, {"bdf2", 1.7}}) {
    double error[2], lost[2];
    for (int k = 0; k < 2; ++k) {
      const double h = k == 0 ? 2e-3 : 1e-3;
      Rig rig(scene(h, integrator));
      rig.steps(static_cast<int>(std::lround(T / h)));
      error[k] = (pose_of(rig, "body", Vec3::Zero()).A - turn.toRotationMatrix()).norm();
      lost[k] = (momentum(rig) - kept).norm() / kept.norm();
    }
    measured(integrator + "_lost_at_1_ms", lost[1]), measured(integrator + "_order_of_loss", std::log2(lost[0] / lost[1]));
    EXPECT_GT(std::log2(error[0] / error[1]), order) << integrator << " " << error[0] << " " << error[1];
    EXPECT_GT(std::log2(lost[0] / lost[1]), order) << integrator << " " << lost[0] << " " << lost[1];
  }
}

// A tyre of facets loses energy where one comes down and gains less while another lets go. Taken for energy from nowhere, that cut every other step
// in two: 655 iterations in 30 steps, for half as much again of the error of the way (0.5 ms steps: 44.56 mm in 0.15 s).
TEST(RigidMotion, ATyreRollsOverItsFacetsInWholeSteps) {
  Rig rig(R"(mortise: 1
name: tyre
time: {step: 5 ms, steps: 30}
materials: {gel: {youngs_modulus: 0.5 MPa, poisson_ratio: 0.4, density: 1050}}
bodies:
  tyre: {type: soft, shape: {cylinder: {radius: 30 mm, height: 15 mm, edge_length: 6 mm}}, material: gel, rotation: {axis: [1, 0, 0], angle: 90 deg}, position: [0, 0, 30.2 mm], velocity: [0.3, 0, 0], angular_velocity: [0, 10, 0]}
  floor: {type: half_space}
effects:
  inertia: {}
  gravity: {}
  elasticity: {}
  mortar_contact: {pairs: [{slave: tyre, master: floor}]}
  friction: {follows: mortar_contact, mu: 0.6}
)");
  const audit::MeasuredBody tyre(rig.input.bodies[0], 0);
  const std::vector<double> start = rig.engine->points();
  int iterations = 0, substeps = 0;
  for (int i = 0; i < 30; ++i) {
    const solver::StepReport report = rig.step();
    iterations += report.newton, substeps += report.substeps;
  }
  const std::vector<double> end = rig.engine->points();
  const double way = tyre.mean(end, end)[0] - tyre.mean(start, start)[0];
  measured("tyre_iterations", iterations), measured("tyre_substeps", substeps), measured("tyre_way", way);
  EXPECT_LE(substeps, 33);
  EXPECT_LT(iterations, 500);
  EXPECT_NEAR(way, 44.56e-3, 0.55e-3);
}

// On straight ways what turns is stretched, and its stiffness cuts them: both took 21 to 25 iterations a step.
TEST(RigidMotion, TurnsInFewIterations) {
  const auto most = [](const std::string& arm, const std::string& effects) {
    Rig rig(R"(
mortise: 1
name: turns
time: {step: 5 ms, steps: 6}
materials: {wood: {density: 1000}}
bodies: {arm: {type: stiff, shape: {box: {size: [100 mm, 20 mm, 20 mm], edge_length: 100 mm}}, material: wood, position: [50 mm, 0, 0])" +
            arm + "}}\neffects:\n  inertia: {}\n  affine_body: {}\n" + effects);
    Index most = 0;
    for (int i = 0; i < 6; ++i) most = std::max(most, rig.step().newton);
    return most;
  };
  EXPECT_LE(most(", angular_velocity: [0, 60, 0]", ""), 6);
  EXPECT_LE(most("",
                 "  joint: [{name: hip, type: revolute, body: arm, at: [0, 0, 0], axis: [0, 1, 0]}]\n"
                 "  drive: [{joint: hip, mode: effort, torque: 1.4}]\n"),
            8);
}
