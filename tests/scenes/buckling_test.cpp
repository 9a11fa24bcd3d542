// Slender bodies that are pressed together along their line (audit/buckling.h).
#include <fmt/format.h>

#include "audited.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

// A strut of 10 x 10 x 150 mm and 1 MPa, clamped at its foot and under a cap that comes down by 3.4 mm: 2.27 % where it gives way at 1.46 %.
std::string strut(const std::string& body) {
  return fmt::format(R"(
mortise: 1
name: strut
time: {{mode: static, steps: 8}}
materials: {{rubber: {{youngs_modulus: 1 MPa, poisson_ratio: 0.3, density: 1000}}}}
bodies:
  col: {{type: soft, shape: {{box: {{size: [10 mm, 10 mm, 150 mm], edge_length: 5 mm}}}}, material: rubber, position: [0, 0, 75 mm]{}}}
  cap: {{type: stiff, shape: {{box: {{size: [20 mm, 20 mm, 4 mm], edge_length: 20 mm}}}}, mass: 1, position: [0, 0, 152 mm]}}
effects:
  elasticity: {{}}
  bond:
    - {{body: col, to: cap, where: {{side: z_max}}, within: 0.1 mm}}
  pin:
    - {{body: col, where: {{side: z_min}}}}
    - {{body: cap, where: {{side: all}}, motion: {{time: [0, 1], translation: [[0, 0, 0], [0, 0, -3.4 mm]]}}}}
)",
                     body);
}

std::pair<double, double> pressed(const std::string& scene, int steps) {
  Rig rig(scene);
  const audit::EnergyAudit::Result energy = audited(rig, steps, [](const solver::StepReport&, const Captured&) {});
  return {std::abs(rig.fields().at("supports/cap_z")), energy.buckling};
}

}  // namespace

TEST(Buckling, IsHowMuchMoreAStraightBarBears) {
  const double euler = 4 * M_PI * M_PI * 1e6 * 1e-8 / 12 / (0.15 * 0.15);
  const auto [straight, beyond] = pressed(strut(""), 8);  // its elements are too stiff to bend
  EXPECT_GT(straight, 1.5 * euler);
  EXPECT_NEAR(beyond, straight / euler - 1, 0.05);
  const auto [bent, little] = pressed(strut(", order: 2"), 8);
  EXPECT_NEAR(bent, euler, 0.03 * euler);
  EXPECT_LT(little, 0.05);
  EXPECT_EQ(pressed(strut(""), 3).second, 0) << "not yet as far";
  // In motion at once or slowly: the first has had no time to give way.
  const auto moving = [](double step) {
    std::string scene = strut("");
    scene.replace(scene.find("mode: static, steps: 8"), 22, fmt::format("step: {}, steps: 8", step));
    const std::string rest = "pin:";
    scene.replace(scene.find(rest), rest.size(), "inertia: {}\n  affine_body: {}\n  pin:");
    const std::string keys = "time: [0, 1], translation";
    scene.replace(scene.find(keys), keys.size(), fmt::format("time: [0, {}], translation", 4 * step));
    return pressed(scene, 8).second;
  };
  EXPECT_EQ(moving(1e-4), 0);
  EXPECT_GT(moving(0.5), 0.4);
}

// One side goes straight: it cannot give way.
TEST(Buckling, IsNoneOfWhatIsHeldAllAlong) {
  const auto beyond = [](const std::string& where) {
    const std::string scene = fmt::format(R"(
mortise: 1
name: strip
time: {{mode: static, steps: 4}}
materials: {{rubber: {{youngs_modulus: 1 MPa, poisson_ratio: 0.3, density: 1000}}}}
bodies:
  col: {{type: soft, shape: {{box: {{size: [10 mm, 10 mm, 150 mm], edge_length: 5 mm}}}}, material: rubber, position: [0, 0, 75 mm]}}
effects:
  elasticity: {{}}
  pin:
    - {{body: col, where: {{side: z_min}}}}
    - {{body: col, where: {}, axes: xy}}
    - {{body: col, where: {{side: z_max}}, motion: {{time: [0, 1], translation: [[0, 0, 0], [0, 0, -3.4 mm]]}}}}
)",
                                          where);
    Rig rig(scene);
    return audited(rig, 4, [](const solver::StepReport&, const Captured&) {}).buckling;
  };
  EXPECT_EQ(beyond("{box: {min: [4 mm, -6 mm, 1 mm], max: [6 mm, 6 mm, 149 mm]}}"), 0);
  EXPECT_GT(beyond("{box: {min: [4 mm, -6 mm, 4 mm], max: [6 mm, 6 mm, 6 mm]}}"), 0.4) << "held only next to its foot";
}
