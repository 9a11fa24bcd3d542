// What bounces, impacts and swings lose of what a body or mechanism has of its own, beside something with far more energy (audit/bounce_loss.h,
// swing_loss.h).
#include <fmt/format.h>

#include "audited.h"
#include "dropped.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

// A body of 100 kg at 5 m/s that touches nothing.
const std::string kFlyer =
    "  flyer: {type: stiff, shape: {box: {size: [0.1, 0.1, 0.1], edge_length: 0.1}}, material: steel, mass: 100, position: [0, 1, 1], velocity: [5, "
    "0, "
    "0]}\n";

}  // namespace

TEST(OwnLoss, OfABounceIsThatOfWhatBounces) {
  const auto bounces = [](const std::string& inertia, const std::string& under) { return dropped(inertia, under) + kPadRests; };
  const std::string beside_it = kPad + "\n" + kFlyer;
  const Turned beside = turn(bounces("backward_euler", beside_it), 110);
  EXPECT_LT(beside.energy.free_loss, 0.01 * beside.energy.scale);
  EXPECT_GT(beside.energy.own_loss, 0.4);
  EXPECT_LT(turn(bounces("bdf2", beside_it), 330, {"time.step=0.33 ms"}).energy.own_loss, 0.1);
  // Of one that flies aslant, too: what it goes sideways with has no part in the bounce.
  const Turned aslant = turn(bounces("backward_euler", kPad), 110, {"bodies.ball.position=[-0.04, 0, 0.038]", "bodies.ball.velocity=[0.6, 0, 0]"});
  EXPECT_NEAR(aslant.energy.own_loss, beside.energy.own_loss, 0.2);
}

TEST(OwnLoss, OfAnImpactIsThatOfWhatIsStruck) {
  const auto doubt = [](const std::string& beside, double together) {
    return turn(fmt::format(R"(
mortise: 1
name: strike
time: {{step: 1 ms, steps: 60}}
materials: {{steel: {{density: 7850}}}}
bodies:
  a: {{type: stiff, shape: {{sphere: {{radius: 20 mm, edge_length: 6 mm}}}}, material: steel, position: [-50 mm, 0, 0], velocity: [{}, 0, 0]}}
  b: {{type: stiff, shape: {{sphere: {{radius: 20 mm, edge_length: 6 mm}}}}, material: steel, velocity: [{}, 0, 0]}}
{}effects:
  inertia: {{}}
  affine_body: {{}}
  barrier_contact: {{}}
)",
                            together + 1, together, beside),
                60)
        .energy.own_impacts;
  };
  EXPECT_GT(doubt("", 0), 0.5);
  EXPECT_GT(doubt(kFlyer, 0), 0.5);
  EXPECT_GT(doubt("", 3), 0.5);
}

// Of two equal soft balls that meet in flight after less than a step, in as much as one.
TEST(OwnLoss, OfSoftBallsThatMeetInOneStep) {
  for (const double step : {0.005, 0.002}) {
    const Turned met = turn(fmt::format(R"(
mortise: 1
name: meet
time: {{step: {}, steps: 1}}
materials: {{rubber: {{youngs_modulus: 5 MPa, poisson_ratio: 0.3, density: 1100}}}}
bodies:
  a: {{type: soft, shape: {{sphere: {{radius: 10 mm, edge_length: 4 mm}}}}, material: rubber, position: [-21 mm, 0, 0], velocity: [0.5, 0, 0]}}
  b: {{type: soft, shape: {{sphere: {{radius: 10 mm, edge_length: 4 mm}}}}, material: rubber}}
effects:
  inertia: {{}}
  elasticity: {{}}
  barrier_contact: {{}}
)",
                                        step),
                            static_cast<int>(0.1 / step));
    EXPECT_GT(met.energy.own_loss, 0.9) << step;
  }
}

namespace {

// A rod of 0.6 kg that swings by 15 degrees on a car of 30 kg.
std::string pendulum(const std::string& inertia, double speed, const std::string& car, const std::string& how) {
  return fmt::format(R"(
mortise: 1
name: pendulum
time: {{step: 8 ms, steps: 190}}
materials: {{steel: {{density: 7850}}}}
bodies:
  car: {{type: stiff, shape: {{box: {{size: [0.2, 0.1, 0.05], edge_length: 0.05}}}}, material: steel, mass: 30, {}}}
  rod:
    type: stiff
    shape: {{box: {{size: [0.02, 0.02, 0.2], edge_length: 0.02}}}}
    material: steel
    position: [0.0518, 0, -0.2182]
    rotation: {{axis: [0, 1, 0], angle: -15 deg}}
    velocity: [{}, 0, 0]
effects:
  inertia: {{integrator: {}}}
  gravity: {{}}
  affine_body: {{}}
  {}
    - {{name: hinge, type: revolute, body: rod, to: car, at: [0.0259, 0, -0.1216], axis: [0, 1, 0]}}
)",
                     car, speed, inertia, how);
}

}  // namespace

TEST(OwnLoss, OfASwingIsThatOfWhatSwings) {
  const std::string rail = "joint:\n    - {name: rail, type: prismatic, body: car, axis: [1, 0, 0]}";
  const auto lost = [&](const std::string& inertia, double speed, double step = 0.008) {
    return turn(pendulum(inertia, speed, fmt::format("velocity: [{}, 0, 0]", speed), rail), static_cast<int>(1.52 / step),
                {fmt::format("time.step={}", step)})
        .energy.own_loss;
  };
  const double at_rest = lost("backward_euler", 0);
  EXPECT_GT(at_rest, 0.5);
  EXPECT_NEAR(lost("backward_euler", 2), at_rest, 0.15);
  EXPECT_LT(lost("bdf2", 2, 0.004), 0.05);
  // What the world moves as it says.
  const std::string moved =
      "pin: [{body: car, where: {side: all}, motion: {time: [0, 1.5], translation: [[0, 0, 0], [3, 0, 0]], interpolation: smooth}}]\n  joint:";
  EXPECT_GT(turn(pendulum("backward_euler", 0, "velocity: [0, 0, 0]", moved), 190).energy.own_loss, 0.5);
}

// A rod that hangs at rest on a car that starts at once stays behind, and loses nothing by that.
TEST(OwnLoss, IsNoneOfWhatIsTakenAlong) {
  const std::string along = "pin: [{body: car, where: {side: all}, motion: {time: [0, 1], translation: [[0, 0, 0], [0.002, 0, 0]]}}]\n  joint:";
  std::string hangs = pendulum("backward_euler", 0, "velocity: [0, 0, 0]", along);
  hangs.replace(hangs.find("-15 deg"), 7, "0 deg"), hangs.replace(hangs.find("[0.0518, 0, -0.2182]"), 20, "[0.0259, 0, -0.2216]");
  EXPECT_LT(turn(hangs, 190).energy.own_loss, 0.01);
}

// On an arm under a given torque, on one that goes after a target, and on one that goes as the scene says.
TEST(OwnLoss, OfASwingOnAMotorIsThatOfWhatSwings) {
  const auto lost = [](const std::string& motor, const std::string& inertia, int step) {
    const std::string scene = fmt::format(R"(
mortise: 1
name: lever
time: {{step: {} ms, steps: {}}}
materials: {{steel: {{density: 7850}}}}
bodies:
  arm: {{type: stiff, shape: {{box: {{size: [0.4, 0.05, 0.05], edge_length: 0.05}}}}, material: steel, position: [0.2, 0, 0]}}
  lever: {{type: stiff, shape: {{box: {{size: [0.02, 0.02, 0.2], edge_length: 0.02}}}}, material: steel, position: [0.39, 0, -0.13]}}
effects:
  inertia: {{integrator: {}}}
  affine_body: {{}}
  joint:
    - {{name: shoulder, type: revolute, body: arm, at: [0, 0, 0], axis: [0, 0, 1]}}
    - {{name: wrist, type: revolute, body: lever, to: arm, at: [0.39, 0, -0.03], axis: [1, 0, 0]}}
  drive:
    - {{joint: shoulder, {}}}
    - {{joint: wrist, mode: passive, stiffness: 2}}
)",
                                          step, 1000 / step, inertia, motor);
    return turn(scene, 1000 / step).energy.own_loss;
  };
  for (const std::string motor : {"mode: effort, torque: 1", "mode: pd, kp: 200, kd: 10, angle: 0.6 rad",
                                  "mode: kinematic, angle: {time: [0, 0.5, 1], value: [0, 0.15, 0.6]}"}) {
    EXPECT_GT(lost(motor, "backward_euler", 5), 0.4) << motor;
    EXPECT_LT(lost(motor, "bdf2", 2), 0.06) << motor;
  }
}

// A soft rod on a car that a given force moves, or a pin.
TEST(OwnLoss, OfARodThatVibratesIsItsOwn) {
  const auto lost = [](const std::string& moved, const std::string& inertia) {
    return turn(fmt::format(R"(
mortise: 1
name: rod
time: {{step: 4 ms, steps: 125}}
materials:
  steel: {{density: 7850}}
  rubber: {{youngs_modulus: 5 MPa, poisson_ratio: 0.45, density: 1100}}
bodies:
  car: {{type: stiff, shape: {{box: {{size: [0.1, 0.1, 0.05], edge_length: 0.05}}}}, material: steel}}
  rod: {{type: soft, order: 2, shape: {{box: {{size: [0.01, 0.01, 0.1], edge_length: 0.01}}}}, material: rubber, position: [0, 0, 0.075]}}
effects:
  inertia: {{integrator: {}}}
  affine_body: {{}}
  elasticity: {{}}
  bond: [{{body: rod, to: car, where: {{side: z_min}}}}]
  {}
)",
                            inertia, moved),
                125)
        .energy.own_loss;
  };
  const std::string pushed = "joint: [{name: rail, type: prismatic, body: car, axis: [1, 0, 0]}]\n  drive: [{joint: rail, mode: effort, force: 20}]";
  const auto pinned = [](const std::string& motion) { return "pin: [{body: car, where: {side: all}, motion: {" + motion + "}}]"; };
  EXPECT_GT(lost(pushed, "backward_euler"), 0.1);
  EXPECT_LT(lost(pushed, "bdf2"), 0.1);
  EXPECT_GT(lost(pinned("time: [0, 0.25, 0.5], translation: [[0, 0, 0], [0.1, 0, 0], [0.2, 0.1, 0]]"), "backward_euler"), 0.5);
  // So slowly that it only gives.
  EXPECT_LT(lost(pinned("time: [0, 0.5], translation: [[0, 0, 0], [0.02, 0, 0]], interpolation: smooth"), "backward_euler"), 0.01);
}
