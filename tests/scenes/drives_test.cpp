// Drives and stops of joints: against rigid bodies' equations, exact angles, energy and momentum, batches, resumed runs.
#include <fmt/format.h>

#include <fstream>

#include "audit/state_audit.h"
#include "link.h"
#include "rig.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

const std::string kNoWeight = "effects.gravity.acceleration=[0, 0, 0]";

}  // namespace

TEST(Drives, TorqueTurnsABody) {
  Rig rig(link("", "mode: effort, torque: 1 N mm", 0.5), {kNoWeight});
  rig.steps(20);
  const Captured f = rig.fields();
  EXPECT_NEAR(f.at("joint/hip_rate"), 1e-3 / kInertia * 0.01, 1e-4 * 1e-3 / kInertia * 0.01);
  EXPECT_EQ(f.at("drive/hip_torque"), 1e-3);
  EXPECT_NEAR(f.at("drive/hip_power"), 1e-3 * f.at("joint/hip_rate"), 1e-15);
}

// I theta'' = W cos theta - S (theta - theta_0), and a rotor adds to I.
TEST(Drives, SpringsAndRotorsAgainstTheirEquation) {
  const double S = 0.2, rest = -0.5, J = 3e-4, T = 0.12;
  const auto [x, v] = motion([&](double, double a, double) { return (kWeight * std::cos(a) - S * (a - rest)) * kInertia / (kInertia + J); }, T);
  double error[2];
  for (int k = 0; k < 2; ++k) {
    const double dt = k == 0 ? 0.4 : 0.2;
    Rig rig(link("", fmt::format("mode: passive, stiffness: {}, rest: {}, armature: {}", S, rest, J), dt));
    rig.steps(static_cast<int>(std::lround(T * 1e3 / dt)));
    error[k] = std::abs(rig.fields().at("joint/hip_angle") - x);
    EXPECT_NEAR(rig.fields().at("joint/hip_rate"), v, 0.03 * std::abs(v) + 0.02);
  }
  EXPECT_LT(error[0], 5e-3);
  EXPECT_LT(error[1], 0.6 * error[0]);
  // With a motor of given torque: (I + J) theta'' = torque; resumed with the same bits.
  const std::string yaml = link("", "mode: effort, torque: 1e-3, armature: 3e-4", 0.5);
  Rig rig(yaml, {kNoWeight}), broken(yaml, {kNoWeight});
  rig.steps(20);
  EXPECT_NEAR(rig.fields().at("joint/hip_rate"), 1e-3 / (kInertia + J) * 0.01, 1e-4 * 1e-3 / kInertia * 0.01);
  broken.steps(8), broken.resume(), broken.steps(12);
  EXPECT_EQ(broken.engine->points(), rig.engine->points());
}

// What starts in motion has its rotor in motion: nothing that acts changes the rate.
TEST(Drives, RotorsStartWithTheirBodies) {
  Rig hinge(link("", "mode: passive, armature: 3e-4", 1), {kNoWeight, "bodies.arm.angular_velocity=[0, 10, 0]", "bodies.arm.velocity=[0, 0, -0.5]"});
  EXPECT_NEAR(hinge.fields().at("joint/hip_rate"), 10, 1e-12);
  hinge.steps(20);
  EXPECT_NEAR(hinge.fields().at("joint/hip_angle"), 0.2, 0.005);
  Rig slide(link("", "mode: passive, armature: 0.1", 1),
            {kNoWeight, "effects.joint=[{name: hip, type: prismatic, body: arm, axis: [0, 1, 0]}]", "bodies.arm.velocity=[0, 0.3, 0]"});
  EXPECT_NEAR(slide.fields().at("joint/hip_rate"), 0.3, 1e-12);
  slide.steps(20);
  EXPECT_NEAR(slide.fields().at("joint/hip_travel"), 0.006, 1e-9);
}

// Turns are counted.
TEST(Drives, TorqueTurnsABodySeveralTimes) {
  Rig rig(link("", "mode: effort, torque: 1e-2", 1, "bdf2"), {kNoWeight});
  rig.steps(600);
  const double angle = 0.5 * 1e-2 / kInertia * 0.36;
  EXPECT_GT(angle, 2 * 2 * M_PI);
  EXPECT_NEAR(rig.fields().at("joint/hip_angle"), angle, 0.01 * angle);
}

TEST(Drives, PdAgainstItsEquation) {
  const double kp = 0.1, kd = 2e-3, target = -0.6, damping = 1e-3, J = 3e-4, T = 0.2;
  const auto torque = [&](double, double a, double w) {
    return (kWeight * std::cos(a) + kp * (target - a) - (kd + damping) * w) * kInertia / (kInertia + J);
  };
  const auto [x, v] = motion(torque, T);
  double error[2], rate = 0;
  for (int k = 0; k < 2; ++k) {
    const double dt = k == 0 ? 0.4 : 0.2;
    Rig rig(link("", fmt::format("mode: pd, kp: {}, kd: {}, angle: {}, damping: {}, armature: {}", kp, kd, target, damping, J), dt, "bdf2"));
    rig.steps(static_cast<int>(std::lround(T * 1e3 / dt)));
    const Captured f = rig.fields();
    error[k] = std::abs(f.at("joint/hip_angle") - x), rate = f.at("joint/hip_rate");
    EXPECT_NEAR(f.at("drive/hip_error"), f.at("joint/hip_angle") - target, 1e-15);
    EXPECT_NEAR(f.at("drive/hip_torque"), kp * (target - f.at("joint/hip_angle")) - kd * f.at("joint/hip_rate"), 1e-12);
  }
  EXPECT_LT(error[0], 2e-3);
  EXPECT_LT(error[1], 0.3 * error[0]);  // motors, bearings and rotors are of second order too
  EXPECT_NEAR(rate, v, 0.1);
}

// A force that falls along a smooth motion does the work of its mean: no step of second order is refused for a gain of energy that is none.
TEST(Drives, SecondOrderStaysWhereTorquesChange) {
  const double frequency = 4, T = 0.6, peak = kInertia * 2 * M_PI * frequency * 0.5 / T;
  const auto [x, v] = motion([&](double t, double, double) { return peak * std::sin(2 * M_PI * frequency * t); }, T);
  double error[2];
  for (int k = 0; k < 2; ++k) {
    const double dt = k == 0 ? 5 : 2.5;
    Rig rig(link("", fmt::format("mode: effort, torque: 0, sine: {{torque: {}, frequency: {}}}", peak, frequency), dt, "bdf2"), {kNoWeight});
    int first_order = 0;
    for (int i = 0; i < std::lround(T * 1e3 / dt); ++i) first_order += rig.step().first_order;
    EXPECT_EQ(first_order, 0) << dt;
    error[k] = std::abs(rig.fields().at("joint/hip_angle") - x);
  }
  EXPECT_LT(error[0], 0.01 * std::abs(x));
  EXPECT_LT(error[1], 0.35 * error[0]);
}

// So do supports: a kinematic drive and pins that carry a soft slide to and fro.
TEST(Drives, SecondOrderStaysWhereSupportsPull) {
  const double A = 0.03, W = 6 * M_PI, T = 0.6, kp = 800, kd = 15;
  const double x = motion([&](double t, double y, double w) { return kInertia * (A * W * W * std::cos(W * t) - kp * y - kd * w); }, T).first;
  std::string times, ways;
  for (int k = 0; k <= 240; ++k) {
    const double t = 0.0025 * k;
    times += fmt::format("{}{}", k ? ", " : "", t), ways += fmt::format("{}[{}, 0, 0]", k ? ", " : "", A * (std::cos(W * t) - 1));
  }
  const std::string pins = fmt::format("  pin: [{{body: base, where: {{side: all}}, motion: {{time: [{}], translation: [{}]}}}}]\n", times, ways);
  for (const bool pinned : {false, true}) {
    double error[2];
    for (int k = 0; k < 2; ++k) {
      const double dt = k == 0 ? 5 : 2.5;
      Rig rig(fmt::format(
          R"(
mortise: 1
name: carried
time: {{step: {} ms, steps: 240}}
materials: {{m: {{density: 1000}}}}
bodies:
  base: {{type: stiff, shape: {{box: {{size: [200 mm, 200 mm, 50 mm], edge_length: 200 mm}}}}, material: m}}
  car: {{type: stiff, shape: {{box: {{size: [100 mm, 100 mm, 100 mm], edge_length: 100 mm}}}}, material: m, position: [0, 0, 0.1]}}
effects:
  inertia: {{integrator: bdf2}}
  affine_body: {{}}
{}    - {{name: slide, type: prismatic, body: car, to: base, axis: [1, 0, 0]}}
  drive:
{}    - {{joint: slide, mode: pd, kp: {}, kd: {}, travel: 0}}
)",
          dt, (pinned ? pins : "") + "  joint:\n" + (pinned ? "" : "    - {name: rail, type: prismatic, body: base, axis: [1, 0, 0]}\n"),
          pinned
              ? ""
              : fmt::format("    - {{joint: rail, mode: kinematic, travel: {}, sine: {{travel: {}, frequency: 3, phase: {}}}}}\n", -A, A, M_PI / 2),
          kp, kd));
      int first_order = 0;
      for (int i = 0; i < std::lround(T * 1e3 / dt); ++i) first_order += rig.step().first_order;
      EXPECT_EQ(first_order, 0) << pinned << dt;
      error[k] = std::abs(rig.fields().at("joint/slide_travel") - x);
    }
    EXPECT_LT(error[0], 0.01 * A) << pinned;
    EXPECT_LT(error[1], 0.35 * error[0]) << pinned;
  }
}

// It gives what it can, which is not enough.
TEST(Drives, EffortIsLimited) {
  const double T = 0.12, most = 0.012;
  const auto [x, v] = motion([&](double, double a, double) { return kWeight * std::cos(a) - most; }, T);
  Rig rig(link("", fmt::format("mode: pd, kp: 10, kd: 0.1, effort: {}, angle: -20 deg", most), 0.5, "bdf2"));
  for (int i = 0; i < 240; ++i) {
    rig.step();
    EXPECT_NEAR(rig.fields().at("drive/hip_torque"), -most, 1e-15);
  }
  EXPECT_NEAR(rig.fields().at("joint/hip_angle"), x, 5e-3 * x);
  EXPECT_NEAR(rig.fields().at("joint/hip_rate"), v, 0.02 * v);
}

TEST(Drives, VelocityIsLimited) {
  for (const char* drive :
       {"mode: effort, torque: 1e-2, effort: 1e-2, velocity: 2", "mode: pd, kp: 50, kd: 0, angle: 40 rad, effort: 1e-2, velocity: 2"}) {
    Rig rig(link("", drive, 2), {kNoWeight});
    double fastest = 0, torque = 0;
    for (int i = 0; i < 300; ++i) {
      rig.step();
      const Captured f = rig.fields();
      fastest = std::max(fastest, f.at("joint/hip_rate")), torque = f.at("drive/hip_torque");
    }
    EXPECT_LE(fastest, 2.0);
    EXPECT_GT(fastest, 1.8);
    EXPECT_LT(torque, 1e-3);
    EXPECT_GE(torque, 0);
  }
}

TEST(Drives, BearingsDrag) {
  const double T = 0.3, D = 1e-3, F = 4e-3;
  const auto [x, v] =
      motion([&](double t, double, double w) { return 1e-2 * (t < 0.1) - D * w - (std::abs(w) > 1e-2 ? F * w / std::abs(w) : F * w / 1e-2); }, T);
  Rig rig(link("", fmt::format("mode: effort, torque: {{time: [0, 0.1, 0.1000001], value: [1e-2, 1e-2, 0]}}, damping: {}, friction: {}", D, F), 0.5,
               "bdf2"),
          {kNoWeight});
  rig.steps(600);
  const Captured f = rig.fields();
  EXPECT_GT(x, 0.25);
  EXPECT_NEAR(f.at("joint/hip_angle"), x, 0.02 * x);
  EXPECT_NEAR(f.at("joint/hip_rate"), v, 0.02);
  // Friction bears the weight of a link that it can hold; what is held gives way by less than 0.001 rad/s times a step, and rests.
  Rig held(link("", "mode: passive, friction: 0.03", 5));
  held.steps(40);
  EXPECT_NEAR(held.fields().at("drive/hip_drag"), -kWeight, 1e-4 * kWeight);
  const double angle = held.fields().at("joint/hip_angle");
  EXPECT_LT(angle, 1e-3 * 5e-3);
  held.steps(40);
  EXPECT_NEAR(held.fields().at("joint/hip_angle"), angle, 1e-12);
}

// A chain of two whose angles are given, with a heavy end: exact at every step, on a hinge to the world and between bodies that fly.
TEST(Drives, GivenAnglesAreExact) {
  const auto scene = [](const std::string& first, const std::string& drives) {
    return fmt::format(R"(
mortise: 1
name: chain
time: {{step: 4 ms, steps: 1000}}
materials: {{light: {{density: 1000}}, heavy: {{density: 50000}}}}
bodies:
  upper: {{type: stiff, shape: {{box: {{size: [100 mm, 20 mm, 20 mm], edge_length: 100 mm}}}}, material: light, position: [50 mm, 0, 0]}}
  lower: {{type: stiff, shape: {{box: {{size: [100 mm, 20 mm, 20 mm], edge_length: 100 mm}}}}, material: heavy, position: [150 mm, 0, 0]}}
effects:
  inertia: {{}}
  gravity: {{}}
  affine_body: {{stiffness: 1 GPa}}
  joint:
{}    - {{name: knee, type: revolute, body: upper, to: lower, at: [100 mm, 0, 0], axis: [0.2, 1, 0.3]}}
  drive:
{})",
                       first, drives);
  };
  const std::string hip = "    - {name: hip, type: revolute, body: upper, at: [0, 0, 0], axis: [0, 1, 0]}\n";
  const std::string drive_hip = "    - {joint: hip, mode: kinematic, sine: {angle: 60 deg, frequency: 2}}\n",
                    drive_knee = "    - {joint: knee, mode: kinematic, angle: {time: [0, 1], value: [0, -100 deg]}, interpolation: smooth}\n";
  const std::string swing = "    - {joint: hip, mode: passive, damping: 1e-3}\n";
  for (const std::string& yaml : {scene(hip, drive_hip + drive_knee), scene(hip, swing + drive_knee), scene("", drive_knee)}) {
    Rig rig(yaml);
    const bool driven = yaml.find("joint: hip, mode: kin") != std::string::npos;
    audit::EnergyAudit audit(rig.input);
    for (int i = 0; i < 100; ++i) {
      rig.step();
      const Captured f = rig.fields();
      EXPECT_LT(std::abs(f.at("drive/knee_error")), 1e-13);
      EXPECT_LT(driven ? std::abs(f.at("drive/hip_error")) : 0, 1e-13);
      EXPECT_LT(f.at("joint/tie_error"), 1e-14);
      EXPECT_LT(vector(f, "balance/defect_").norm(), 1e-6 * f.at("balance/largest"));
      const std::vector<double> points = rig.engine->points();
      audit.state({f, points});
    }
    EXPECT_TRUE(audit.result().work_is_known);
    EXPECT_LT(audit.result().largest_gain, 1e-7 * audit.result().scale);
    EXPECT_GT(std::abs(audit.result().support_work), 1e-5 * audit.result().scale);
    EXPECT_LT(rig.fields().at("joint/knee_angle"), -0.3);
  }
}

// The torque that holds a link, that which gives it a turn, and what the world bears.
TEST(Drives, TorqueOfGivenAngles) {
  Rig rig(link("", "mode: kinematic, angle: 0", 2));
  rig.steps(5);
  EXPECT_NEAR(rig.fields().at("drive/hip_torque"), -kWeight, 1e-6 * kWeight);
  EXPECT_NEAR(rig.fields().at("balance/joint_z"), 0.04 * 9.81, 1e-6 * 0.4);
  // theta = a (1 - cos w t): torque I theta''; the error is that of the integrator, in every step but the first, from rest into motion.
  for (const auto& [integrator, share] : {std::pair<const char*, double>{"backward_euler", 0.02}, {"bdf2", 0.002}}) {
    const double h = 5e-4, a = 0.3, w = 2 * M_PI;
    Rig turned(link("", "mode: kinematic, angle: 0.3, sine: {angle: -0.3, frequency: 1, phase: 90 deg}", 1e3 * h, integrator), {kNoWeight});
    turned.steps(5);
    for (int n = 6; n <= 300; ++n) {
      turned.step();
      EXPECT_NEAR(turned.fields().at("drive/hip_torque"), kInertia * a * w * w * std::cos(w * n * h), share * kInertia * a * w * w)
          << integrator << " " << n;
    }
  }
}

// Two links in free flight turn each other: no momentum comes of it.
TEST(Drives, ActOnBothBodies) {
  for (const char* drive : {"mode: pd, kp: 0.2, kd: 1e-3, angle: 50 deg",
                            "mode: kinematic, angle: {time: [0, 0.2], value: [0, 50 deg]}, interpolation: smooth", "mode: effort, torque: 1e-3"}) {
    std::string yaml = link("", drive, 1);
    yaml.replace(yaml.find("effects:"), 8,
                 "  other: {type: stiff, shape: {box: {size: [60 mm, 30 mm, 20 mm], edge_length: 100 mm}}, material: steel, position: [-30 mm, 0, "
                 "0]}\neffects:");
    yaml.replace(yaml.find("body: arm,"), 10, "body: arm, to: other,");
    Rig rig(yaml, {kNoWeight});
    double turning = 0, left = 0, linear = 0;
    for (int i = 0; i < 200; ++i) {
      rig.step();
      const Captured f = rig.fields();
      turning = std::max(turning, kInertia / 4 * std::abs(f.at("joint/hip_rate")));
      left = std::max(left, vector(f, "inertia/angular_momentum_").norm()), linear = std::max(linear, vector(f, "inertia/momentum_").norm());
    }
    EXPECT_GT(std::abs(rig.fields().at("joint/hip_angle")), 0.3) << drive;
    EXPECT_LT(linear, 1e-8) << drive;
    EXPECT_LT(left, 0.01 * turning) << drive;  // backward Euler's
  }
}

// What motors do is what energy changes by, but for what backward Euler loses; of springs, rotors and gains a part is held.
TEST(Drives, PowerBalance) {
  for (const char* drive : {"mode: pd, kp: 0.4, kd: 4e-3", "mode: pd, kp: 0.4, kd: 4e-3, effort: 0.05", "mode: pd, kp: 0.4, effort: 0.1, velocity: 3",
                            "mode: pd, kp: 0.2, damping: 2e-3, stiffness: 0.2, rest: 5 deg, armature: 1e-4"}) {
    Rig rig(link("", std::string(drive) + ", sine: {angle: 40 deg, frequency: 2}", 0.5));
    rig.step();
    audit::EnergyAudit audit(rig.input);
    double work = 0, first = 0, held = 0, exchanged = 0;
    for (int i = 0; i < 200; ++i) {
      const Captured f = rig.fields();
      const bool drags = f.has("drive/hip_drag");
      const double turned = 0.5e-3 * f.at("joint/hip_rate"), power = f.at("drive/hip_power") * 0.5e-3 + (drags ? f.at("drive/hip_drag") * turned : 0);
      if (i > 0) work += power, exchanged += std::abs(power);
      const std::vector<double> points = rig.engine->points();
      audit.state({f, points});
      held = f.at("drive/energy");
      if (i == 0) first = audit.result().total - held;
      if (i > 0) {
        EXPECT_LT(audit.result().gain, 1e-9 * audit.result().scale) << drive << ", state " << i;
      }
      rig.step();
    }
    const auto& r = audit.result();
    EXPECT_GT(exchanged, 1e-3) << drive;
    EXPECT_NEAR(r.total - held - first, work, 0.05 * exchanged) << drive;
    EXPECT_NEAR(r.total - first, r.support_work, 0.15 * exchanged) << drive;  // less is left of springs that nothing damps
  }
}

// A spring in a joint, or a motor without damping whose target stays, gives back what it took. Backward Euler loses it, and that is counted;
// steps of second order keep it.
TEST(Drives, SpringsLoseNothingOfTheirOwn) {
  for (const char* drive : {"mode: passive, stiffness: 0.5", "mode: pd, kp: 0.5, angle: 0"})
    for (const char* integrator : {"backward_euler", "bdf2"}) {
      Rig rig(link("", drive, 1, integrator), {kNoWeight, "bodies.arm.angular_velocity=[0, 10, 0]", "bodies.arm.velocity=[0, 0, -0.5]"});
      audit::EnergyAudit audit(rig.input);
      int first_order = 0;
      for (int i = 0; i <= 200; ++i) {
        const std::vector<double> points = rig.engine->points();
        audit.state({rig.fields(), points});
        first_order += rig.step().first_order;
      }
      const audit::EnergyAudit::Result& r = audit.result();
      // With bdf2 it is that of mean forces, of third order.
      EXPECT_LT(std::abs(r.support_work), (std::string(integrator) == "bdf2" ? 1e-5 : 1e-9) * r.scale) << drive;
      EXPECT_LT(r.largest_gain, 1e-3 * r.scale) << drive;
      if (std::string(integrator) == "bdf2") {
        EXPECT_LT(r.free_loss, 0.02 * r.scale) << drive;
        EXPECT_EQ(first_order, 0) << drive;
      } else {
        EXPECT_GT(r.free_loss, 0.3 * r.scale) << drive;
        EXPECT_LT(r.free_loss, r.scale) << drive;
      }
    }
}

// A link falls on its stop and rests there; whatever the step, the limit is not reached.
TEST(Stops, AreNotCrossed) {
  for (double dt : {0.5, 5.0, 40.0})
    for (const char* integrator : {"backward_euler", "bdf2"}) {
      Rig rig(link(", angle: 30 deg, angle_limits: [-10 deg, 70 deg]", "", dt, integrator));
      double highest = 0;
      const int steps = static_cast<int>(std::min(400.0, 1200 / dt));
      for (int i = 0; i < steps; ++i) {
        rig.step();
        const double angle = rig.fields().at("joint/hip_angle");
        EXPECT_LT(angle, 70 * M_PI / 180);
        EXPECT_GT(angle, -10 * M_PI / 180);
        highest = std::max(highest, angle);
      }
      EXPECT_GT(highest, 69 * M_PI / 180) << dt;
      if (dt != 5 || std::string(integrator) == "bdf2") continue;
      EXPECT_NEAR(rig.fields().at("joint/hip_stop"), -kWeight * std::cos(rig.fields().at("joint/hip_angle") - M_PI / 6), 1e-3 * kWeight);
    }
  // Driven hard against it.
  Rig rig(link(", angle_limits: [-1, 0.5]", "mode: pd, kp: 100, kd: 1, angle: 2 rad, effort: 50", 5));
  for (int i = 0; i < 50; ++i) {
    rig.step();
    EXPECT_LT(rig.fields().at("joint/hip_angle"), 0.5);
  }
  EXPECT_GT(rig.fields().at("joint/hip_angle"), 0.49);
  EXPECT_NEAR(rig.fields().at("joint/hip_stop"), -50 - kWeight * std::cos(0.5), 1e-3);
}

namespace {

// A gait from a file on a leg of two links that strikes a soft ball.
std::string leg(const std::string& csv) {
  return R"(
mortise: 1
name: leg
time: {step: 4 ms, steps: 100}
materials: {steel: {density: 1000}, rubber: {youngs_modulus: 0.2 MPa, poisson_ratio: 0.4, density: 1000}}
bodies:
  thigh: {type: stiff, shape: {box: {size: [20 mm, 20 mm, 80 mm], edge_length: 100 mm}}, material: steel, position: [0, 0, -40 mm]}
  calf: {type: stiff, shape: {box: {size: [16 mm, 16 mm, 80 mm], edge_length: 100 mm}}, material: steel, position: [0, 0, -120 mm]}
  foot: {type: soft, shape: {sphere: {radius: 15 mm, edge_length: 8 mm}}, material: rubber, position: [0, 0, -165 mm]}
  ground: {type: half_space, point: [0, 0, -181 mm]}
effects:
  inertia: {}
  gravity: {}
  elasticity: {}
  affine_body: {}
  joint:
    - {name: hip, type: revolute, body: thigh, at: [0, 0, 0], axis: [0, 1, 0], angle_limits: [-60 deg, 60 deg]}
    - {name: knee, type: revolute, body: calf, to: thigh, at: [0, 0, -80 mm], axis: [0, 1, 0], angle_limits: [-1 deg, 100 deg]}
  drive:
    - {joint: hip, mode: pd, kp: 4, kd: 0.04, effort: 3, velocity: 20, file: {path: )" +
         csv + R"(, column: hip}}
    - {joint: knee, mode: kinematic, file: {path: )" +
         csv + R"(, column: knee, unit: rad}}
  bond: [{body: foot, to: calf, within: 0}]
  barrier_contact: {d_hat: 1 mm, stiffness: 50 kPa, pairs: [[foot, ground]]}
  friction: {follows: barrier_contact, mu: 0.6}
)";
}
std::string gait() {
  const std::string path = ::testing::TempDir() + "mortise_gait.csv";
  std::ofstream file(path);
  file << "# a kick\ntime [ms], hip [deg], knee\n";
  for (int i = 0; i <= 20; ++i) file << 10 * i << ", " << -25 * std::sin(0.3 * i) << ", " << 0.4 * (1 - std::cos(0.25 * i)) << "\n";
  return path;
}
// Where everything is, and what joints and motors report.
std::vector<double> state(Rig& rig) {
  const Captured f = rig.fields();
  std::vector<double> out = rig.engine->points();
  for (const char* name : {"joint/hip_angle", "joint/hip_rate", "drive/hip_torque", "drive/knee_torque", "joint/knee_angle"})
    out.push_back(f.at(name));
  return out;
}

}  // namespace

TEST(Drives, ResumeWithTheSameBits) {
  Rig unbroken(leg(gait())), broken(leg(gait()));
  unbroken.steps(12);
  broken.steps(7);
  broken.resume();
  broken.steps(5);
  EXPECT_EQ(state(unbroken), state(broken));
}

TEST(Drives, InBatchesWithEveryLinearSolver) {
  for (const char* linear : {"direct", "cg"}) {
    Rig rig(leg(gait()), {std::string("solver.linear=") + linear});
    const auto with = [&](const std::vector<double>& densities) {
      model::ModelInput in = rig.input;
      in.bodies.clear();
      for (std::size_t e = 0; e < densities.size(); ++e)
        for (model::BodyInput b : rig.input.bodies) {
          if (e > 0 && b.type == model::BodyType::half_space) continue;
          b.env = static_cast<int>(e);
          if (b.name == "calf") b.material.set("density", Params::make_number(densities[e]));
          in.bodies.push_back(std::move(b));
        }
      Rig all(std::move(in));
      all.steps(8);
      return all.engine->points();
    };
    const std::vector<double> both = with({1000, 9000}), one = with({1000}), other = with({9000});
    std::vector<double> apart = one;
    apart.insert(apart.end(), other.begin(), other.end());
    EXPECT_EQ(both, apart) << linear;
    EXPECT_NE(one, other);
  }
}

// A step that turns too far is cut; one that fails leaves everything where it was.
TEST(Drives, StepsAreCutWhereTurnsAreLong) {
  Rig rig(link("", "mode: kinematic, sine: {angle: 60 deg, frequency: 2}", 20));
  for (int i = 0; i < 10; ++i) {
    const solver::StepReport report = rig.step();
    EXPECT_GT(report.substeps, i == 0 ? 1 : 0);
    EXPECT_LT(std::abs(rig.fields().at("drive/hip_error")), 1e-13);
  }
}

// What is given has to pass, or the step fails: a driven link and a pinned wall, both of which nothing moves.
TEST(Drives, GivenWaysAreChecked) {
  std::string yaml = link("", "mode: kinematic, angle: {time: [0, 0.5], value: [0, 80 deg]}", 5);
  yaml.replace(yaml.find("effects:"), 8,
               "  wall: {type: stiff, shape: {box: {size: [20 mm, 60 mm, 20 mm], edge_length: 100 mm}}, material: steel, position: [60 mm, 0, -60 "
               "mm]}\neffects:\n  pin: [{body: wall, where: {side: all}}]\n  barrier_contact: {d_hat: 1 mm}\n");
  Rig rig(yaml);
  std::string why;
  try {
    rig.steps(100);
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), Exit::solve);
    why = e.what();
  }
  EXPECT_NE(why.find("'arm'"), std::string::npos) << why;
  EXPECT_NE(why.find("'wall'"), std::string::npos) << why;
  EXPECT_GT(rig.fields().at("joint/hip_angle"), 0.2);
}

namespace {

std::string refused(const std::string& yaml) {
  try {
    Rig rig(yaml);
    return "";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), Exit::scene);
    return e.what();
  }
}

}  // namespace

TEST(Drives, Refusals) {
  const auto drive = [](const std::string& d, const std::string& joint = "") { return refused(link(joint, d, 5)); };
  const auto says = [](const std::string& message, const std::string& text) { EXPECT_NE(message.find(text), std::string::npos) << message; };
  says(drive("mode: pd, angle: 1"), "needs 'kp'");
  says(drive("mode: pd, kp: 1"), "needs a target: 'angle', 'file', 'sine' or 'gait'");
  says(drive("mode: pd, kp: 1, torque: 1"), "torque has no meaning: of this joint a drive of mode pd aims at 'angle'");
  says(drive("mode: pd, kp: 1, angle: 1, velocity: 1"), "velocity needs 'effort'");
  says(drive("mode: effort, torque: 1, kp: 3"), "kp has no meaning in a drive of mode effort");
  says(drive("mode: passive"), "needs 'damping', 'friction', 'stiffness' or 'armature'");
  says(drive("mode: passive, friction: 1, rest: 1"), "rest has no meaning without 'stiffness'");
  says(drive("mode: kinematic, angle: 0, armature: 1"), "armature has no meaning in a drive of mode kinematic");
  says(drive("mode: kinematic, angle: 20 deg"), "begins at 0.349066 rad, but the joint stands at 0 rad");
  says(drive("mode: kinematic, angle: {time: [0, 1], value: [0, 20 deg]}", ", angle_limits: [-0.1, 0.1]"), "beyond the limits of the joint");
  says(drive("mode: kinematic, angle: 0, friction: 1"), "friction has no meaning in a drive of mode kinematic");
  says(drive("mode: pd, kp: 1, sine: {torque: 1, frequency: 1}"), "torque has no meaning");
  says(drive("mode: pd, kp: 1, sine: {frequency: 1}"), "needs 'angle', its amplitude");
  says(refused(link("", "mode: passive, friction: 1}, {joint: hip, mode: passive, friction: 1", 5)), "'hip' has a drive already");
  says(refused(link("", "mode: passive, friction: 1}, {joint: hp, mode: passive, friction: 1", 5)), "no joint is called 'hp'; there are: 'hip'");
  says(drive("", ", angle_limits: [0.1, 0.4]"), "stands at 0.000000 rad, which is not between its limits");
  says(drive("", ", angle_limits: [0.4, 0.1]"), "two increasing angles");
  const std::string csv = ::testing::TempDir() + "mortise_refused.csv";
  const auto file = [&](const std::string& text, const std::string& more = "") {
    std::ofstream(csv) << text;
    return drive("mode: pd, kp: 1, file: {path: " + csv + ", column: hip" + more + "}");
  };
  says(file("time [s], hip\n0,0\n"), "refused.csv:1:11: error: column 'hip' has no unit");
  says(file("time, hip [deg]\n0,0\n"), "refused.csv:1:1: error: column 'time' has no unit");
  says(file("time [s], hip [mm]\n0,0\n"), "refused.csv:1:11: error: 'mm' is no unit of this drive's angle");
  says(file("time [s], hip [deg]\n0,0\n0,1\n"), "refused.csv:3:1: error: times must increase");
  says(file("time [s], knee [deg]\n0,0\n"), "has no column 'hip'; there are: 'time', 'knee'");
  says(file("time [s], hip [deg]\n0,0\n", ", unit: rad"), "says deg");
}

// ---- prismatic joints

namespace {

// A jaw of 40 g that slides along `axis` on what `to` says, where it stands at 20 mm.
std::string jaws(const std::string& effects, double dt_ms, const std::string& more = "", const std::string& axis = "[1, 0, 0]") {
  return fmt::format(R"(
mortise: 1
name: jaws
time: {{step: {} ms, steps: 1000}}
materials: {{steel: {{density: 1000}}, rubber: {{youngs_modulus: 0.2 MPa, poisson_ratio: 0.4, density: 1000}}}}
bodies:
  left: {{type: stiff, shape: {{box: {{size: [100 mm, 20 mm, 20 mm], edge_length: 100 mm}}}}, material: steel, position: [-70 mm, 0, 0]}}
{}effects:
  inertia: {{}}
  gravity: {{}}
  affine_body: {{stiffness: 1 GPa}}
  joint:
    - {{name: left, type: prismatic, body: left, axis: {}, travel: 20 mm, travel_limits: [0, 60 mm]{}}}
{})",
                     dt_ms, more.substr(0, more.find('|')), axis, more.find('|') == std::string::npos ? "" : more.substr(more.find('|') + 1),
                     effects);
}

}  // namespace

// A load of 3 kg on a slide, on a cart of 1 kg that is held in every way that leaves its place known: what holds the cart bears both, with the moment
// of where the load is.
TEST(Slides, BearOnWhatCarriesThem) {
  const auto fields = [](const std::string& joints, const std::string& more, const std::string& bodies = "") {
    Rig rig(fmt::format(R"(
mortise: 1
name: carried
time: {{step: 5 ms, steps: 100}}
bodies:
  cart: {{type: stiff, shape: {{box: {{size: [50 mm, 50 mm, 50 mm], edge_length: 50 mm}}}}, mass: 1}}
  load: {{type: stiff, shape: {{box: {{size: [50 mm, 50 mm, 50 mm], edge_length: 50 mm}}}}, mass: 3, position: [40 mm, 0, 60 mm]}}
{}effects:
  inertia: {{}}
  gravity: {{acceleration: [0, 0, -10]}}
  affine_body: {{}}
  joint:
    - {{name: cross, type: prismatic, body: load, to: cart, axis: [1, 0, 0]}}
{}{}
)",
                        bodies, joints, more));
    rig.steps(20);
    return rig.fields();
  };
  const std::string lift = "    - {name: lift, type: prismatic, body: cart, axis: [0, 0, 1]}\n",
                    hinge = "    - {name: lift, type: revolute, body: cart, axis: [0, 1, 0], at: [-100 mm, 0, 0]}\n";
  const std::string held = "drive: [{joint: lift, mode: kinematic, travel: 0}]";
  EXPECT_NEAR(fields(lift, "  " + held).at("drive/lift_force"), 40, 1e-6);
  EXPECT_NEAR(fields(lift, "  " + held).at("joint/cross_guide_z"), 30, 1e-6);
  const Captured turned = fields(hinge, "  drive: [{joint: lift, mode: kinematic, angle: 0}]");
  EXPECT_NEAR(std::abs(turned.at("drive/lift_torque")), 10 * 0.1 + 30 * 0.14, 1e-6);
  EXPECT_NEAR(turned.at("joint/lift_force_z"), 40, 1e-6);
  const Captured fixed = fields("    - {name: lift, type: fixed, body: cart}\n", "");
  EXPECT_NEAR(fixed.at("joint/lift_force_z"), 40, 1e-6);
  EXPECT_NEAR(fixed.at("balance/joint_z"), 40, 1e-6);
  EXPECT_LT(vector(fixed, "balance/defect_").norm(), 1e-6);
  const Captured pinned = fields("", "  pin: [{body: cart, where: {side: all}}]");
  EXPECT_NEAR(pinned.at("supports/cart_z"), 40, 1e-6);
  EXPECT_LT(pinned.at("supports/cart_defect"), 1e-6);
  EXPECT_FALSE(pinned.has("supports/load_z"));
  // A slide on the slide, and one that does as the slide does: of two and of five kilograms.
  const std::string box = ": {type: stiff, shape: {box: {size: [20 mm, 20 mm, 20 mm], edge_length: 20 mm}}, mass: ";
  const Captured jaws = fields(
      "    - {name: other, type: prismatic, body: other, to: cart, axis: [1, 0, 0], mimic: {joint: cross, ratio: -1}}\n"
      "    - {name: rider, type: prismatic, body: rider, to: load, axis: [0, 1, 0]}\n",
      "  pin: [{body: cart, where: {side: all}}]",
      "  other" + box + "5, position: [-80 mm, 0, 60 mm]}\n  rider" + box + "2, position: [0, 0, 0.2]}\n");
  EXPECT_NEAR(jaws.at("supports/cart_z"), 110, 1e-5);
  // What mimics by a tie is borne by the one that leads, -1 times, and by the cart, twice.
  EXPECT_NEAR(jaws.at("joint/cross_guide_z"), 50 - 50, 1e-5);
  EXPECT_NEAR(jaws.at("joint/rider_guide_z"), 20, 1e-5);
  EXPECT_NEAR(jaws.at("joint/other_force_z"), 50, 1e-5);
}

// On a slope of the world: weight along the axis, bearing across it, a stop at its end.
TEST(Slides, FallAlongTheirAxis) {
  const Vec3 u = Vec3(1, 0, -1).normalized();
  Rig rig(jaws("", 1, "", "[1, 0, -1]"));
  const double along = 9.81 * -u[2] * -1;
  for (int i = 0; i < 50; ++i) rig.step();
  Captured f = rig.fields();
  const double t = 0.05;
  EXPECT_NEAR(f.at("joint/left_rate"), std::abs(along) * t, 1e-6);
  EXPECT_NEAR(f.at("joint/left_travel"), 0.02 + 0.5 * std::abs(along) * t * (t + 1e-3), 1e-7);
  EXPECT_LT(vector(f, "balance/defect_").norm(), 1e-6);
  // What the guide bears is across.
  EXPECT_LT((vector(f, "supports/left_") - 0.04 * 9.81 * (Vec3(0, 0, 1) - u[2] * u)).norm(), 1e-6);
  EXPECT_FALSE(f.has("joint/left_guide_z")) << "it would be told twice";
  double highest = 0;
  for (int i = 0; i < 400; ++i) {
    rig.step();
    f = rig.fields();
    highest = std::max(highest, f.at("joint/left_travel"));
    ASSERT_LT(f.at("joint/left_travel"), 0.06);
  }
  EXPECT_GT(highest, 0.0595);
  EXPECT_LT(vector(f, "balance/defect_").norm(), 1e-6);  // the stop's force is the joint's, like that of the tie
  EXPECT_NEAR(f.at("joint/left_stop"), -0.04 * std::abs(along), 1e-3 * 0.04 * 9.81);
}

// A gripper on an arm whose angle is given: one motor presses with 5 N, the other jaw mimics it exactly, and the ball between bears it.
TEST(Slides, GripWithAGivenForce) {
  const std::string bodies =
      R"(  palm: {type: stiff, shape: {box: {size: [40 mm, 40 mm, 10 mm], edge_length: 100 mm}}, material: steel, position: [0, 0, 60 mm]}
  right: {type: stiff, shape: {box: {size: [100 mm, 20 mm, 20 mm], edge_length: 100 mm}}, material: steel, position: [70 mm, 0, 0]}
  ball: {type: soft, shape: {sphere: {radius: 14 mm, edge_length: 6 mm}}, material: rubber}
|, to: palm)";
  const std::string effects = R"(    - {name: right, type: prismatic, body: right, to: palm, axis: [-1, 0, 0], mimic: {joint: left}}
    - {name: wrist, type: revolute, body: palm, at: [0, 0, 60 mm], axis: [0.3, 1, 0.2]}
  elasticity: {}
  drive:
    - {joint: left, mode: effort, force: 5 N, effort: 5, velocity: 0.2, damping: 3}
    - {joint: wrist, mode: kinematic, angle: {time: [0.1, 0.3], value: [0, 40 deg]}, interpolation: smooth}
  barrier_contact: {d_hat: 0.5 mm, stiffness: 50 kPa, pairs: [[ball, left], [ball, right]]}
  friction: {follows: barrier_contact, mu: 0.8}
)";
  Rig rig(jaws(effects, 5, bodies), {"effects.gravity.acceleration=[0, 0, 0]"});
  Captured f;
  for (int i = 0; i < 80; ++i) {
    rig.step();
    f = rig.fields();
    EXPECT_NEAR(f.at("joint/right_travel"), f.at("joint/left_travel") - 0.02, 1e-14);
    EXPECT_LT(std::abs(f.at("drive/wrist_error")), 1e-13);
    EXPECT_LT(f.at("joint/tie_error"), 1e-14);
    EXPECT_LT(vector(f, "balance/defect_").norm(), 1e-2 * 5);
  }
  EXPECT_EQ(f.at("drive/left_force"), 5);
  // Half of the motor's force on every side: the jaws share it.
  const Vec3 on_ball = vector(f, "barrier_contact/force_ball_");
  EXPECT_LT(on_ball.norm(), 0.1);
  EXPECT_GT(f.at("joint/left_travel"), 0.025);
  EXPECT_NEAR(f.at("joint/left_rate"), 0, 1e-2);
}

// Given travel, between bodies that fly: exact, and no momentum.
TEST(Slides, GivenTravelIsExact) {
  const std::string bodies =
      "  palm: {type: stiff, shape: {box: {size: [40 mm, 40 mm, 10 mm], edge_length: 100 mm}}, material: steel, position: [0, 0, 60 mm]}\n|, to: "
      "palm";
  Rig rig(jaws("  drive: [{joint: left, mode: kinematic, travel: {time: [0, 0.1], value: [20 mm, 50 mm]}, interpolation: smooth}]\n", 2, bodies),
          {"effects.gravity.acceleration=[0, 0, 0]"});
  for (int i = 0; i < 40; ++i) {
    rig.step();
    const Captured f = rig.fields();
    EXPECT_LT(std::abs(f.at("drive/left_error")), 1e-14);
    EXPECT_LT(vector(f, "inertia/momentum_").norm(), 1e-8);
  }
  EXPECT_GT(std::abs(rig.fields().at("drive/left_force")), 1e-3);
}

TEST(Slides, PdAgainstItsEquation) {
  // m s'' = kp (target - s) - kd s'
  const double kp = 40, kd = 1, target = 0.05, T = 0.1;
  double s = 0.02, v = 0;
  const int n = 1000000;
  for (int i = 0; i < n; ++i) v += T / n * (kp * (target - s) - kd * v) / 0.04, s += T / n * v;
  double error[2];
  for (int k = 0; k < 2; ++k) {
    const double dt = k == 0 ? 0.4 : 0.2;
    Rig rig(jaws(fmt::format("  drive: [{{joint: left, mode: pd, kp: {}, kd: {}, travel: {}}}]\n", kp, kd, target), dt));
    rig.steps(static_cast<int>(std::lround(T * 1e3 / dt)));
    error[k] = std::abs(rig.fields().at("joint/left_travel") - s);
  }
  EXPECT_LT(error[0], 3e-4);
  EXPECT_LT(error[1], 0.6 * error[0]);
}

TEST(Slides, Refusals) {
  const auto says = [](const std::string& message, const std::string& text) { EXPECT_NE(message.find(text), std::string::npos) << message; };
  says(refused(jaws("  drive: [{joint: left, mode: pd, kp: 1, angle: 1}]\n", 1)),
       "angle has no meaning: of this joint a drive of mode pd aims at 'travel'");
  says(refused(jaws("  drive: [{joint: left, mode: effort, torque: 1}]\n", 1)), "aims at 'force'");
  says(refused(jaws("", 1, "|, mimic: {joint: right}")), "there is no such joint");
  says(refused(jaws("", 1, "|, angle: 3")), "angle has no meaning in a prismatic joint");
}

// m a = F, however short the steps are: what strain makes of a slide's coordinate, on a carrier that moves freely, is no rate that damping acts on.
TEST(Drives, DampedSlidesOnBodiesThatMoveGoAsTheirForceSays) {
  Rig rig(R"(
mortise: 1
name: boom
time: {step: 0.05 ms, steps: 1}
materials: {al: {density: 2700}}
bodies:
  boom: {type: stiff, shape: {box: {size: [300 mm, 50 mm, 50 mm], edge_length: 300 mm}}, material: al, mass: 2, position: [150 mm, 0, 0]}
  tele: {type: stiff, shape: {box: {size: [200 mm, 30 mm, 30 mm], edge_length: 200 mm}}, material: al, mass: 0.8, position: [250 mm, 0, 0]}
effects:
  inertia: {}
  affine_body: {}
  joint:
    - {name: turn, type: revolute, body: boom, at: [0, 0, 0], axis: [0, 0, 1]}
    - {name: slide, type: prismatic, body: tele, to: boom, axis: [1, 0, 0]}
  drive: [{joint: slide, mode: pd, kp: 3000, kd: 60, travel: {time: [0, 60 ms], value: [0, 150 mm]}, interpolation: smooth}]
)");
  rig.steps(1199);
  const double before = rig.fields().at("joint/slide_rate");
  rig.steps(1);
  const Captured f = rig.fields();
  const double force = f.at("drive/slide_force");
  EXPECT_GT(std::abs(force), 10);
  EXPECT_NEAR(0.8 * (f.at("joint/slide_rate") - before) / 0.05e-3, force, 2e-3 * std::abs(force));
}
