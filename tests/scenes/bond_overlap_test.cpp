// Soft bodies that reach into what they are bonded to (audit/bond_overlap.h).
#include <fmt/format.h>

#include "audited.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

struct Bent {
  double way = 0, told = 0;
};

// A stub of 6 x 6 mm that stands 12 mm out of its mount and is pulled to the side or upwards at its end; `deep` reaches into the mount [mm].
Bent stub(double deep, double edge, const std::string& traction, int axis) {
  Rig rig(fmt::format(R"(
mortise: 1
name: stub
time: {{mode: static, steps: 1}}
materials: {{rubber: {{youngs_modulus: 1 MPa, poisson_ratio: 0.4, density: 1000}}, steel: {{density: 7800}}}}
bodies:
  stub: {{type: soft, order: 2, shape: {{box: {{size: [6 mm, 6 mm, {} mm], edge_length: {} mm}}}}, material: rubber, position: [0, 0, {} mm]}}
  mount: {{type: stiff, shape: {{box: {{size: [20 mm, 20 mm, 10 mm], edge_length: 10 mm}}}}, material: steel, position: [0, 0, -5 mm]}}
effects:
  elasticity: {{}}
  affine_body: {{}}
  pin: [{{body: mount, where: {{side: all}}}}]
  bond: [{{body: stub, to: mount, within: 0}}]
  pressure_load: [{{body: stub, where: {{side: z_max}}, traction: {}}}]
)",
                      12 + deep, edge, 0.5 * (12 - deep), traction));
  Bent out;
  out.told = audited(rig, 1, [](const solver::StepReport&, const Captured&) {}).bond_overlap;
  const std::vector<double> points = rig.engine->points();
  const std::vector<Vec3>& rest = rig.input.bodies[0].nodes;
  for (std::size_t n = 0; n < rest.size(); ++n) out.way = std::max(out.way, points[3 * n + axis] - rest[n][axis]);
  return out;
}

}  // namespace

TEST(BondOverlap, IsHowMuchTooSoftABodyIs) {
  for (const auto& [traction, axis] : {std::pair{"[400, 0, 0]", 0}, std::pair{"[0, 0, 1 kPa]", 2}}) {
    SCOPED_TRACE(traction);
    const Bent truth = stub(0, 2, traction, axis);
    EXPECT_TRUE(std::isnan(truth.told));
    for (const auto& [deep, edge] : {std::pair{1.4, 3.0}, {1.9, 2.0}, {2.99, 1.5}}) {
      SCOPED_TRACE(deep);
      const Bent soft = stub(deep, edge, traction, axis);
      const double error = soft.way / truth.way - 1;
      EXPECT_GT(error, 0.03);
      EXPECT_NEAR(soft.told, error, 0.5 * error);
    }
    EXPECT_TRUE(std::isnan(stub(3, 1.5, traction, axis).told)) << "the mount ends where a row of nodes does";
  }
}
