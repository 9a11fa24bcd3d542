// Steps of legs: the foot goes where its D says, whichever way the hinges are counted; what no leg can do is refused.
#include <fmt/format.h>

#include <cmath>

#include "rig.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

constexpr const char* kSteps = "period: 0.4 s, stride: 60 mm, clearance: 40 mm, depth: 5 mm, duty: 0.6, phase: 0.25, begin: 20 ms, ramp: 0.1 s";

// A thigh from the hip at (0, 0, 0.3) to the knee at (-0.2, 0, 0.3), and a shank that ends in the foot at (-0.2, 0, 0.1), with given angles.
std::string leg(const std::string& knee, const std::string& gait, const std::string& hip = "body: thigh, at: [0, 0, 0.3], axis: [0, 1, 0]",
                const std::string& mode = "mode: kinematic") {
  const std::string block = fmt::format("{}, gait: {{upper: hip, lower: knee, foot: [-0.2, 0, 0.1], {}}}", mode, gait);
  return fmt::format(R"(
mortise: 1
name: leg
time: {{step: 2 ms, steps: 1000}}
materials: {{steel: {{density: 1000}}}}
bodies:
  thigh: {{type: stiff, shape: {{box: {{size: [0.2, 0.02, 0.02], edge_length: 0.2}}}}, material: steel, position: [-0.1, 0, 0.3]}}
  shank: {{type: stiff, shape: {{box: {{size: [0.02, 0.02, 0.2], edge_length: 0.2}}}}, material: steel, position: [-0.2, 0, 0.2]}}
effects:
  inertia: {{}}
  affine_body: {{}}
  joint:
    - {{name: hip, type: revolute, {}, angle: 0.3}}
    - {{name: knee, type: revolute, {}, at: [-0.2, 0, 0.3]}}
  drive: [{{joint: hip, {}}}, {{joint: knee, {}}}]
)",
                     hip, knee, block, block);
}

Vec3 foot(const Rig& rig) {
  const std::vector<double> x = rig.engine->points();
  Vec3 sum = Vec3::Zero();
  const std::size_t first = rig.input.bodies[0].nodes.size();
  int n = 0;
  for (std::size_t i = 0; i < rig.input.bodies[1].nodes.size(); ++i)
    if (rig.input.bodies[1].nodes[i][2] < 0.1 + 1e-9) sum += Vec3(x[3 * (first + i)], x[3 * (first + i) + 1], x[3 * (first + i) + 2]), ++n;
  return sum / n;
}

// Where the foot is to be, from where it stands.
Vec3 step(double t) {
  const double T = 0.4, D = 0.6, walked = std::max(0.0, t - 0.02), v = std::min(1.0, walked / 0.1), r = v * v * (3 - 2 * v);
  double s = 0.25 + 0.3 + walked / T;
  s -= std::floor(s);
  if (s < D) return r * Vec3(0.06 * (0.5 - s / D), 0, -0.005 * std::sin(M_PI * s / D));
  const double u = (s - D) / (1 - D);
  return r * Vec3(0.06 * (u - std::sin(2 * M_PI * u) / (2 * M_PI) - 0.5), 0, 0.02 * (1 - std::cos(2 * M_PI * u)));
}

}  // namespace

TEST(Gaits, TheFootGoesAlongItsD) {
  for (const char* knee :
       {"body: shank, to: thigh, axis: [0, 1, 0]", "body: thigh, to: shank, axis: [0, 1, 0]", "body: shank, to: thigh, axis: [0, -1, 0]"})
    for (const char* hip : {"body: thigh, at: [0, 0, 0.3], axis: [0, 1, 0]", "body: thigh, at: [0, 0, 0.3], axis: [0, -1, 0]"}) {
      Rig rig(leg(knee, kSteps, hip));
      double off = 0, high = 0, far = 0;
      for (int n = 1; n <= 260; ++n) {
        rig.step();
        const Vec3 way = foot(rig) - Vec3(-0.2, 0, 0.1);
        off = std::max(off, (way - step(2e-3 * n)).norm()), high = std::max(high, way[2]), far = std::max(far, std::abs(way[0]));
      }
      EXPECT_LT(off, 1e-11) << knee << ", " << hip;
      EXPECT_NEAR(high, 0.04, 1e-5);
      EXPECT_NEAR(far, 0.03, 1e-4);
    }
}

TEST(Gaits, Refusals) {
  const auto says = [](const std::string& yaml, const std::string& text) {
    try {
      Rig rig(yaml);
      ADD_FAILURE() << "accepted, but should say: " << text;
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find(text), std::string::npos) << e.what();
      EXPECT_EQ(e.code(), Exit::scene);
    }
  };
  const auto changed = [](std::string yaml, const std::string& from, const std::string& to) {
    for (std::size_t at = 0; (at = yaml.find(from, at)) != std::string::npos; at += to.size()) yaml.replace(at, from.size(), to);
    return yaml;
  };
  const std::string knee = "body: shank, to: thigh, axis: [0, 1, 0]", good = leg(knee, kSteps);
  says(changed(good, "stride: 60 mm", "stride: 600 mm"), "the steps are too large for the leg");
  says(changed(good, "foot: [-0.2, 0, 0.1]", "foot: [-0.4, 0, 0.3]"), "is straight");
  says(changed(good, "lower: knee", "lower: hip"), "does not hang on what 'hip' turns");
  says(changed(good, "upper: hip", "upper: hips"), "no joint is called 'hips'");
  says(changed(good, "phase: 0.25", "forward: [0, 1, 0]"), "forward points along the axis of 'hip'");
  says(leg("body: shank, to: thigh, axis: [1, 0, 0]", kSteps), "are not parallel");
  says(changed(good, "mode: kinematic, gait", "mode: kinematic, angle: 0, gait"), "'angle' has no place beside it");
  says(changed(good, "mode: kinematic, gait", "mode: effort, gait"), "gait has no meaning: of this joint a drive of mode effort aims at 'torque'");
  std::string other = good;
  other.replace(other.find("upper: hip, lower: knee"), 23, "upper: knee, lower: knee");
  says(other, "one of them has to be the joint that is driven");
}
