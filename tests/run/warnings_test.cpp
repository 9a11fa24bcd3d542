#include "run/warnings.h"

#include <gmock/gmock.h>

#include "engine/effect_tables.h"
#include "engine/input.h"
#include "scene/scene.h"

using namespace mortise;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

namespace {

std::vector<std::string> warned(const std::vector<std::string>& set) {
  const scene::Scene s = scene::read_scene_text(R"(
mortise: 1
name: w
time: {step: 5 ms, steps: 1}
materials: {gel: {youngs_modulus: 50 kPa, poisson_ratio: 0.4, density: 1000}}
bodies:
  block: {type: soft, shape: {box: {size: [20 mm, 20 mm, 10 mm], edge_length: 10 mm}}, material: gel, position: [0, 0, 6 mm]}
  floor: {type: half_space}
effects: {inertia: {}, elasticity: {}, barrier_contact: {}}
)",
                                                "w.yaml", set, engine::effect_tables());
  return run::warnings(engine::make_input(s.root));
}

}  // namespace

// What 0.1.0 took without a word: a modulus of 50 Pa, steps of 100 s, a contact layer as thick as the scene, a floor without contact.
TEST(Warnings, TellWhatIsHardlyEverMeant) {
  EXPECT_THAT(warned({}), IsEmpty());
  EXPECT_THAT(warned({"materials.gel.youngs_modulus=50"}),
              ElementsAre(HasSubstr("materials.gel.youngs_modulus is 50 Pa, softer than the softest tissue")));
  EXPECT_THAT(warned({"materials.gel.density=1 g/cm^3"}), IsEmpty());
  EXPECT_THAT(warned({"materials.gel.density=1.05"}), ElementsAre(HasSubstr("materials.gel.density is 1.05 kg/m^3, lighter than any foam")));
  EXPECT_THAT(warned({"time.step=100 s"}), ElementsAre(HasSubstr("time.step is 100 s")));
  EXPECT_THAT(warned({"bodies.block.rotation={axis: [0, 0, 1], angle: 90}"}),
              ElementsAre(HasSubstr("'block' is rotated by 90 rad, which is more than a turn; degrees are written '90 deg'")));
  EXPECT_THAT(warned({"bodies.block.rotation={axis: [0, 0, 1], angle: 360 deg}"}), IsEmpty());
  const std::string hinge = "effects.joint=[{type: revolute, body: block, at: [0, 0, 0], axis: [0, 0, 1], angle_limits: [-90, ";
  EXPECT_THAT(warned({hinge + "1]}]"}), ElementsAre(HasSubstr("angle_limits of up to 90 rad are more than a turn; degrees are written '90 deg'")));
  EXPECT_THAT(warned({hinge + "1000]}]"}), IsEmpty()) << "it may turn for long";
  EXPECT_THAT(warned({"effects.barrier_contact.d_hat=5 mm"}), ElementsAre(HasSubstr("d_hat is 0.005 m, 0.25 times the size of body 'block'")));
}

TEST(Warnings, TellWhatIsNeverReached) {
  const std::string stone =
      "bodies.stone={type: stiff, shape: {box: {size: [20 mm, 20 mm, 20 mm], edge_length: 10 mm}}, position: [1, 0, 1], mass: 1";
  const auto held = [&](const std::string& body, const std::string& pin) {
    return warned({stone + body + "}", "effects.affine_body={}", "effects.pin=[{body: stone, where: {side: all}" + pin + "}]"});
  };
  EXPECT_THAT(held("", ""), IsEmpty());
  EXPECT_THAT(held(", velocity: [0, 0, 1]", ""), ElementsAre(HasSubstr("velocity of 'stone' means nothing: a pin says how it goes")));
  EXPECT_THAT(held(", velocity: [0, 0, 1]", ", release: 1 ms"), IsEmpty());
  EXPECT_THAT(held("", ", motion: {time: [6 ms, 9 ms], translation: [[0, 0, 0], [0, 0, 1 mm]]}"),
              ElementsAre(HasSubstr("the first key is at 0.006 s, and the scene ends at 0.005 s: nothing of it is reached")));
  EXPECT_THAT(held("", ", motion: {time: [0, 9 ms], translation: [[0, 0, 0], [0, 0, 1 mm]]}"), IsEmpty());
}

// Torques were 4 to 20 times too large, and nobody had said anything.
TEST(Warnings, TellOfCorners) {
  std::string times, angles;
  for (int k = 0; k < 11; ++k) times += (k ? ", " : "") + std::to_string(0.02 * k), angles += (k ? ", " : "") + std::to_string(0.01 * k * k);
  const auto told = [&](const std::string& mode, const std::string& interpolation, const std::string& step = "5 ms") {
    return warned(
        {"bodies.stone={type: stiff, shape: {box: {size: [20 mm, 20 mm, 20 mm], edge_length: 10 mm}}, position: [1, 0, 1], mass: 1}",
         "effects.affine_body={}", "effects.joint=[{name: j, body: stone, type: revolute, at: [1, 0, 1], axis: [0, 0, 1]}]",
         "effects.drive=[{joint: j, " + mode + ", angle: {time: [" + times + "], value: [" + angles + "]}, interpolation: " + interpolation + "}]",
         "time.step=" + step, "time.steps=100"});
  };
  EXPECT_THAT(told("mode: kinematic", "linear"),
              ElementsAre(HasSubstr("the target of 'j' goes straight between 11 keys: its speed jumps at each, and its torque is that of jumps")));
  EXPECT_THAT(told("mode: kinematic", "smooth"), IsEmpty());
  EXPECT_THAT(told("mode: kinematic", "linear", "20 ms"), IsEmpty()) << "no step sees a corner";
  EXPECT_THAT(told("mode: pd, kp: 1", "linear"), IsEmpty());
}

TEST(Warnings, TellOfUnitsThatAreMissing) {
  EXPECT_THAT(warned({"effects.barrier_contact.stiffness=1e16"}),
              ElementsAre(HasSubstr("effects.barrier_contact.stiffness is 1e+16 Pa; is the unit")));
  EXPECT_THAT(warned({"effects.friction={follows: barrier_contact, mu: 30}"}), ElementsAre(HasSubstr("effects.friction.mu is 30; is the unit")));
  EXPECT_THAT(warned({"bodies.block.position=[2000, 0, 6 mm]"}), ElementsAre(HasSubstr("'block' is 2e+03 m from the origin")));
  const std::string stiff = "bodies.stone={type: stiff, shape: {box: {size: [20 mm, 20 mm, 20 mm], edge_length: 10 mm}}, position: [1, 0, 1], mass: ";
  EXPECT_THAT(warned({stiff + "1e9}", "effects.affine_body={}"}), ElementsAre(HasSubstr("bodies.stone.mass is 1e+09 kg")));
  const auto motor = [&](const std::string& joint, const std::string& drive) {
    return warned({stiff + "1}", "effects.affine_body={}", "effects.joint=[{name: j, body: stone, " + joint + "}]",
                   "effects.drive=[{joint: j, mode: pd, kp: 1, " + drive + "}]"});
  };
  const std::string hinge = "type: revolute, at: [1, 0, 1], axis: [0, 0, 1]", slide = "type: prismatic, axis: [0, 0, 1], travel_limits: [0, 20 mm]";
  EXPECT_THAT(motor(hinge, "angle: {time: [0, 1], value: [0, 90]}"), ElementsAre(HasSubstr("aims at 90 rad, which is more than a turn")));
  EXPECT_THAT(motor(hinge, "angle: {time: [0, 1], value: [0, 62.8]}"), IsEmpty()) << "a wheel";
  EXPECT_THAT(motor(hinge + ", angle_limits: [-1, 1]", "angle: 1.5"), ElementsAre(HasSubstr("aims at 1.5 rad, beyond the limits of the joint")));
  EXPECT_THAT(motor(slide, "travel: 50"), ElementsAre(HasSubstr("the motor of 'j' aims at 50 m, beyond the limits of the joint, 0 and 0.02")));
  EXPECT_THAT(motor(slide, "travel: 10 mm"), IsEmpty());
}

// A layer of a metre around a pad of 16 mm hung the first step.
TEST(Warnings, LayersThickerThanBodiesAreRefused) {
  try {
    warned({"effects.barrier_contact.d_hat=11 mm"});
    FAIL();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), HasSubstr("effects.barrier_contact.d_hat is 0.011 m, more than half of body 'block', which is 0.02 m large"));
  }
  EXPECT_THAT(warned({"effects.barrier_contact={d_hat: 6 mm, pairs: [[block, floor]]}",
                      "bodies.pin={type: stiff, shape: {box: {size: [5 mm, 5 mm, 5 mm], edge_length: 5 mm}}, position: [1, 0, 1], mass: 1}",
                      "effects.affine_body={}"}),
              ElementsAre(HasSubstr("0.3 times the size of body 'block'")))
      << "only what it acts on";
}

// A block between both slid through 0.29 m instead of 0.11 m, and nobody had said anything.
TEST(Warnings, TellWhatSlidesFreely) {
  EXPECT_THAT(warned({"effects.friction={follows: barrier_contact, mu: 0.3}"}), IsEmpty());
  EXPECT_THAT(warned({"effects.mortar_contact={pairs: [{slave: block, master: floor}]}", "effects.friction={follows: mortar_contact, mu: 0.3}"}),
              ElementsAre(HasSubstr("effects.friction follows mortar_contact: what barrier_contact presses slides freely")));
}

// A strip was to be pulled out from 1 s to 12 s, and was not: statics end at 1.
TEST(Warnings, TellOfKeysThatStaticsDoNotReach) {
  const std::string pull =
      "effects.pin=[{body: block, where: {side: x_max}, motion: {time: [0, 1, 12], translation: [[0, 0, 0], [0, 0, 0], [1, 0, 0]]}}]";
  EXPECT_THAT(warned({pull}), IsEmpty());
  const std::vector<std::string> set{"time={mode: static, steps: 2}", "effects={elasticity: {}, barrier_contact: {}}", pull};
  EXPECT_THAT(warned(set), ElementsAre(HasSubstr("the key at 12 s is not reached: static scenes go from 0 to 1")));
}

// A grid on the upper face with its normal downwards felt the lower face: every taxel read nothing, and the wrench the force.
TEST(Warnings, TellOfSensorsThatAreTurnedAround) {
  const auto grid = [](const std::string& at) {
    return "sensors={tip: {body: block, " + at + ", rows: 4, columns: 4, width: 10 mm, height: 10 mm}}";
  };
  EXPECT_THAT(warned({grid("position: [0, 0, 11 mm]")}), IsEmpty());
  EXPECT_THAT(
      warned({grid("position: [0, 0, 11 mm], normal: [0, 0, -1]")}),
      ElementsAre(HasSubstr("sensor 'tip' lies on a surface of 'block' that faces the other way, and feels the one behind it: turn its normal")));
  EXPECT_THAT(warned({grid("position: [0, 0, 1 mm], normal: [0, 0, -1]")}), IsEmpty());
  EXPECT_THAT(warned({grid("position: [0, 0, 6 mm], normal: [0, 0, -1]")}), IsEmpty()) << "in the middle: meant";
}

// A grid of 12 m was one of 12 mm.
TEST(Warnings, TellOfSensorsThatLieNowhere) {
  EXPECT_THAT(warned({"sensors={tip: {body: block, position: [0, 0, 11 mm], rows: 4, columns: 4, width: 10 m, height: 10 mm}}"}),
              ElementsAre(HasSubstr("sensor 'tip' has a surface of 'block' under 0.2 % of its 10 m by 0.01 m only")));
}

TEST(Warnings, TellWhereElementsLock) {
  EXPECT_THAT(warned({"materials.gel.poisson_ratio=0.49"}), IsEmpty());
  EXPECT_THAT(warned({"materials.gel.volumetric=full"}), IsEmpty());
  EXPECT_THAT(warned({"materials.gel.poisson_ratio=0.49", "materials.gel.volumetric=full"}),
              ElementsAre(HasSubstr("the elements of body 'block' lock")));
  EXPECT_THAT(warned({"materials.gel.poisson_ratio=0.45", "materials.gel.volumetric=full", "bodies.block.order=2"}), IsEmpty());
}

TEST(Warnings, TellWhereNothingKeepsBodiesApart) {
  const scene::Scene s = scene::read_scene_text(
      "mortise: 1\nname: w\ntime: {step: 5 ms, steps: 1}\nmaterials: {m: {density: 1000}}\nbodies:\n  a: {type: stiff, shape: {box: {size: [1, 1, "
      "1], edge_length: 1}}, material: m}\n  floor: {type: half_space, point: [0, 0, -1]}\n"
      "effects: {inertia: {}, gravity: {}, affine_body: {}}\n",
      "w.yaml", {}, engine::effect_tables());
  EXPECT_THAT(run::warnings(engine::make_input(s.root)), ElementsAre(HasSubstr("nothing keeps bodies apart")));
}
