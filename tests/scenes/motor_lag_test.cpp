// What the time step makes of joints under motors with gains: the estimate of a run (motor_lag.h) against runs of short steps.
#include <fmt/format.h>

#include <cmath>

#include "audited.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

// An arm of two links that motors swing up in 0.2 s against its weight.
const char* const kArm = R"(
mortise: 1
name: arm
time: {step: 5 ms, steps: 1}
materials: {al: {density: 2700}}
bodies:
  upper: {type: stiff, shape: {box: {size: [200 mm, 30 mm, 30 mm], edge_length: 50 mm}}, material: al, position: [100 mm, 0, 0]}
  lower: {type: stiff, shape: {box: {size: [150 mm, 20 mm, 20 mm], edge_length: 50 mm}}, material: al, position: [275 mm, 0, 0]}
effects:
  inertia: {}
  gravity: {}
  affine_body: {}
  joint:
    - {name: shoulder, type: revolute, body: upper, at: [0, 0, 0], axis: [0, -1, 0]}
    - {name: elbow, type: revolute, body: lower, to: upper, at: [200 mm, 0, 0], axis: [0, -1, 0]}
  drive:
    - {joint: shoulder, mode: pd, kp: 40, kd: 0.6, angle: {time: [0, 200 ms, 400 ms], value: [0, 40 deg, 40 deg]}, interpolation: smooth}
    - {joint: elbow, mode: pd, kp: 10, kd: 0.1, angle: {time: [0, 200 ms, 400 ms], value: [0, -60 deg, -60 deg]}, interpolation: smooth}
)";

// A jaw on a hand that is moved along the jaw's slide.
const char* const kJaw = R"(
mortise: 1
name: jaw
time: {step: 5 ms, steps: 1}
materials: {al: {density: 2700}}
bodies:
  jaw: {type: stiff, shape: {box: {size: [6 mm, 20 mm, 40 mm], edge_length: 20 mm}}, material: al, position: [-25 mm, 0, 30 mm]}
  hand: {type: stiff, shape: {box: {size: [80 mm, 30 mm, 10 mm], edge_length: 40 mm}}, material: al, position: [0, 0, 60 mm]}
effects:
  inertia: {}
  affine_body: {}
  pin: [{body: hand, where: {side: all}, motion: {time: [0, 300 ms], translation: [[0, 0, 0], [300 mm, 0, 0]], interpolation: smooth}}]
  joint: [{name: slide, type: prismatic, body: jaw, to: hand, axis: [1, 0, 0]}]
  drive: [{joint: slide, mode: pd, kp: 50, kd: 0.3, travel: 0}]
)";

// A palm that a box is let go on.
const char* const kPalm = R"(
mortise: 1
name: palm
time: {step: 5 ms, steps: 1}
bodies:
  palm: {type: stiff, shape: {box: {size: [60 mm, 60 mm, 10 mm], edge_length: 60 mm}}, mass: 0.2, position: [0, 0, -5 mm]}
  box: {type: stiff, shape: {box: {size: [40 mm, 40 mm, 40 mm], edge_length: 20 mm}}, mass: 0.4, position: [0, 0, 20.001 mm]}
effects:
  inertia: {}
  gravity: {}
  affine_body: {}
  barrier_contact: {}
  joint: [{name: lift, type: prismatic, body: palm, axis: [0, 0, 1]}]
  drive: [{joint: lift, mode: pd, kp: 1000, kd: 2, travel: 1.962 mm}]
  pin: [{body: box, where: {side: all}, release: 20 ms}]
)";

struct Moved {
  audit::EnergyAudit::Result energy;
  std::map<std::string, double> largest;             // |number|
  std::map<long, std::map<std::string, double>> at;  // by time [us]
};

Moved move(const std::string& scene, double step, double seconds, const std::vector<std::string>& more = {}) {
  std::vector<std::string> overrides = {fmt::format("time.step={}", step)};
  overrides.insert(overrides.end(), more.begin(), more.end());
  Rig rig(scene, overrides);
  Moved out;
  long i = 0;
  out.energy = audited(rig, std::lround(seconds / step), [&](const solver::StepReport&, const Captured& said) {
    for (const auto& [name, value] : said.number) out.largest[name] = std::fmax(out.largest[name], std::abs(value));
    out.at[std::lround(1e6 * static_cast<double>(++i) * step)] = said.number;
  });
  return out;
}

// The largest difference of a number at times that both runs have.
double apart(const Moved& one, const Moved& other, const std::string& name) {
  double most = 0;
  for (const auto& [time, numbers] : one.at)
    if (const auto of = other.at.find(time); of != other.at.end()) most = std::fmax(most, std::abs(numbers.at(name) - of->second.at(name)));
  return most;
}

}  // namespace

TEST(MotorLag, IsByHowMuchTheLargestTorquesOfAnArmAreOff) {
  const Moved exact = move(kArm, 0.25e-3, 0.4);
  for (const double step : {10e-3, 5e-3, 2.5e-3}) {
    const Moved run = move(kArm, step, 0.4);
    double off = 0, way = 0;
    for (const std::string name : {"drive/shoulder_torque", "drive/elbow_torque"})
      off = std::fmax(off, std::abs(run.largest.at(name) / exact.largest.at(name) - 1));
    for (const std::string name : {"joint/shoulder_angle", "joint/elbow_angle"})
      way = std::fmax(way, apart(run, exact, name) / exact.largest.at(name));
    EXPECT_GT(off, 10 * step) << "else there is nothing to see";
    EXPECT_NEAR(run.energy.motor_torque_lag, off, 0.3 * off) << step;
    EXPECT_NEAR(run.energy.motor_lag, way, 0.5 * way) << step;
  }
}

// BDF2 is of second order in motors too, and its certificate says so.
TEST(MotorLag, IsOfSecondOrderWithBdf2) {
  const std::vector<std::string> bdf2 = {"effects.inertia.integrator=bdf2"};
  const Moved exact = move(kArm, 0.25e-3, 0.4, bdf2);
  double way[2], told[2];
  for (const int k : {0, 1}) {
    const Moved run = move(kArm, k == 0 ? 10e-3 : 5e-3, 0.4, bdf2);
    way[k] = 0;
    for (const std::string name : {"joint/shoulder_angle", "joint/elbow_angle"})
      way[k] = std::fmax(way[k], apart(run, exact, name) / exact.largest.at(name));
    told[k] = run.energy.motor_lag;
    EXPECT_NEAR(told[k], way[k], 0.5 * way[k]) << k;
    double off = 0;
    for (const std::string name : {"drive/shoulder_torque", "drive/elbow_torque"})
      off = std::fmax(off, std::abs(run.largest.at(name) / exact.largest.at(name) - 1));
    EXPECT_NEAR(run.energy.motor_torque_lag, off, 0.05) << k;
  }
  EXPECT_LT(way[1], 0.35 * way[0]);
  EXPECT_LT(told[1], 0.35 * told[0]);
}

TEST(MotorLag, SeesWhatAHandDoesToItsJaw) {
  const Moved exact = move(kJaw, 0.1e-3, 0.3);
  for (const double step : {5e-3, 2e-3}) {
    const Moved run = move(kJaw, step, 0.3);
    const double way = apart(run, exact, "joint/slide_travel") / exact.largest.at("joint/slide_travel");
    EXPECT_GT(way, 0.05);
    EXPECT_NEAR(run.energy.motor_lag, way, 0.4 * way) << step;
  }
}

TEST(MotorLag, IsNothingWhereNothingSwingsOrNoMotorHasGains) {
  EXPECT_LT(move(kJaw, 5e-3, 0.1, {"effects.pin.0.motion.translation=[[0, 0, 0], [0, 0, 0]]"}).energy.motor_lag, 1e-9);
  EXPECT_TRUE(std::isnan(move(kJaw, 5e-3, 0.05, {"effects.drive=[{joint: slide, mode: effort, force: 0.1}]"}).energy.motor_lag));
}

// What lies on it has its part of the mass; no more is known of it than that both go together. Of the spring alone there is no motor's torque.
TEST(MotorLag, SeesWhatTouchesSwing) {
  const double sinks = 0.4 * 9.81 / 1000, zeta = 2 / (2 * std::sqrt(1000 * 0.6)),
               should = sinks * (1 + std::exp(-M_PI * zeta / std::sqrt(1 - zeta * zeta)));
  for (const char* drive :
       {"{joint: lift, mode: pd, kp: 1000, kd: 2, travel: 1.962 mm}", "{joint: lift, mode: passive, stiffness: 1000, damping: 2, rest: 1.962 mm}"})
    for (const double step : {10e-3, 5e-3}) {
      const Moved run = move(kPalm, step, 0.2, {fmt::format("effects.drive=[{}]", drive)});
      const double missing = 1 - run.largest.at("joint/lift_travel") / should;
      EXPECT_GT(missing, 0.1);
      EXPECT_NEAR(run.energy.motor_lag, missing, 0.25 * missing) << drive << step;
      EXPECT_GT(run.energy.motor_torque_lag, 0.5 * missing);
    }
  EXPECT_LT(move(kPalm, 2e-3, 0.2, {"effects.inertia.integrator=bdf2"}).energy.motor_lag, 0.02);
}
