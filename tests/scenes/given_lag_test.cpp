// Torques of kinematic drives (audit/given_lag.h): an arm about its centre of mass, whose weight no hinge of it feels.
#include <fmt/format.h>

#include "audited.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

struct Driven {
  double told = 0, kinks = 0, torque = 0;  // the largest [N m]
};

Driven drive(double step, const std::string& angle, const char* interpolation, const char* integrator = "backward_euler") {
  Rig rig(fmt::format(R"(
mortise: 1
name: arm
time: {{step: {}, steps: 1}}
bodies:
  arm: {{type: stiff, shape: {{box: {{size: [200 mm, 20 mm, 20 mm], edge_length: 200 mm}}}}, mass: 1}}
effects:
  inertia: {{integrator: {}}}
  gravity: {{}}
  affine_body: {{}}
  joint: [{{name: yaw, type: revolute, body: arm, at: [0, 0, 0], axis: [0, 0, 1]}}]
  drive: [{{joint: yaw, mode: kinematic, angle: {}, interpolation: {}}}]
)",
                      step, integrator, angle, interpolation),
          {});
  Driven out;
  const auto found = audited(rig, std::lround(0.3 / step), [&](const solver::StepReport&, const Captured& said) {
    out.torque = std::fmax(out.torque, std::abs(said.at("drive/yaw_torque")));
  });
  out.told = found.given_lag, out.kinks = found.given_kinks;
  return out;
}

}  // namespace

TEST(GivenLag, IsOfTorquesToo) {
  const std::string turns = "{time: [0, 0.1, 0.2, 0.3], value: [0, 0, 0.2, 0.2]}";
  const double exact = 6 * 0.2 / 0.01 * (0.04 + 0.0004) / 12;  // of a cubic: 6 phi / T^2 in its ends
  const Driven coarse = drive(5e-3, turns, "smooth"), fine = drive(0.5e-3, turns, "smooth");
  EXPECT_LT(coarse.torque, 0.95 * exact);
  EXPECT_GT(coarse.told, 0.1);
  EXPECT_NEAR(fine.torque, exact, 0.02 * exact);
  EXPECT_LT(fine.told, 0.05);
}

// BDF2 overshoots where it begins at once, whatever the step.
TEST(GivenKinks, AreOfTorquesToo) {
  const double exact = 6 * 0.2 / 0.01 * (0.04 + 0.0004) / 12;
  const Driven run = drive(2e-3, "{time: [0, 0.1, 0.2, 0.3], value: [0, 0, 0.2, 0.2]}", "smooth", "bdf2");
  EXPECT_GT(run.torque, 1.2 * exact);
  EXPECT_NEAR(run.kinks, run.torque / exact - 1, 0.3 * run.kinks);
}

// The torque of a track that goes straight from key to key is that of its corners, and the larger the shorter the step.
TEST(GivenLag, SeesTheCornersOfATrack) {
  std::string times, angles;
  for (int k = 0; k <= 15; ++k)
    times += fmt::format("{}{}", k ? ", " : "", 0.02 * k), angles += fmt::format("{}{}", k ? ", " : "", 0.1 * (1 - std::cos(20 * 0.02 * k)));
  const std::string track = "{time: [" + times + "], value: [" + angles + "]}";
  const Driven coarse = drive(5e-3, track, "linear"), fine = drive(2.5e-3, track, "linear");
  EXPECT_NEAR(fine.torque, 2 * coarse.torque, 0.1 * coarse.torque);
  EXPECT_GT(coarse.told, 1);
  EXPECT_GT(fine.told, 1);
}

// At an even speed torques are rounding.
TEST(GivenLag, IsNothingAtAnEvenSpeed) {
  EXPECT_LT(drive(5e-3, "{time: [0, 1], value: [0, 2]}", "linear").told, 0.01);
  EXPECT_LT(drive(5e-3, "{time: [0, 1], value: [0, 2]}", "linear", "bdf2").kinks, 0.01);
}
