// Friction of what slips round a bend (audit/friction_turned.h): a plate that is pressed on a pad and goes round a quarter of a circle, against a run
// of many load steps.
#include "audit/friction_turned.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "rig.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

struct Bend {
  double told = 0;
  Vec3 force = Vec3::Zero();  // on the plate, in the end [N]
};

// angle: of the way [rad].
Bend slide(int steps, double angle) {
  std::string times = "0, 0.2", ways = "[0, 0, 0], [0, 0, -0.15 mm]";
  for (int k = 1; k <= 16; ++k) {
    const double a = angle * k / 16, r = angle > 0 ? 3e-3 / angle * M_PI / 2 : 0;
    times += fmt::format(", {}", 0.2 + 0.05 * k);
    ways += fmt::format(", [{}, {}, -0.15e-3]", angle > 0 ? r * std::sin(a) : 3e-4 * k, angle > 0 ? r * (1 - std::cos(a)) : 0);
  }
  Rig rig(fmt::format(R"(
mortise: 1
name: bend
time: {{mode: static, steps: {}}}
materials: {{pad: {{youngs_modulus: 1 MPa, poisson_ratio: 0, density: 1000}}}}
bodies:
  pad: {{type: soft, shape: {{box: {{size: [16 mm, 16 mm, 4 mm], edge_length: 4 mm}}}}, material: pad, position: [0, 0, 2 mm]}}
  plate: {{type: stiff, shape: {{box: {{size: [32 mm, 32 mm, 4 mm], edge_length: 32 mm}}}}, position: [0, 0, 6.01 mm], mass: 0.01}}
effects:
  elasticity: {{}}
  pin:
    - {{body: pad, where: {{side: z_min}}}}
    - {{body: plate, where: {{side: all}}, motion: {{time: [{}], translation: [{}]}}}}
  mortar_contact: {{pairs: [{{slave: pad, master: plate}}]}}
  friction: {{follows: mortar_contact, mu: 0.05}}
)",
                      steps, times, ways));
  const auto laws = audit::friction_laws(rig.input);
  audit::FrictionTurned turned;
  Bend out;
  for (int i = 0; i < steps; ++i) {
    rig.step();
    const Captured said = rig.fields();
    turned.state(audit::rubbing(laws, said));
    out.force = {said.at("supports/plate_x"), said.at("supports/plate_y"), 0};
  }
  out.told = turned.share();
  return out;
}

}  // namespace

TEST(FrictionTurned, IsWhatPointsAside) {
  const Vec3 exact = slide(50, M_PI / 2).force;
  for (const int steps : {5, 10}) {
    const Bend run = slide(steps, M_PI / 2);
    const double aside = (run.force - exact).norm() / exact.norm();
    EXPECT_GT(aside, 0.05);
    EXPECT_GT(run.told, 0.7 * aside) << steps;
    EXPECT_LT(run.told, 2 * aside) << steps;
  }
  EXPECT_LT(slide(5, 0).told, 1e-3) << "straight on";
}
