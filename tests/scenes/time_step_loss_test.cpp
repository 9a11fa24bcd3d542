// What turning bodies, vibrations and bounces lose to the time step, and what certificates say of it (audit/turning_loss.h, vibration_loss.h,
// bounce_loss.h).
#include <fmt/format.h>

#include <cmath>

#include "audited.h"
#include "dropped.h"
#include "link.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

std::string ball(const std::string& inertia, double omega) {
  return fmt::format(R"(
mortise: 1
name: ball
time: {{step: 5 ms, steps: 100}}
materials: {{steel: {{density: 7800}}}}
bodies:
  ball: {{type: stiff, shape: {{sphere: {{radius: 15 mm, edge_length: 3 mm}}}}, material: steel, position: [0, 0, 15.05 mm], angular_velocity: [0, {}, 0]}}
effects:
  inertia: {{integrator: {}}}
  affine_body: {{}}
)",
                     omega, inertia);
}

}  // namespace

// In flight, where the loss is measured too.
TEST(TurningLoss, IsThatOfABodyInFlight) {
  for (const double omega : {10.0, 20.0, 40.0}) {
    const Turned t = turn(ball("backward_euler", omega), 20);
    EXPECT_NEAR(t.energy.turning_loss, t.energy.free_loss, 0.15 * t.energy.free_loss) << omega;
  }
  // BDF2 starts in parts of a step, and it takes some steps until it loses what it always does.
  for (const double omega : {20.0, 40.0, 80.0}) {
    const Turned first = turn(ball("bdf2", omega), 10), all = turn(ball("bdf2", omega), 30);
    EXPECT_NEAR(all.energy.turning_loss - first.energy.turning_loss, all.energy.free_loss - first.energy.free_loss,
                0.15 * (all.energy.free_loss - first.energy.free_loss))
        << omega;
  }
}

// After its start, and after every step of first order, BDF2 gives back energy that the step before lost: that is no gain from nowhere. Taken for
// one, every other step was of first order.
TEST(TurningLoss, StepsOfSecondOrderStaySo) {
  for (const double omega : {10.0, 20.0, 40.0, 60.0, 80.0}) {
    const Turned t = turn(ball("bdf2", omega), 40);
    EXPECT_EQ(t.first_order, 0) << omega;
  }
  const Turned t = turn(ball("bdf2", 20), 100);
  EXPECT_LT(t.energy.free_loss, 0.01 * t.energy.scale);  // 0.025 of it with a first step of first order
  const Turned four = turn(ball("bdf2", 40), 4);
  EXPECT_LT(four.energy.free_loss, 0.002 * four.energy.scale);  // 0.1
}

// A ball rolls down a slope: 5/7 g sin(10 deg). What it lacks is seen in contact.
TEST(TurningLoss, IsSeenOfABallThatRolls) {
  const std::string rolling = ball("backward_euler", 0) + R"(
  gravity: {acceleration: [1.7035, 0, -9.661]}
  barrier_contact: {}
  friction: {follows: barrier_contact, mu: 0.5}
)";
  std::string scene = rolling;
  scene.replace(scene.find("effects:"), 8, "  floor: {type: half_space}\neffects:");
  const double a = 5.0 / 7 * 1.7035;
  const Turned coarse = turn(scene, 100), fine = turn(scene, 300, {"time.step=0.5 ms"});
  EXPECT_EQ(coarse.energy.free_loss, 0);
  EXPECT_LT(coarse.way, 0.95 * a * 0.5 * 0.5 / 2);
  EXPECT_GT(coarse.energy.turning_loss, 0.2 * coarse.energy.scale);
  EXPECT_LT(fine.energy.turning_loss, 0.06 * fine.energy.scale);  // its facets
}

// What falls beside it, or a heavy tray that carries it, has no share in what it loses.
TEST(TurningLoss, IsThatOfABallWhateverIsBesideIt) {
  const auto of_its_own = [](const std::string& tray, const std::string& more, const std::string& pin) {
    return turn(R"(
mortise: 1
name: tray
time: {step: 5 ms, steps: 60}
materials: {steel: {density: 7850}, wood: {density: 700}}
bodies:
  ball: {type: stiff, shape: {sphere: {radius: 10 mm, edge_length: 4 mm}}, material: wood, position: [-20 mm, 0, 15.06 mm]}
  tray: {type: stiff, shape: {box: {size: [300 mm, 300 mm, 10 mm], edge_length: 300 mm}}, material: )" +
                    tray + "}\n" + more + R"(effects:
  inertia: {}
  gravity: {}
  affine_body: {}
  barrier_contact: {}
  friction: {follows: barrier_contact, mu: 0.6}
  pin: [{body: tray, where: {side: all}, motion: {time: [0, 0.1], rotation: {axis: [0, 1, 0], angle: [0, 20 deg]}, interpolation: smooth)" +
                    pin + "}}]\n",
                60)
        .energy.own_turning;
  };
  const double alone = of_its_own("wood", "", "");
  EXPECT_GT(alone, 0.3);
  EXPECT_NEAR(of_its_own("steel", "", ""), alone, 0.1 * alone);
  EXPECT_NEAR(
      of_its_own("wood", "  other: {type: stiff, shape: {box: {size: [0.2, 0.2, 0.1], edge_length: 0.2}}, material: steel, position: [2, 0, 0]}\n",
                 ""),
      alone, 0.1 * alone);
}

namespace {

// A motor of 0.05 N m between a wheel of 0.2 kg and a cart of 0.8 kg on guides: tau / R / (M + m / 2).
std::string wheel(double facets) {
  return fmt::format(R"(
mortise: 1
name: wheel
time: {{step: 4 ms, steps: 100}}
materials: {{steel: {{density: 7850}}}}
bodies:
  cart: {{type: stiff, shape: {{box: {{size: [0.1, 0.04, 0.02], edge_length: 0.05}}}}, material: steel, position: [0, 0, 0.08], mass: 0.8}}
  wheel:
    type: stiff
    shape: {{cylinder: {{radius: 0.03, height: 0.02, edge_length: {}}}}}
    material: steel
    mass: 0.2
    inertia: {{moments: [9e-5, 9e-5, 9e-5]}}
    position: [0, 0, 0.0301]
    rotation: {{axis: [1, 0, 0], angle: 90 deg}}
  guide: {{type: stiff, shape: {{box: {{size: [0.01, 0.01, 0.01], edge_length: 0.01}}}}, material: steel, position: [0, 0, 0.15], mass: 1 g}}
  floor: {{type: half_space}}
effects:
  inertia: {{}}
  gravity: {{}}
  affine_body: {{}}
  joint:
    - {{name: x, type: prismatic, body: guide, axis: [1, 0, 0]}}
    - {{name: z, type: prismatic, body: cart, to: guide, axis: [0, 0, 1]}}
    - {{name: axle, type: revolute, body: wheel, to: cart, at: [0, 0, 0.0301], axis: [0, 1, 0]}}
  drive: [{{joint: axle, mode: effort, torque: 0.05}}]
  barrier_contact: {{pairs: [[wheel, floor]]}}
  friction: {{follows: barrier_contact, mu: 0.8}}
)",
                     facets);
}

}  // namespace

// A wheel of few facets strikes the floor with one after the other, and the cart is behind by what they take. Of 2.5 mm they take less than 5 %.
TEST(TurningLoss, IsSeenOfAWheelUnderACart) {
  const double way = 0.05 / 0.03 / (0.8 + 0.2 * 1.5 + 0.001) * 0.4 * 0.4 / 2;
  const Turned coarse = turn(wheel(0.02), 100), fine = turn(wheel(0.0025), 400, {"time.step=1 ms"});
  EXPECT_LT(coarse.way, 0.9 * way);
  EXPECT_GT(coarse.energy.turning_loss, 0.1 * coarse.energy.own_scale);
  EXPECT_NEAR(fine.way, way, 0.03 * way);
  EXPECT_LT(fine.energy.turning_loss, 0.05 * fine.energy.own_scale);
}

// An arm on a hinge that pushes a block turns about as fast as it goes, too, and is no wheel.
TEST(TurningLoss, IsNotSeenOfAnArmThatPushes) {
  const Turned t = turn(R"(
mortise: 1
name: arm
time: {step: 5 ms, steps: 100}
materials: {steel: {density: 7850}, gel: {youngs_modulus: 0.2 MPa, poisson_ratio: 0.4, density: 1000}}
bodies:
  arm: {type: stiff, shape: {box: {size: [0.02, 0.02, 0.12], edge_length: 0.02}}, material: steel, position: [0, 0, 0.09], mass: 0.1}
  block: {type: soft, shape: {box: {size: [0.04, 0.04, 0.04], edge_length: 0.02}}, material: gel, position: [0.031, 0, 0.0201]}
  floor: {type: half_space}
effects:
  inertia: {}
  gravity: {}
  elasticity: {}
  affine_body: {}
  joint: [{name: hinge, type: revolute, body: arm, at: [0, 0, 0.15], axis: [0, -1, 0]}]
  drive: [{joint: hinge, mode: pd, kp: 20, kd: 0.5, angle: {time: [0, 0.1, 0.5], value: [0, 0.02, 0.25]}}]
  barrier_contact: {}
  friction: {follows: barrier_contact, mu: 0.4}
)",
                        100);
  EXPECT_LT(t.energy.turning_loss, 0.01 * t.energy.own_scale);
}

// A tray that is driven to and fro under a ball: what the tray weighs changes nothing of what the ball's facets take.
TEST(TurningLoss, IsHeldAgainstWhatIsNotGiven) {
  const auto loss = [](double height) {
    const Turned t = turn(fmt::format(R"(
mortise: 1
name: tray
time: {{step: 5 ms, steps: 80}}
materials: {{steel: {{density: 7850}}}}
bodies:
  ball: {{type: stiff, shape: {{sphere: {{radius: 20 mm, edge_length: 8 mm}}}}, material: steel, position: [0, 0, 20.1 mm]}}
  tray: {{type: stiff, shape: {{box: {{size: [0.8, 0.1, {}], edge_length: 0.1}}}}, material: steel, position: [0.1, 0, {}]}}
effects:
  inertia: {{}}
  gravity: {{}}
  affine_body: {{}}
  pin:
    - body: tray
      where: {{side: all}}
      motion: {{time: [0, 0.2, 0.4], translation: [[0, 0, 0], [0.05, 0, 0.01], [0, 0, 0]], interpolation: smooth}}
  barrier_contact: {{}}
  friction: {{follows: barrier_contact, mu: 0.5}}
)",
                                      height, -height / 2),
                          80);
    EXPECT_GT(t.energy.turning_loss, 0);
    return std::pair{t.energy.turning_loss / t.energy.own_scale, t.energy.turning_loss / t.energy.scale};
  };
  const auto light = loss(0.01), heavy = loss(1);
  EXPECT_NEAR(light.first, heavy.first, 0.2 * light.first);
  EXPECT_GT(heavy.first, 20 * heavy.second);
}

TEST(BounceLoss, IsWhatABounceLacks) {
  const auto lost = [](const Turned& t) { return t.energy.free_loss / t.energy.scale; };
  EXPECT_GT(lost(turn(dropped("backward_euler", kPad) + kPadRests, 110)), 0.5);
  EXPECT_LT(lost(turn(dropped("bdf2", kPad) + kPadRests, 440, {"time.step=0.25 ms"})), 0.05);
}

// What comes to rest lacks nothing, and impacts of stiff bodies have no law that they could lack something of.
TEST(BounceLoss, IsNoneOfLandingsAndOfStiffBodies) {
  const Turned rest = turn(dropped("backward_euler", kPad) + kPadRests, 30, {"time.step=10 ms"});
  EXPECT_LT(rest.energy.free_loss, 0.2 * rest.energy.scale);  // of the fall
  const Turned stiff = turn(dropped("backward_euler", "  floor: {type: half_space, point: [0, 0, 15 mm]}"), 150);
  EXPECT_LT(stiff.energy.free_loss, 0.1 * stiff.energy.scale);
  EXPECT_LT(stiff.energy.impacts, 0.02 * stiff.energy.scale);  // it stays where it fell
}

// A stiff ball strikes another, and both fly on with half of the energy: with how much is in no law.
TEST(BounceLoss, DoubtsImpactsOfStiffBodies) {
  const Turned struck = turn(R"(
mortise: 1
name: strike
time: {step: 1 ms, steps: 60}
materials: {steel: {density: 7850}}
bodies:
  a: {type: stiff, shape: {sphere: {radius: 20 mm, edge_length: 6 mm}}, material: steel, position: [-50 mm, 0, 0], velocity: [1, 0, 0]}
  b: {type: stiff, shape: {sphere: {radius: 20 mm, edge_length: 6 mm}}, material: steel}
effects:
  inertia: {}
  affine_body: {}
  barrier_contact: {}
)",
                             60);
  EXPECT_GT(struck.energy.impacts, 0.1 * struck.energy.scale);
}

namespace {

double share(const Turned& t) { return t.energy.free_loss / t.energy.loss_scale; }

// A bar whose first period is 40 ms. `pin`: more of the pin that it hangs on.
std::string hanging(const std::string& inertia, const std::string& pin, const std::string& more = "") {
  return fmt::format(R"(
mortise: 1
name: bar
time: {{step: 1 ms, steps: 100}}
materials: {{gel: {{model: linear, youngs_modulus: 0.1 MPa, poisson_ratio: 0, density: 1000}}}}
bodies:
  bar: {{type: soft, shape: {{box: {{size: [10 mm, 10 mm, 100 mm], edge_length: 10 mm}}}}, material: gel, position: [0, 0, -50 mm]}}
effects:
  inertia: {{integrator: {}}}
  elasticity: {{}}
  pin: [{{body: bar, where: {{side: z_max}}{}}}]
{})",
                     inertia, pin, more);
}

// The pin goes up and down by 0.5 mm.
std::string shaken(double period, double step, int steps) {
  std::string times, places;
  for (int i = 0; i <= steps; ++i) {
    times += fmt::format("{}{}", i ? ", " : "", i * step);
    places += fmt::format("{}[0, 0, {}]", i ? ", " : "", 5e-4 * std::sin(2 * 3.141592653589793 * i * step / period));
  }
  return ", motion: {time: [" + times + "], translation: [" + places + "]}";
}

// A steel block and a pad on which it would swing with a period of 42 ms.
std::string on_pad(const std::string& inertia, const std::string& block, const std::string& more) {
  return fmt::format(R"(
mortise: 1
name: pad
time: {{step: 1 ms, steps: 100}}
materials: {{steel: {{density: 7800}}, gel: {{youngs_modulus: 0.1 MPa, poisson_ratio: 0, density: 100}}}}
bodies:
  block: {{type: stiff, shape: {{box: {{size: [24 mm, 24 mm, 20 mm], edge_length: 24 mm}}}}, material: steel, {}}}
  pad: {{type: soft, shape: {{box: {{size: [20 mm, 20 mm, 20 mm], edge_length: 10 mm}}}}, material: gel}}
effects:
  inertia: {{integrator: {}}}
  affine_body: {{}}
  elasticity: {{}}
  pin: [{{body: pad, where: {{side: z_min}}}}]
  barrier_contact: {{d_hat: 0.05 mm, stiffness: 50 kPa}}
{})",
                     block, inertia, more);
}

}  // namespace

// At its first resonance its end goes by 6 mm after three periods; backward Euler with 40 steps a period finds 45 % of that.
TEST(VibrationLoss, IsSeenOfABarThatItsPinShakes) {
  const std::string at_resonance = shaken(0.04, 1e-3, 120);
  EXPECT_GT(share(turn(hanging("backward_euler", at_resonance), 120)), 0.2);
  EXPECT_LT(share(turn(hanging("bdf2", at_resonance), 120)), 0.1);
  // A hundred times as slow, nothing vibrates; it is carried up and down.
  EXPECT_LT(share(turn(hanging("backward_euler", shaken(4, 0.1, 120)), 120, {"time.step=0.1 s"})), 0.01);
}

// A constant traction from the start on; the work of loads is in no balance.
TEST(VibrationLoss, IsSeenUnderLoads) {
  const std::string load = "  pressure_load: [{body: bar, where: {side: z_min}, traction: [0, 0, -1000]}]\n";
  const Turned coarse = turn(hanging("backward_euler", "", load), 20, {"time.step=2 ms"});
  EXPECT_FALSE(coarse.energy.work_is_known);
  EXPECT_GT(share(coarse), 0.1);
  EXPECT_LT(share(turn(hanging("backward_euler", "", load), 400, {"time.step=0.1 ms"})), 0.1);  // its peak lacks 6 %
}

// Set down, it would press with twice its weight in the turn of every swing.
TEST(VibrationLoss, IsSeenInContact) {
  const std::string block = "position: [0, 0, 20.04 mm]", weight = "  gravity: {}\n";
  EXPECT_GT(share(turn(on_pad("backward_euler", block, weight), 12, {"time.step=3.5 ms"})), 0.1);
  EXPECT_LT(share(turn(on_pad("backward_euler", block, weight), 210, {"time.step=0.2 ms"})), 0.1);
}

// A block on a floor that a soft bar draws to and fro, without friction to speak of: the floor it comes to takes nothing of that.
TEST(VibrationLoss, IsSeenOfWhatSlides) {
  const auto lost = [](const char* integrator, int steps, const char* step) {
    return share(turn(fmt::format(R"(
mortise: 1
name: slides
time: {{step: 2 ms, steps: 100}}
materials: {{steel: {{density: 2500}}, gel: {{youngs_modulus: 40 kPa, poisson_ratio: 0, density: 100, model: linear}}}}
bodies:
  block: {{type: stiff, shape: {{box: {{size: [40 mm, 40 mm, 40 mm], edge_length: 40 mm}}}}, material: steel, position: [80 mm, 0, 20.05 mm], velocity: [0.3, 0, 0]}}
  bar: {{type: soft, order: 2, shape: {{box: {{size: [60 mm, 30 mm, 30 mm], edge_length: 15 mm}}}}, material: gel, position: [30 mm, 0, 20.05 mm], velocity: [0.3, 0, 0]}}
  floor: {{type: half_space}}
effects:
  inertia: {{integrator: {}}}
  gravity: {{}}
  affine_body: {{}}
  elasticity: {{}}
  pin: [{{body: bar, where: {{side: x_min}}}}]
  bond: [{{body: bar, to: block, where: {{side: x_max}}}}]
  barrier_contact: {{pairs: [[block, floor]]}}
)",
                                  integrator),
                      steps, {fmt::format("time.step={}", step)}));
  };
  EXPECT_GT(lost("backward_euler", 60, "2 ms"), 0.3);  // its fifth swing lacks half
  EXPECT_GT(lost("bdf2", 60, "5 ms"), 0.1);
  EXPECT_LT(lost("bdf2", 100, "1 ms"), 0.05);
}

// On a slide too, which leaves no body free.
TEST(BounceLoss, IsSeenOfWhatHangsOnAJoint) {
  const std::string block = "position: [0, 0, 23 mm], velocity: [0, 0, -0.3]",
                    slide = "  joint: [{name: slide, type: prismatic, body: block, axis: [0, 0, 1]}]\n";
  EXPECT_GT(share(turn(on_pad("backward_euler", block, slide), 60)), 0.2);
  EXPECT_LT(share(turn(on_pad("bdf2", block, slide), 120, {"time.step=0.5 ms"})), 0.05);
}

// Of a ball that is thrown it is not the energy of its flight that the spin is held against.
TEST(TurningLoss, IsAShareOfABodysOwnTurningInFlight) {
  std::string thrown = ball("backward_euler", 60) + "  gravity: {}\n";
  thrown.replace(thrown.find("angular_velocity"), 0, "velocity: [5, 0, 3], ");
  const Turned t = turn(thrown, 250, {"time.step=2 ms"});
  EXPECT_LT(t.energy.turning_loss, 0.1 * t.energy.scale);
  EXPECT_GT(t.energy.own_turning, 0.5);
}

// A body on a pin that shakes it, m = 1 kg, amplitude 1 mm, n steps in a period: the force of the pin is late by a step.
TEST(GivenLag, IsThatOfAShakenBody) {
  const auto lag = [](int n, const std::string& more, const std::string& beside = "") {
    std::string times, ways;
    for (int k = 0; k <= 3 * n; ++k) {
      times += fmt::format("{}{}", k ? ", " : "", 0.01 * k);
      ways += fmt::format("{}[{}, 0, 0]", k ? ", " : "", 1e-3 * std::sin(2 * M_PI * k / n));
    }
    return turn(fmt::format(R"(
mortise: 1
name: shaken
time: {{step: 10 ms, steps: {}}}
bodies:
  table: {{type: stiff, shape: {{box: {{size: [0.1, 0.1, 0.02], edge_length: 0.1}}}}, mass: 1}}
{}effects:
  inertia: {{}}
  affine_body: {{}}
  pin: [{{body: table, where: {{side: all}}, motion: {{time: [{}], translation: [{}]}}}}]
  {}
)",
                            3 * n, beside, times, ways, more),
                3 * n)
        .energy.given_lag;
  };
  // Of the quarter in which a falls by less than itself, wh (1 - sin d) / cos d with tan d = wh = 2 pi / n; of the one in which it grows half as
  // much.
  EXPECT_NEAR(lag(20, ""), 0.28, 0.06);
  EXPECT_NEAR(lag(80, ""), 0.08, 0.02);
  EXPECT_LT(lag(20, "gravity: {}"), 0.03) << "its weight is far more";
  // A heavy body on a stiff motor somewhere else bears forces of its own.
  const std::string slide =
      "joint: [{name: slide, type: prismatic, body: slider, axis: [1, 0, 0]}]\n  drive: [{joint: slide, mode: pd, kp: 50000, kd: 8000, travel: 0.1}]";
  EXPECT_NEAR(lag(20, slide, "  slider: {type: stiff, shape: {box: {size: [0.1, 0.1, 0.1], edge_length: 0.1}}, mass: 20, position: [2, 0, 0]}\n"),
              0.28, 0.06);
  const std::string straight = R"(
mortise: 1
name: jump
time: {step: 10 ms, steps: 20}
bodies:
  table: {type: stiff, shape: {box: {size: [0.1, 0.1, 0.02], edge_length: 0.1}}, mass: 1}
effects:
  inertia: {}
  affine_body: {}
  pin: [{body: table, where: {side: all}, motion: {time: [0, 0.05, 0.1, 0.2], translation: [[0, 0, 0], [0, 0, 0], [0.01, 0, 0], [0.01, 0, 0]]}}]
)";
  EXPECT_TRUE(std::isnan(turn(straight, 20).energy.given_lag)) << "it starts and stops at once";
}

// A table of stiff parts on three stiff feet falls by 2 mm and stays: what its feet bring is the energy of all of it. A bar falls on the stop of its
// hinge, and what it turned with is no vibration.
TEST(VibrationLoss, IsNoneOfWhatHangsTogetherAndLands) {
  std::string table = R"(
mortise: 1
name: table
time: {step: 1 ms, steps: 60}
materials: {steel: {density: 7850}, gel: {youngs_modulus: 1 MPa, poisson_ratio: 0.4, density: 1000}}
bodies:
  top: {type: stiff, shape: {box: {size: [0.2, 0.2, 0.02], edge_length: 0.1}}, material: steel, position: [0, 0, 0.06], mass: 1}
  floor: {type: half_space}
)",
              joints;
  for (const auto& [name, x, y] : {std::tuple{"a", 0.06, 0.0}, {"b", -0.03, 0.05}, {"c", -0.03, -0.05}}) {
    table += fmt::format(
        "  {}: {{type: stiff, shape: {{sphere: {{radius: 0.01, edge_length: 0.004}}}}, material: steel, mass: 10 g, position: [{}, {}, 0.012]}}\n",
        name, x, y);
    joints += fmt::format("    - {{type: fixed, body: {}, to: top}}\n", name);
  }
  table += "  pad: {type: soft, shape: {box: {size: [0.02, 0.02, 0.01], edge_length: 0.005}}, material: gel, position: [0, 0, 0.2]}\n";
  table +=
      "effects:\n  inertia: {}\n  gravity: {}\n  elasticity: {}\n  affine_body: {}\n  pin: [{body: pad, where: {side: z_max}}]\n  barrier_contact: "
      "{}\n  joint:\n";
  const Turned landed = turn(table + joints, 60);
  EXPECT_LT(landed.energy.free_loss, 0.06 * landed.energy.turnover);  // of its flight
  const Turned stopped = turn(R"(
mortise: 1
name: stop
time: {step: 5 ms, steps: 200}
materials: {steel: {density: 7850}}
bodies: {bar: {type: stiff, shape: {box: {size: [0.2, 0.02, 0.02], edge_length: 0.05}}, material: steel, position: [0.1, 0, 0], mass: 0.5}}
effects:
  inertia: {}
  gravity: {}
  affine_body: {}
  joint: [{name: j, type: revolute, body: bar, at: [0, 0, 0], axis: [0, -1, 0], angle_limits: [-0.5, 0.5], stop_effort: 5}]
  drive: [{joint: j, mode: passive, damping: 0.05}]
)",
                              200);
  EXPECT_LT(stopped.energy.free_loss, 0.12 * stopped.energy.turnover);
  EXPECT_LT(stopped.energy.own_loss, 0.12);
}

// A box on a belt that starts and stops by `smooth` keys: BDF2 makes 3/2 of the acceleration where it turns at once, whatever the step, but where
// the run begins with it, in shorter steps; and the friction that carries the box along with it.
TEST(GivenKinks, OvershootWhatBdf2Accelerates) {
  const auto kinks = [](const std::string& keys, const std::string& ways, const std::string& integrator, double step) {
    return turn(fmt::format(R"(
mortise: 1
name: belt
time: {{step: {}, steps: 1}}
materials: {{wood: {{density: 700}}}}
bodies:
  box: {{type: stiff, shape: {{box: {{size: [80 mm, 60 mm, 50 mm], edge_length: 20 mm}}}}, material: wood, position: [0, 0, 25.2 mm]}}
  belt: {{type: stiff, shape: {{box: {{size: [2 m, 200 mm, 20 mm], edge_length: 200 mm}}}}, material: wood, position: [0, 0, -10 mm]}}
effects:
  inertia: {{integrator: {}}}
  gravity: {{}}
  affine_body: {{}}
  pin: [{{body: belt, where: {{side: all}}, motion: {{time: {}, translation: {}, interpolation: smooth}}}}]
  barrier_contact: {{}}
  friction: {{follows: barrier_contact, mu: 0.8}}
)",
                            step, integrator, keys, ways),
                static_cast<int>(0.4 / step))
        .energy.given_kinks;
  };
  const std::string rests = "[0, 0.1, 0.3, 0.4]", ways = "[[0, 0, 0], [0, 0, 0], [0.03, 0, 0], [0.03, 0, 0]]";
  for (const double step : {0.005, 0.002}) {
    EXPECT_GT(kinks(rests, ways, "bdf2", step), 0.15) << step;
    EXPECT_LT(kinks(rests, ways, "bdf2", step), 0.9) << step;
  }
  EXPECT_LT(kinks("[0, 0.2, 0.4]", "[[0, 0, 0], [0.03, 0, 0], [0.03, 0, 0]]", "bdf2", 0.005), 0.05) << "it starts at once";
  EXPECT_TRUE(std::isnan(kinks(rests, ways, "backward_euler", 0.005)));
  std::string keys, cycloid;  // whose acceleration begins with nothing
  for (int k = 0; k <= 80; ++k) {
    const double t = 2 * M_PI * k / 80;
    keys += fmt::format("{}{}", k ? ", " : "", 0.005 * k), cycloid += fmt::format("{}[{}, 0, 0]", k ? ", " : "", 5e-3 * (t - std::sin(t)));
  }
  EXPECT_LT(kinks("[" + keys + "]", "[" + cycloid + "]", "bdf2", 0.005), 0.05);
}

// A pad that is held, and that a block falls on, jolts as much: nobody told it to. Nor does a body that spins in flight swing.
TEST(GivenKinks, AreOfWhatIsToldToMove) {
  const Turned struck = turn(R"(
mortise: 1
name: struck
time: {step: 0.2 ms, steps: 1}
materials: {steel: {density: 7850}, gel: {youngs_modulus: 0.5 MPa, poisson_ratio: 0.3, density: 1000}}
bodies:
  pad: {type: soft, shape: {box: {size: [30 mm, 30 mm, 15 mm], edge_length: 7.5 mm}}, material: gel, position: [0, 0, -7.5 mm]}
  block: {type: stiff, shape: {box: {size: [40 mm, 40 mm, 20 mm], edge_length: 40 mm}}, material: steel, position: [0, 0, 10.3 mm], velocity: [0, 0, -0.3]}
effects:
  inertia: {integrator: bdf2}
  elasticity: {}
  affine_body: {}
  barrier_contact: {}
  pin: [{body: pad, where: {side: z_min}}]
)",
                             60);
  EXPECT_TRUE(std::isnan(struck.energy.given_kinks));
  EXPECT_TRUE(std::isnan(struck.energy.given_lag));
  const Turned spins = turn(R"(
mortise: 1
name: spins
time: {step: 5 ms, steps: 1}
materials: {steel: {density: 7850}}
bodies:
  box: {type: stiff, shape: {box: {size: [60 mm, 40 mm, 20 mm], edge_length: 20 mm}}, material: steel, angular_velocity: [0.5, 10, 0.2]}
effects:
  inertia: {integrator: bdf2}
  affine_body: {}
)",
                            120);
  EXPECT_FALSE(spins.energy.motion_lag > 0.05);
}

// A cube is lifted by 100 mm within 100 ms and then held: its weight tells the work.
TEST(WorkLag, IsWhatTheWorkOfSupportsIsTooLargeBy) {
  const auto lifted = [](const std::string& integrator, double step) {
    const int steps = static_cast<int>(std::lround(0.12 / step));
    return turn(fmt::format(R"(
mortise: 1
name: lift
time: {{step: {}, steps: {}}}
bodies:
  cube: {{type: stiff, shape: {{box: {{size: [30 mm, 30 mm, 30 mm], edge_length: 30 mm}}}}, mass: 0.2}}
effects:
  inertia: {{integrator: {}}}
  affine_body: {{}}
  gravity: {{}}
  pin: [{{body: cube, where: {{side: all}}, motion: {{time: [0, 0.1], translation: [[0, 0, 0], [0, 0, 0.1]], interpolation: smooth}}}}]
)",
                            step, steps, integrator),
                steps)
        .energy;
  };
  const double weight = 0.2 * 9.80665 * 0.1;
  for (const double step : {5e-3, 2.5e-3, 1e-3}) {
    const auto energy = lifted("backward_euler", step);
    const double error = energy.support_work - weight;
    EXPECT_GT(error, 50 * step * weight);
    EXPECT_NEAR(energy.work_lag * energy.support_work, error, 0.2 * error) << step;
  }
  EXPECT_NEAR(lifted("bdf2", 2.5e-3).support_work, weight, 0.01 * weight);
  EXPECT_LT(lifted("bdf2", 2.5e-3).work_lag, 0.01);
}

// A pendulum of BDF2 swings in its own time: how far it is from where it should be after some periods.
TEST(SwingPhase, IsHowFarAPendulumIsOff) {
  const double T = 2;
  const auto [x, v] = motion([&](double, double a, double) { return kWeight * std::cos(a); }, T);
  for (const double step : {2.0, 4.0}) {
    Rig rig(link("", "", step, "bdf2"));
    const auto energy = audited(rig, std::lround(T * 1e3 / step), [](const solver::StepReport&, const Captured&) {});
    // The link starts level: it swings by a quarter of a turn to both sides of where it hangs.
    const double error = std::abs(rig.fields().at("joint/hip_angle") - x) / (M_PI / 2);
    EXPECT_GT(error, 2e-3 * step);
    EXPECT_GT(energy.motion_lag, 0.4 * error) << step;
    EXPECT_LT(energy.motion_lag, 2 * error) << step;
  }
}
