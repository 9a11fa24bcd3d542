// Sensors in whole scenes: what taxels read of contact and friction that the solver found.
#include "sensors/sensors.h"

#include "rig.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

// A reading in the report of the present state.
Captured sense(Rig& rig, sensors::Sensors& sensors) {
  Captured out;
  rig.engine->report(out);
  sensors.read(out, rig.engine->points());
  return out;
}

double total(const std::vector<double>& v, int components, int component) {
  double sum = 0;
  for (std::size_t i = component; i < v.size(); i += components) sum += v[i];
  return sum;
}

std::string patch(const std::string& effect, int order) {
  return R"(
mortise: 1
name: patch
time: {mode: static, steps: 1}
materials:
  rubber: {model: linear, youngs_modulus: 1 MPa, poisson_ratio: 0.3, density: 1000}
bodies:
  pad: {type: soft, order: )" +
         std::to_string(order) + R"(, shape: {box: {size: [1, 1, 0.5], edge_length: 0.34}}, material: rubber, position: [0.5, 0.5, 0.25]}
  top: {type: soft, shape: {box: {size: [1, 1, 0.5], edge_length: 0.5}}, material: rubber, position: [0.5, 0.5, 0.755]}
effects:
  elasticity: {}
  pin:
    - {body: pad, where: {side: z_min}, axes: z}
    - {body: pad, where: {side: x_min}, axes: x}
    - {body: pad, where: {side: y_min}, axes: y}
    - {body: top, where: {side: x_min}, axes: x}
    - {body: top, where: {side: y_min}, axes: y}
  pressure_load: [{body: top, where: {side: z_max}, pressure: 1 kPa}]
)" + effect +
         R"(
solver: {relative_tolerance: 1e-13, force_tolerance: 0}
sensors:
  map: {body: pad, position: [0.5, 0.5, 0.5], rows: 5, columns: 7, width: 1, height: 1}
  inner: {body: pad, position: [0.4, 0.6, 0.5], up: [0.3, 1, 0], rows: 16, columns: 16, width: 0.5, height: 0.4}
)";
}

}  // namespace

TEST(Sensors, UniformPressureOnAPatchGivesEqualTaxels) {
  for (int order : {1, 2}) {
    Rig rig(patch("  mortar_contact: {pairs: [{slave: pad, master: top}], d_hat: 1 cm, stiffness: 1 MPa}", order));
    sensors::Sensors sensors(rig.input);
    rig.step();
    const Captured f = sense(rig, sensors);
    const double pad = f.at("mortar_contact/force_pad_z");
    EXPECT_NEAR(pad, -1000, 1e-8);
    EXPECT_NEAR(total(f.row.at("sensor_map/force"), 3, 2), pad, 1e-10);
    for (const char* name : {"map", "inner"}) {
      const std::vector<double>& p = f.row.at(std::string("sensor_") + name + "/pressure");
      for (double v : p) EXPECT_NEAR(v / p[0], 1, 1e-10) << name << " order " << order;
      // Against the area that the pad has after it has spread sideways.
      EXPECT_NEAR(p[0], 1000 * std::pow(1 + 0.3e-3, -2), 1e-5) << name;
      for (double v : f.row.at(std::string("sensor_") + name + "/shear")) EXPECT_NEAR(v, 0, 1e-7);
    }
    EXPECT_NEAR(f.at("sensor_map/wrench_force_z"), pad, 1e-10);
    // Sum of pressures times areas = force of the pair = what the support of the pad bears.
    EXPECT_LT(f.at("mortar_contact/pressure_sum_defect"), 1e-13);
    EXPECT_EQ(f.row.at("mortar_contact/pair_bodies"), (std::vector<double>{0, 1}));
    EXPECT_NEAR(f.row.at("mortar_contact/pair_force")[2], pad, 1e-10);
    EXPECT_NEAR(f.at("supports/pad_z"), -pad, 1e-10 * 1000);
    EXPECT_LT(f.at("supports/pad_defect"), 1e-10 * 1000);
    EXPECT_NEAR(f.at("balance/largest"), 1000, 1e-6);
    // The force acts in the middle of the patch, which the frame's origin marks: it moves with the pad.
    EXPECT_NEAR(f.at("sensor_map/wrench_moment_x"), 0, 1e-6);
  }
}

// With friction: the taxels carry all of the normal and of the tangential force of a ball that is dragged over the pad.
TEST(Sensors, ConserveContactAndFriction) {
  for (const std::string& contact :
       {std::string("  barrier_contact: {d_hat: 0.2 mm, stiffness: 50 kPa}\n  friction: {follows: barrier_contact, mu: 0.4}"),
        std::string("  mortar_contact: {pairs: [{slave: pad, master: ball}], d_hat: 0.2 mm, stiffness: 50 kPa}\n  friction: {follows: "
                    "mortar_contact, mu: 0.4}")}) {
    Rig rig(R"(
mortise: 1
name: drag
time: {step: 10 ms, steps: 6}
materials:
  gel: {model: neo_hookean, youngs_modulus: 50 kPa, poisson_ratio: 0.4, density: 1000}
bodies:
  pad: {type: soft, shape: {box: {size: [20 mm, 20 mm, 6 mm], edge_length: 2.5 mm}}, material: gel, position: [0, 0, -3 mm]}
  ball: {type: stiff, shape: {sphere: {radius: 6 mm, edge_length: 2 mm}}, material: gel, position: [0, 0, 6.15 mm]}
effects:
  inertia: {}
  elasticity: {}
  pin:
    - {body: pad, where: {side: z_min}}
    - {body: ball, where: {side: all}, motion: {time: [0, 30 ms, 60 ms], translation: [[0, 0, 0], [0, 0, -0.8 mm], [0.6 mm, 0.3 mm, -0.8 mm]]}}
)" + contact +
            R"(
sensors:
  map: {body: pad, rows: 16, columns: 16, width: 20 mm, height: 20 mm}
)");
    sensors::Sensors sensors(rig.input);
    rig.steps(6);
    const Captured f = sense(rig, sensors);
    const std::string effect = contact.substr(2, contact.find(':') - 2);
    double all[3];
    for (int c = 0; c < 3; ++c) {
      const std::string axis = std::string("_pad_") + "xyz"[c];
      all[c] = f.at(effect + "/force" + axis) + f.at("friction/force" + axis);
      EXPECT_NEAR(f.at(std::string("sensor_map/wrench_force_") + "xyz"[c]), all[c], 1e-13) << effect;
      EXPECT_NEAR(total(f.row.at("sensor_map/force"), 3, c), all[c], 1e-13) << effect;
    }
    EXPECT_LT(f.at(effect + "/pressure_sum_defect"), 1e-12) << effect;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(f.row.at(effect + "/pair_force")[c], f.at(effect + "/force_pad_" + "xyz"[c]), 1e-13) << effect;
    EXPECT_LT(all[2], -1e-3) << effect << ": the ball does not press";
    EXPECT_GT(std::abs(all[0]), 0.05 * std::abs(all[2])) << effect << ": nothing is dragged";
    // Material under the ball is pressed down and dragged along; the frame stays with the pinned bottom.
    const std::vector<double>& u = f.row.at("sensor_map/displacement");
    double lowest = 0, along = 0;
    for (int i = 0; i < 256; ++i) lowest = std::min(lowest, u[3 * i + 2]), along = std::max(along, u[3 * i]);
    EXPECT_LT(lowest, -0.3e-3) << effect;
    EXPECT_GT(along, 0.05e-3) << effect;
    EXPECT_NEAR(f.at("sensor_map/origin_z"), 0, 1e-15);
  }
}

TEST(Sensors, WithoutSensorsNothingIsAdded) {
  std::string scene = patch("  barrier_contact: {d_hat: 1 cm, stiffness: 1 MPa}", 1);
  scene.resize(scene.find("sensors:"));
  Rig rig(scene);
  sensors::Sensors sensors(rig.input);
  EXPECT_TRUE(sensors.empty());
  Captured out;
  EXPECT_TRUE(sensors.read(out, rig.engine->points()).empty());
  EXPECT_TRUE(out.row.empty() && out.number.empty());
}
