// Where equilibrium is unstable: columns beyond their load.
#include <cmath>
#include <numbers>

#include "rig.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

// A column between two clamps, which come closer by 2.5 mm. L = 200 mm, section 10 mm x 14 mm, E = 1 MPa.
constexpr const char* kColumn = R"(
mortise: 1
name: column
time: {mode: static, steps: 5}
materials:
  rubber: {youngs_modulus: 1 MPa, poisson_ratio: 0.3, density: 1000}
bodies:
  column: {type: soft, order: 2, shape: {box: {size: [200 mm, 10 mm, 14 mm], edge_length: 10 mm}}, material: rubber}
effects:
  elasticity: {}
  pin:
    - {body: column, where: {side: x_min}}
    - {body: column, where: {side: x_max}, motion: {time: [0, 1], translation: [[0, 0, 0], [-2.5 mm, 0, 0]]}}
)";
constexpr double kLength = 0.2, kArea = 1.4e-4, kInertia = 0.014 * 1e-6 / 12, kYoung = 1e6;

}  // namespace

// Euler: P = 4 pi^2 E I / L^2 is borne straight, at 1.64 mm; after that the column goes sideways by A (1 - cos 2 pi x / L) / 2, which takes up
// pi^2 A^2 / 4 L of the way.
TEST(Saddle, AColumnBucklesAtItsLoad) {
  Rig rig(kColumn);
  const double load = 4 * std::pow(std::numbers::pi / kLength, 2) * kYoung * kInertia, straight = load * kLength / (kYoung * kArea);
  ASSERT_NEAR(straight, 1.645e-3, 1e-6);
  for (int step = 1; step <= 5; ++step) {
    SCOPED_TRACE(step);
    const double travel = 0.5e-3 * step;
    rig.step();
    const std::vector<double> points = rig.engine->points();
    const Captured f = rig.fields();
    double force = 0, aside = 0;
    for (std::size_t i = 0; i < rig.input.bodies[0].nodes.size(); ++i) {
      const Vec3& X = rig.input.bodies[0].nodes[i];
      if (X[0] < -0.0999) force += f.point.at("support_force")[3 * i];
      aside = std::max(aside, std::abs(points[3 * i + 1] - X[1]));
    }
    if (travel < straight) {
      EXPECT_LT(aside, 1e-4);
      EXPECT_NEAR(force, kYoung * kArea * travel / kLength, 0.03 * force);
    } else {
      EXPECT_NEAR(force, load, 0.06 * load) << "it bears hardly more";
      EXPECT_NEAR(aside, std::sqrt(4 * kLength * (travel - force * kLength / (kYoung * kArea))) / std::numbers::pi, 0.1 * aside);
    }
  }
}
