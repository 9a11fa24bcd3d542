// Joints that follow others, and slides on bodies that move freely: against rigid bodies' equations, exact to 1e-9, momentum, resumed runs.
#include <fmt/format.h>

#include "audit/state_audit.h"
#include "rig.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

// Links of 100 x 20 x 20 mm and 40 g on hinges at their ends about y, from the horizontal: weight turns each by kWeight cos(angle).
constexpr double kInertia = 0.04 * (0.1 * 0.1 / 3 + 0.02 * 0.02 / 12), kWeight = 0.04 * 9.81 * 0.05;

// `a` about y, `b` about `axis` (b is horizontal, and perpendicular to the axis), which mimics.
std::string two_links(const std::string& mimic, const std::string& more, double dt_ms, const std::string& joint_b = "axis: [0, 1, 0]",
                      const std::string& integrator = "backward_euler") {
  return fmt::format(R"(
mortise: 1
name: mimic
time: {{step: {} ms, steps: 1000}}
materials: {{steel: {{density: 1000}}}}
bodies:
  a: {{type: stiff, shape: {{box: {{size: [100 mm, 20 mm, 20 mm], edge_length: 100 mm}}}}, material: steel, position: [50 mm, 0, 0]}}
  b: {{type: stiff, shape: {{box: {{size: [100 mm, 20 mm, 20 mm], edge_length: 100 mm}}}}, material: steel, position: [50 mm, 200 mm, 0]}}
effects:
  inertia: {{integrator: {}}}
  gravity: {{}}
  affine_body: {{stiffness: 1 GPa}}
  joint:
    - {{name: one, type: revolute, body: a, at: [0, 0, 0], axis: [0, 1, 0]}}
    - {{name: two, type: revolute, body: b, at: [0, 200 mm, 0], {}, mimic: {{joint: one{}}}}}
{})",
                     dt_ms, integrator, joint_b, mimic, more);
}
const std::string kNoWeight = "effects.gravity.acceleration=[0, 0, 0]";

// Angle and rate of the first at t: (1 + r^2) I theta'' = W (cos theta + r cos(r theta)) + torque, from rest.
std::pair<double, double> together(double r, double torque, double t, int n = 20000) {
  double x = 0, v = 0;
  const double h = t / n;
  const auto a = [&](double y) { return (kWeight * (std::cos(y) + r * std::cos(r * y)) + torque) / ((1 + r * r) * kInertia); };
  for (int i = 0; i < n; ++i) {
    const double k1 = v, l1 = a(x), k2 = v + h / 2 * l1, l2 = a(x + h / 2 * k1), k3 = v + h / 2 * l2, l3 = a(x + h / 2 * k2), k4 = v + h * l3,
                 l4 = a(x + h * k3);
    x += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4), v += h / 6 * (l1 + 2 * l2 + 2 * l3 + l4);
  }
  return {x, v};
}

}  // namespace

TEST(Mimic, AgainstItsEquation) {
  const double T = 0.15;
  for (double r : {-0.5, 2.0, 1.0}) {
    const auto [x, v] = together(r, 0, T);
    double error[2];
    for (int k = 0; k < 2; ++k) {
      const double dt = k == 0 ? 1 : 0.5;
      Rig rig(two_links(fmt::format(", ratio: {}", r), "", dt, "axis: [0, 1, 0]", "bdf2"));
      int iterations = 0;
      const int steps = static_cast<int>(std::lround(T * 1e3 / dt));
      for (int i = 0; i < steps; ++i) {
        iterations += rig.step().newton;
        const Captured f = rig.fields();
        ASSERT_LT(std::abs(f.at("joint/two_mimic_error")), r == 1 ? 1e-14 : 1e-10) << r << " " << i;
        EXPECT_LT(f.at("joint/tie_error"), 1e-13);
        EXPECT_LT(vector(f, "balance/defect_").norm(), 1e-6 * f.at("balance/largest"));
      }
      error[k] = std::abs(rig.fields().at("joint/one_angle") - x);
      EXPECT_NEAR(rig.fields().at("joint/one_rate"), v, 0.02 * std::abs(v)) << r;
      EXPECT_LT(iterations, 5 * steps) << r;  // without lambda, by ever larger K, it takes seven a step
    }
    EXPECT_LT(error[0], 2e-3 * std::abs(x)) << r;
    EXPECT_LT(error[1], 0.4 * error[0]) << r;  // second order
    if (r == 1) continue;
    // The coupling's torque turns the second: I r theta'' - W cos(r theta).
    Rig rig(two_links(fmt::format(", ratio: {}", r), "", 0.5));
    rig.steps(60);
    const double angle = rig.fields().at("joint/one_angle"),
                 acceleration = kWeight * (std::cos(angle) + r * std::cos(r * angle)) / ((1 + r * r) * kInertia);
    EXPECT_NEAR(rig.fields().at("joint/two_coupling"), kInertia * r * acceleration - kWeight * std::cos(r * angle), 2e-2 * kWeight) << r;
  }
}

// About other axes than the leader's, and where the leader has a motor.
TEST(Mimic, AboutAnotherAxis) {
  const double torque = 3e-3, r = 0.7, T = 0.1;
  Rig rig(two_links(", ratio: 0.7", "  drive: [{joint: one, mode: effort, torque: 3e-3}]\n", 0.5, "axis: [0, 0.6, 0.8]"), {kNoWeight});
  rig.steps(static_cast<int>(T * 2000));
  const Captured f = rig.fields();
  EXPECT_NEAR(f.at("joint/one_rate"), torque / ((1 + r * r) * kInertia) * T, 1e-4 * torque / kInertia * T);
  EXPECT_LT(std::abs(f.at("joint/two_mimic_error")), 1e-10);
  EXPECT_NEAR(f.at("joint/two_angle"), 0.5 * r * torque / ((1 + r * r) * kInertia) * T * (T + 5e-4), 1e-4);
}

// A motor on the one that follows drives both.
TEST(Mimic, AMotorOnEither) {
  const double torque = 3e-3, r = -2, T = 0.05;
  Rig rig(two_links(", ratio: -2", "  drive: [{joint: two, mode: effort, torque: 3e-3}]\n", 0.5), {kNoWeight});
  rig.steps(static_cast<int>(T * 2000));
  EXPECT_NEAR(rig.fields().at("joint/one_rate"), r * torque / ((1 + r * r) * kInertia) * T, 1e-4 * torque / kInertia * T);
  EXPECT_NEAR(rig.fields().at("joint/two_coupling"), -torque / (1 + r * r), 1e-3 * torque);
}

// A finger of two links that fly: the second curls as the first does. Nothing turns the whole.
TEST(Mimic, FingersThatFly) {
  const std::string yaml = R"(
mortise: 1
name: finger
time: {step: 1 ms, steps: 1000}
materials: {steel: {density: 1000}}
bodies:
  palm: {type: stiff, shape: {box: {size: [60 mm, 40 mm, 20 mm], edge_length: 100 mm}}, material: steel, position: [-30 mm, 0, 0]}
  near: {type: stiff, shape: {box: {size: [50 mm, 16 mm, 16 mm], edge_length: 100 mm}}, material: steel, position: [25 mm, 0, 0]}
  far: {type: stiff, shape: {box: {size: [40 mm, 14 mm, 14 mm], edge_length: 100 mm}}, material: steel, position: [70 mm, 0, 0]}
  tip: {type: stiff, shape: {box: {size: [20 mm, 12 mm, 12 mm], edge_length: 100 mm}}, material: steel, position: [100 mm, 0, 0]}
effects:
  inertia: {}
  affine_body: {stiffness: 1 GPa}
  joint:
    - {name: near, type: revolute, body: near, to: palm, at: [0, 0, 0], axis: [0, 1, 0], angle_limits: [-10 deg, 90 deg]}
    - {name: far, type: revolute, body: far, to: near, at: [50 mm, 0, 0], axis: [0, 1, 0], mimic: {joint: near, ratio: 1.5}}
    - {name: tip, type: revolute, body: tip, to: far, at: [90 mm, 0, 0], axis: [0, 1, 0], mimic: {joint: far, ratio: 0.5}, angle_limits: [-1, 3]}
  drive: [{joint: near, mode: pd, kp: 0.1, kd: 2e-3, angle: 60 deg}]
)";
  Rig rig(yaml), broken(yaml);
  audit::EnergyAudit audit(rig.input);
  double turning = 0, left = 0;
  for (int i = 0; i < 150; ++i) {
    rig.step();
    const Captured f = rig.fields();
    ASSERT_LT(std::abs(f.at("joint/far_mimic_error")), 1e-10);
    ASSERT_LT(std::abs(f.at("joint/tip_mimic_error")), 1e-10);
    turning = std::max(turning, 2e-5 * std::abs(f.at("joint/near_rate")));
    left = std::max(left, vector(f, "inertia/angular_momentum_").norm());
    EXPECT_LT(vector(f, "inertia/momentum_").norm(), 1e-8);
    audit.state({f, rig.engine->points()});
  }
  EXPECT_GT(rig.fields().at("joint/near_angle"), 0.5);
  EXPECT_NEAR(rig.fields().at("joint/tip_angle"), 0.75 * rig.fields().at("joint/near_angle"), 2e-10);
  EXPECT_LT(left, 0.05 * turning);  // backward Euler's
  EXPECT_LT(audit.result().largest_gain, 1e-6 * audit.result().scale);
  broken.steps(60);
  broken.resume();
  broken.steps(90);
  EXPECT_EQ(broken.engine->points(), rig.engine->points());
  EXPECT_EQ(broken.fields().at("joint/tip_coupling"), rig.fields().at("joint/tip_coupling"));
}

// Whose leader is given is given too; and between its own limits.
TEST(Mimic, OfGivenAngles) {
  const std::string drive = "  drive: [{joint: one, mode: kinematic, sine: {angle: 40 deg, frequency: 2}}]\n";
  for (const char* mimic : {", ratio: -0.4", ", ratio: 1"}) {
    Rig rig(two_links(mimic, drive, 2));
    for (int i = 0; i < 100; ++i) {
      rig.step();
      const Captured f = rig.fields();
      EXPECT_LT(std::abs(f.at("joint/two_mimic_error")), 1e-13);
      EXPECT_LT(std::abs(f.at("drive/one_error")), 1e-13);
    }
    EXPECT_GT(std::abs(rig.fields().at("joint/one_rate")), 1);
  }
  std::string why;
  try {
    Rig(two_links(", ratio: -0.4", drive, 2, "axis: [0, 1, 0], angle_limits: [-0.1, 0.1]"));
  } catch (const Error& e) {
    why = e.what();
  }
  EXPECT_NE(why.find("the target of 'two', which mimics 'one', is"), std::string::npos) << why;
}

// The motor of a given leader bears what follows it, r times: weights W (1 + r), and (1 + r^2) I theta'' from a (1 - cos w t).
TEST(Mimic, ALeadersMotorBearsWhatFollows) {
  const double r = -0.4, h = 5e-4, a = 0.3, w = 2 * M_PI;
  Rig held(two_links(", ratio: -0.4", "  drive: [{joint: one, mode: kinematic, angle: 0}]\n", 2));
  held.steps(5);
  EXPECT_NEAR(held.fields().at("drive/one_torque"), -(1 + r) * kWeight, 1e-6 * kWeight);
  EXPECT_NEAR(held.fields().at("drive/two_torque"), -kWeight, 1e-6 * kWeight);
  Rig turned(two_links(", ratio: -0.4", "  drive: [{joint: one, mode: kinematic, angle: 0.3, sine: {angle: -0.3, frequency: 1, phase: 90 deg}}]\n",
                       1e3 * h, "axis: [0, 1, 0]", "bdf2"),
             {kNoWeight});
  turned.steps(5);
  for (int n = 6; n <= 200; ++n) {
    turned.step();
    const double most = (1 + r * r) * kInertia * a * w * w;
    EXPECT_NEAR(turned.fields().at("drive/one_torque"), most * std::cos(w * n * h), 0.002 * most) << n;
  }
  // What follows hangs on its leader: W of both links about the first hinge, and r times that of the second about its own.
  std::string finger = two_links(", ratio: 0.5", "  drive: [{joint: one, mode: kinematic, angle: 0}]\n", 2);
  finger.replace(finger.find("position: [50 mm, 200 mm, 0]"), 28, "position: [150 mm, 0, 0]");
  finger.replace(finger.find("body: b, at: [0, 200 mm, 0]"), 27, "body: b, to: a, at: [100 mm, 0, 0]");
  Rig rig(finger);
  rig.steps(5);
  EXPECT_NEAR(rig.fields().at("drive/one_torque"), -(kWeight + 3 * kWeight) - 0.5 * kWeight, 1e-6 * kWeight);
}

// One gram and ten kilograms that follow each other, either way, by each linear solver: (I_a + r^2 I_b) theta'' = W_a cos theta + r W_b cos(r theta).
TEST(Mimic, OfVeryUnequalMasses) {
  const double r = -0.5, T = 0.06;
  for (const auto& [a, b] : {std::pair<double, double>{1e-3, 10}, {10, 1e-3}}) {
    const double I = (a + r * r * b) * kInertia / 0.04, w = kWeight / 0.04;
    double x = 0, v = 0;
    const int n = 6000;
    for (int i = 0; i < n; ++i) {  // the midpoint rule
      const double k = T / n, mid = x + 0.5 * k * v;
      const double turn = w * (a * std::cos(mid) + r * b * std::cos(r * mid)) / I;
      x += k * (v + 0.5 * k * turn), v += k * turn;
    }
    for (const char* linear : {"direct", "reuse", "cg"}) {
      std::string yaml = two_links(", ratio: -0.5", std::string("solver: {linear: ") + linear + "}\n", 1, "axis: [0, 1, 0]", "bdf2");
      for (const double m : {a, b}) yaml.replace(yaml.find("material: steel"), 15, fmt::format("mass: {}", m));
      Rig rig(yaml);
      double missed = 0;
      Index most = 0;
      for (int i = 0; i < 60; ++i) {
        most = std::max(most, rig.step().newton);
        missed = std::max(missed, std::abs(rig.fields().at("joint/two_mimic_error")));
      }
      EXPECT_LE(missed, 1e-10) << a << " " << linear;
      EXPECT_LE(most, 8) << a << " " << linear;
      EXPECT_NEAR(rig.fields().at("joint/one_angle"), x, 2e-3 * std::abs(x)) << a << " " << linear;
    }
  }
}

// A rack on a rail and its pinion: a force on the rack of r m turns the pinion.
TEST(Mimic, RackAndPinion) {
  const std::string yaml = R"(
mortise: 1
name: rack
time: {step: 0.5 ms, steps: 1000}
materials: {steel: {density: 1000}}
bodies:
  pinion: {type: stiff, shape: {box: {size: [100 mm, 20 mm, 20 mm], edge_length: 100 mm}}, material: steel, position: [50 mm, 0, 0]}
  rack: {type: stiff, shape: {box: {size: [100 mm, 20 mm, 20 mm], edge_length: 100 mm}}, material: steel, position: [0, 200 mm, 0]}
effects:
  inertia: {}
  affine_body: {stiffness: 1 GPa}
  joint:
    - {name: pinion, type: revolute, body: pinion, at: [0, 0, 0], axis: [0, 1, 0]}
    - {name: rack, type: prismatic, body: rack, axis: [1, 0, 0], mimic: {joint: pinion, ratio: 0.03}}
  drive: [{joint: rack, mode: effort, force: 0.1 N}]
)";
  Rig rig(yaml);
  rig.steps(200);
  const Captured f = rig.fields();
  // (I + r^2 m) theta'' = r F
  const double r = 0.03, rate = r * 0.1 / (kInertia + r * r * 0.04) * 0.1;
  EXPECT_NEAR(f.at("joint/pinion_rate"), rate, 1e-4 * rate);
  EXPECT_LT(std::abs(f.at("joint/rack_mimic_error")), 1e-11);
}

// In statics: a motor holds both links' weights.
TEST(Mimic, InStatics) {
  std::string yaml = two_links(", ratio: -0.5", "  drive: [{joint: one, mode: pd, kp: 0.2, angle: 0}]\n", 1);
  yaml.replace(yaml.find("time: {step: 1 ms, steps: 1000}"), 31, "time: {mode: static, steps: 4}");
  yaml.replace(yaml.find("  inertia: {integrator: backward_euler}\n"), 40, "");
  Rig rig(yaml);
  rig.steps(4);
  const Captured f = rig.fields();
  const double angle = f.at("joint/one_angle");
  EXPECT_LT(std::abs(f.at("joint/two_mimic_error")), 1e-10);
  EXPECT_NEAR(0.2 * angle, kWeight * (std::cos(angle) - 0.5 * std::cos(-0.5 * angle)), 1e-6 * kWeight);
}

TEST(Mimic, Refusals) {
  const auto refused = [](const std::string& mimic, const std::string& joint_b = "axis: [0, 1, 0]", const std::string& more = "") {
    try {
      Rig(two_links(mimic, more, 1, joint_b));
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string("nothing");
  };
  const auto says = [](const std::string& message, const std::string& text) { EXPECT_NE(message.find(text), std::string::npos) << message; };
  says(refused("}, mimic: {joint: three"), "mimic");
  says(refused("s"), "'two' cannot mimic 'ones': there is no such joint; there are: 'one'");
  says(refused("", "axis: [0, 1, 0]", "  drive: [{joint: two, mode: kinematic, angle: 0}]\n"), "'two' mimics 'one': drive that one");
}

// ---- slides on bodies that move freely

namespace {

// A jaw of 40 g on a palm of 16 g; both fly.
std::string flying(const std::string& joint, const std::string& more, double dt_ms, const std::string& spin = "[0, 0, 0]") {
  return fmt::format(R"(
mortise: 1
name: flying
time: {{step: {} ms, steps: 1000}}
materials: {{steel: {{density: 1000}}}}
bodies:
  palm: {{type: stiff, shape: {{box: {{size: [40 mm, 40 mm, 10 mm], edge_length: 100 mm}}}}, material: steel, position: [0, 0, 60 mm], angular_velocity: {}}}
  jaw: {{type: stiff, shape: {{box: {{size: [100 mm, 20 mm, 20 mm], edge_length: 100 mm}}}}, material: steel, position: [20 mm, 10 mm, 0]}}
effects:
  inertia: {{}}
  affine_body: {{stiffness: 1 GPa}}
  joint: [{{name: jaw, type: prismatic, body: jaw, to: palm, axis: [1, 0, 0]{}}}]
{})",
                     dt_ms, spin, joint, more);
}

}  // namespace

TEST(FreeSlides, PdAgainstItsEquation) {
  // mu s'' = kp (target - s) - kd s', mu = m M / (m + M); the push is off the centres, so that the axis is put through them.
  const double kp = 40, kd = 1, target = 0.03, T = 0.1, mu = 0.04 * 0.016 / 0.056;
  double s = 0, v = 0;
  const int n = 1000000;
  for (int i = 0; i < n; ++i) v += T / n * (kp * (target - s) - kd * v) / mu, s += T / n * v;
  double error[2];
  for (int k = 0; k < 2; ++k) {
    const double dt = k == 0 ? 0.4 : 0.2;
    std::string yaml = flying("", fmt::format("  drive: [{{joint: jaw, mode: pd, kp: {}, kd: {}, travel: {}}}]\n", kp, kd, target), dt);
    yaml.replace(yaml.find("[20 mm, 10 mm, 0]"), 17, "[90 mm, 0, 60 mm]");
    Rig rig(yaml);
    for (int i = 0; i < std::lround(T * 1e3 / dt); ++i) {
      rig.step();
      ASSERT_LT(rig.fields().at("joint/jaw_beside"), 1e-10);
      EXPECT_LT(vector(rig.fields(), "inertia/momentum_").norm(), 1e-8);
    }
    error[k] = std::abs(rig.fields().at("joint/jaw_travel") - s);
  }
  EXPECT_LT(error[0], 3e-4);
  EXPECT_LT(error[1], 0.6 * error[0]);
}

// A turning palm throws its jaw out against a stop: the jaw stays on the axis, and the whole keeps what it turns with.
TEST(FreeSlides, TurnWithTheirCarrier) {
  const std::string yaml = flying(", travel_limits: [-5 mm, 30 mm]", "", 0.5, "[0, 4, 8]");
  Rig rig(yaml), broken(yaml);
  const Captured first = [&] {
    rig.step();
    return rig.fields();
  }();
  const Vec3 turning = vector(first, "inertia/angular_momentum_");
  double farthest = 0;
  for (int i = 1; i < 300; ++i) {
    rig.step();
    const Captured f = rig.fields();
    ASSERT_LT(f.at("joint/jaw_beside"), 1e-10);
    ASSERT_LT(f.at("joint/tie_error"), 1e-13);
    ASSERT_LT(f.at("joint/jaw_travel"), 0.03);
    farthest = std::max(farthest, f.at("joint/jaw_travel"));
    EXPECT_LT((vector(f, "inertia/angular_momentum_") - turning).norm(), 0.05 * turning.norm());
  }
  EXPECT_GT(farthest, 0.0295);
  broken.steps(100);
  broken.resume();
  broken.steps(200);
  EXPECT_EQ(broken.engine->points(), rig.engine->points());
}
