// What a run says of sensors that lie beside the forces.
#include "run/sensor_reach.h"

#include <gmock/gmock.h>

#include "engine/effect_tables.h"
#include "engine/input.h"
#include "scene/scene.h"

using namespace mortise;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

namespace {

sensors::Reading reading(const Vec3& on_body, const std::vector<double>& on_taxels) {
  sensors::Reading r;
  r.wrench_force = on_body, r.force = on_taxels;
  return r;
}

}  // namespace

// A foot on which a plate pressed with 12.6 N had a map of zeros, without a word: its normal pointed up, and the far side of the foot lies there.
TEST(SensorReach, TellsOfMapsThatFeelNothingOfTheForce) {
  const scene::Scene s = scene::read_scene_text(R"(
mortise: 1
name: w
time: {step: 5 ms, steps: 1}
materials: {gel: {youngs_modulus: 50 kPa, poisson_ratio: 0.4, density: 1000}}
bodies: {ball: {type: soft, shape: {sphere: {radius: 10 mm, edge_length: 10 mm}}, material: gel}}
effects: {inertia: {}, elasticity: {}, barrier_contact: {}}
sensors: {map: {body: ball, position: [0, 0, 10 mm], rows: 1, columns: 2, width: 10 mm, height: 10 mm}}
)",
                                                "w.yaml", {}, engine::effect_tables());
  const sensors::Sensors sensors(engine::make_input(s.root));
  const auto warned = [&](const std::vector<sensors::Reading>& readings) {
    run::SensorReach reach;
    for (const sensors::Reading& r : readings) reach.see({r});
    return reach.warnings(sensors);
  };
  EXPECT_THAT(warned({reading({0, 0, -12.6}, {0, 0, 0, 0, 0, 0})}),
              ElementsAre(HasSubstr("sensor 'map' covers none of the force on 'ball' (12.6 N")));
  EXPECT_THAT(warned({reading({0, 0, -10}, {0, 0, -0.3, 0, 0, -0.2})}), ElementsAre(HasSubstr("covers 5 % of the force")));
  EXPECT_THAT(warned({reading({0, 0, -10}, {0, 0, -2, 0, 0, -1})}), IsEmpty());
  EXPECT_THAT(warned({reading({0, 0, -2}, {0, 0, -2, 0, 0, 0}), reading({0, 0, -10}, {0, 0, 0, 0, 0, 0})}), IsEmpty()) << "felt something, once";
  EXPECT_THAT(warned({reading({0, 0, 0}, {0, 0, 0, 0, 0, 0})}), IsEmpty()) << "nothing touched it";
  EXPECT_THAT(warned({reading({0, 0, 0}, {0, 0, -5, 0, 0, 0})}), IsEmpty()) << "squeezed from both sides";
}
