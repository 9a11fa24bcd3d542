// Quadratic tetrahedra through the whole chain.
#include <cstdio>

#include "rig.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

// Largest sag of a cantilever of 10 x 1 x 1 under a force on its free end.
double sag(int order, const std::string& law, double nu, double end_traction) {
  Rig rig(
      "mortise: 1\nname: cantilever\ntime: {mode: static, steps: 1}\nmaterials:\n  rubber: {model: " + law +
      ", youngs_modulus: 1 MPa, poisson_ratio: " + std::to_string(nu) +
      ", density: 1000}\nbodies:\n  beam: {type: soft, order: " + std::to_string(order) +
      ", shape: {box: {size: [10, 1, 1], edge_length: 0.5}}, material: rubber}\n"
      "effects:\n  elasticity: {}\n  pin: [{body: beam, where: {side: x_min}, axes: xyz}]\n"
      "  pressure_load: [{body: beam, where: {side: x_max}, traction: [0, 0, " + std::to_string(-end_traction) + "]}]\n"
      "solver: {relative_tolerance: 1e-10}\n");
  rig.step();
  const std::vector<double> points = rig.engine->points();
  double lowest = 0;
  for (std::size_t i = 2; i < points.size(); i += 3) lowest = std::min(lowest, points[i]);
  return -0.5 - lowest;
}

}  // namespace

// Timoshenko: F L^3/(3 E I) + F L/(k A G), k = 10 (1 + nu)/(12 + 11 nu). For nu > 0 the clamped end, which cannot contract sideways, takes away a
// percent. Two linear elements over the height lock.
TEST(Quadratic, CantileverFollowsBeamTheoryWhereLinearElementsLock) {
  const double F = 1, E = 1e6, L = 10, I = 1.0 / 12;
  for (double nu : {0.0, 0.3}) {
    const double G = E / (2 * (1 + nu)), k = 10 * (1 + nu) / (12 + 11 * nu), beam = F * L * L * L / (3 * E * I) + F * L / (k * G);
    const double two = sag(2, "linear", nu, F) / beam, one = sag(1, "linear", nu, F) / beam;
    std::printf("  nu %.2f: order 2 %.4f, order 1 %.4f of beam theory\n", nu, two, one);
    EXPECT_NEAR(two, 1, nu > 0 ? 0.015 : 1e-3) << nu;
    EXPECT_LT(one, 0.6) << nu;
  }
  EXPECT_NEAR(sag(2, "neo_hookean", 0.3, F) / sag(2, "linear", 0.3, F), 1, 1e-3);
}
