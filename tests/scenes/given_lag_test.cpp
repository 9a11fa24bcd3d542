// Torques of kinematic drives (audit/given_lag.h): an arm about its centre of mass, whose weight no hinge of it feels.
#include <fmt/format.h>

#include "audited.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

struct Turned {
  double told = 0, torque = 0;  // the largest [N m]
};

Turned turn(double step, const std::string& angle, const char* interpolation) {
  Rig rig(fmt::format(R"(
mortise: 1
name: arm
time: {{step: {}, steps: 1}}
bodies:
  arm: {{type: stiff, shape: {{box: {{size: [200 mm, 20 mm, 20 mm], edge_length: 200 mm}}}}, mass: 1}}
effects:
  inertia: {{}}
  gravity: {{}}
  affine_body: {{}}
  joint: [{{name: yaw, type: revolute, body: arm, at: [0, 0, 0], axis: [0, 0, 1]}}]
  drive: [{{joint: yaw, mode: kinematic, angle: {}, interpolation: {}}}]
)",
                      step, angle, interpolation),
          {});
  Turned out;
  out.told = audited(rig, std::lround(0.3 / step), [&](const solver::StepReport&, const Captured& said) {
               out.torque = std::fmax(out.torque, std::abs(said.at("drive/yaw_torque")));
             }).given_lag;
  return out;
}

}  // namespace

TEST(GivenLag, IsOfTorquesToo) {
  const std::string turns = "{time: [0, 0.1, 0.2, 0.3], value: [0, 0, 0.2, 0.2]}";
  const double exact = 6 * 0.2 / 0.01 * (0.04 + 0.0004) / 12;  // of a cubic: 6 phi / T^2 in its ends
  const Turned coarse = turn(5e-3, turns, "smooth"), fine = turn(0.5e-3, turns, "smooth");
  EXPECT_LT(coarse.torque, 0.95 * exact);
  EXPECT_GT(coarse.told, 0.1);
  EXPECT_NEAR(fine.torque, exact, 0.02 * exact);
  EXPECT_LT(fine.told, 0.05);
}

// The torque of a track that goes straight from key to key is that of its corners, and the larger the shorter the step.
TEST(GivenLag, SeesTheCornersOfATrack) {
  std::string times, angles;
  for (int k = 0; k <= 15; ++k)
    times += fmt::format("{}{}", k ? ", " : "", 0.02 * k), angles += fmt::format("{}{}", k ? ", " : "", 0.1 * (1 - std::cos(20 * 0.02 * k)));
  const std::string track = "{time: [" + times + "], value: [" + angles + "]}";
  const Turned coarse = turn(5e-3, track, "linear"), fine = turn(2.5e-3, track, "linear");
  EXPECT_NEAR(fine.torque, 2 * coarse.torque, 0.1 * coarse.torque);
  EXPECT_GT(coarse.told, 1);
  EXPECT_GT(fine.told, 1);
}
