// Uniform stress hides how badly a mesh bends, and near the load at which it buckles that weighs several times (audit/stress_error.h, `bending`).
#include <fmt/format.h>

#include "audit/field_errors.h"
#include "rig.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

// stiffness_error of the next step.
double told_of_a_step(Rig& rig) {
  audit::FieldErrors errors(rig.input);
  rig.step();
  errors.state(rig.fields(), 1);
  return errors.result().stiffness;
}

struct Bent {
  double way = 0, told = 0;
};

// A column of 10 mm by 10 mm by 200 mm under a share of the load at which it buckles, 0.0514 N, which a small load bends.
Bent bend(double share, const std::string& mesh, double across = 0.5) {
  Rig rig(fmt::format(R"(
mortise: 1
name: column
time: {{mode: static, steps: 1}}
materials: {{rubber: {{youngs_modulus: 1 MPa, poisson_ratio: 0.3, density: 1000}}}}
bodies:
  column: {{type: soft, {}, material: rubber}}
effects:
  elasticity: {{}}
  pin: [{{body: column, where: {{side: z_min}}}}]
  pressure_load: [{{body: column, where: {{side: z_max}}, traction: [{}, 0, {}]}}]
)",
                      mesh, across, -514 * share));
  Bent out;
  out.told = told_of_a_step(rig);
  const std::vector<double> points = rig.engine->points();
  for (std::size_t n = 0; n < rig.input.bodies[0].nodes.size(); ++n) out.way = std::max(out.way, points[3 * n] - rig.input.bodies[0].nodes[n][0]);
  return out;
}

std::string box(double edge, int order) {
  return fmt::format("order: {}, shape: {{box: {{size: [10 mm, 10 mm, 200 mm], edge_length: {} mm}}}}", order, edge);
}

}  // namespace

TEST(Column, BendsAsMuchTooLittleAsIsTold) {
  for (const double share : {0.0, 0.4, 0.8}) {
    const Bent truth = bend(share, box(5, 2));
    EXPECT_LT(truth.told, 0.05) << share;
    for (const double edge : {5.0, 2.5}) {
      const Bent coarse = bend(share, box(edge, 1));
      const double error = 1 - coarse.way / truth.way;
      EXPECT_GT(error, 0.05);
      EXPECT_GT(coarse.told, 0.6 * error) << share << ' ' << edge;
      EXPECT_LT(coarse.told, 3 * error) << share << ' ' << edge;
    }
  }
}

// What is pulled as far as it bends: how badly it bends is a part of how far its points go.
TEST(Column, APullHidesNotHowBadlyItBends) {
  const double share = -10000.0 / 514;
  const Bent truth = bend(share, box(5, 2), 200), coarse = bend(share, box(10, 1), 200);
  EXPECT_LT(truth.told, 0.08);
  EXPECT_LT(coarse.way, 0.85 * truth.way);
  EXPECT_GT(coarse.told, 0.12);
}

// A pad between what presses it and a floor bulges, which is no bending: its travel is right to 1 %, and 0.57 was told.
TEST(Column, WhatBulgesDoesNotBend) {
  Rig rig(R"(
mortise: 1
name: pad
time: {mode: static, steps: 1}
materials: {gel: {youngs_modulus: 0.5 MPa, poisson_ratio: 0.3, density: 1050}, alu: {density: 2700}}
bodies:
  jaw: {type: stiff, shape: {box: {size: [30 mm, 30 mm, 10 mm], edge_length: 10 mm}}, material: alu, position: [0, 0, 17 mm]}
  pad: {type: soft, shape: {box: {size: [20 mm, 20 mm, 12 mm], edge_length: 2 mm}}, material: gel, position: [0, 0, 6 mm]}
  floor: {type: half_space, point: [0, 0, -0.05 mm]}
effects:
  elasticity: {}
  affine_body: {}
  bond: [{body: pad, to: jaw, within: 1 um}]
  joint: [{name: s, type: prismatic, body: jaw, axis: [0, 0, -1]}]
  drive: [{joint: s, mode: effort, force: {time: [0, 1], value: [0, 20]}}]
  mortar_contact: {pairs: [{slave: pad, master: floor}]}
)");
  const double told = told_of_a_step(rig);
  EXPECT_NEAR(rig.fields().at("joint/s_travel"), 1.1265e-3, 0.02 * 1.1265e-3);  // of quadratic elements
  EXPECT_LT(told, 0.03);
}

// What is pulled hard and bends no more than it is pulled is a matter of the pull.
TEST(Column, OfAPullIsAsOfAll) {
  Rig rig(R"(
mortise: 1
name: bar
time: {mode: static, steps: 1}
materials: {rubber: {youngs_modulus: 1 MPa, poisson_ratio: 0.3, density: 1000}}
bodies:
  bar: {type: soft, shape: {box: {size: [10 mm, 10 mm, 100 mm], edge_length: 5 mm}}, material: rubber}
effects:
  elasticity: {}
  pin:
    - {body: bar, where: {side: z_min}}
    - {body: bar, where: {side: z_max}, motion: {time: [0, 1], translation: [[0, 0, 0], [0, 0, 10 mm]]}}
)");
  EXPECT_LT(told_of_a_step(rig), 0.05);
}

// A pad that is pressed and sheared shears as a whole: no column that leans on its foot (0.17 was told).
TEST(Column, WhatIsShearedDoesNotBend) {
  const auto shear = [](const char* mesh) {
    Rig rig(fmt::format(R"(
mortise: 1
name: pad
time: {{mode: static, steps: 1}}
materials: {{rubber: {{youngs_modulus: 0.5 MPa, poisson_ratio: 0, density: 1100}}}}
bodies:
  pad: {{type: soft, shape: {{box: {{size: [18 mm, 18 mm, 6 mm], edge_length: 2 mm}}}}, material: rubber, {}}}
effects:
  elasticity: {{}}
  pin: [{{body: pad, where: {{side: z_min}}}}]
  pressure_load: [{{body: pad, where: {{side: z_max}}, traction: [3000, 0, -31000]}}]
)",
                        mesh));
    const double told = told_of_a_step(rig);
    double way = 0;
    const std::vector<double> points = rig.engine->points();
    const std::vector<Vec3>& rest = rig.input.bodies[0].nodes;
    int top = 0;
    for (std::size_t n = 0; n < rest.size(); ++n)
      if (rest[n][2] > 2.9e-3) way += points[3 * n] - rest[n][0], ++top;
    return Bent{way / top, told};
  };
  const Bent truth = shear("order: 2"), coarse = shear("order: 1");
  const double error = 1 - coarse.way / truth.way;
  EXPECT_NEAR(error, 0.08, 0.02);
  EXPECT_NEAR(coarse.told, error, 0.5 * error);
}
