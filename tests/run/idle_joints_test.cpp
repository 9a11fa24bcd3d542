// Joints that hold nothing new (run/idle_joints.h).
#include "run/idle_joints.h"

#include <gmock/gmock.h>

#include "engine/effect_tables.h"
#include "engine/input.h"
#include "scene/scene.h"

using namespace mortise;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

namespace {

std::vector<std::string> idle(const std::string& joints) {
  const scene::Scene s = scene::read_scene_text(R"(
mortise: 1
name: door
time: {step: 5 ms, steps: 1}
materials: {wood: {density: 600}}
bodies:
  frame: {type: stiff, shape: {box: {size: [20 mm, 20 mm, 1 m], edge_length: 1}}, material: wood}
  door: {type: stiff, shape: {box: {size: [600 mm, 20 mm, 900 mm], edge_length: 1}}, material: wood, position: [330 mm, 0, 0]}
  arm: {type: stiff, shape: {box: {size: [20 mm, 400 mm, 20 mm], edge_length: 1}}, material: wood, position: [600 mm, 220 mm, 0]}
  bar: {type: stiff, shape: {box: {size: [500 mm, 20 mm, 20 mm], edge_length: 1}}, material: wood, position: [300 mm, 430 mm, 0]}
effects:
  inertia: {}
  affine_body: {}
  pin: [{body: frame, where: {side: all}}]
  joint:
)" + joints,
                                                "door.yaml", {}, engine::effect_tables());
  return run::idle_joints(engine::make_input(s.root));
}

std::string joint(const std::string& name, const std::string& type, const std::string& body, const std::string& to, const std::string& at) {
  return "    - {name: " + name + ", type: " + type + ", body: " + body + ", to: " + to + ", at: [" + at + "]" +
         (type == "revolute" ? ", axis: [0, 0, 1]}\n" : "}\n");
}

}  // namespace

TEST(IdleJoints, AreThoseThatRepeatOthers) {
  const std::string hinge = joint("top", "revolute", "door", "frame", "15 mm, 0, 400 mm");
  EXPECT_THAT(idle(hinge), IsEmpty());
  EXPECT_THAT(idle(hinge + joint("low", "revolute", "door", "frame", "15 mm, 0, -400 mm")),
              ElementsAre(HasSubstr("door.yaml:17:7: joint 'low' holds nothing that other joints do not hold already")));
  EXPECT_THAT(idle(hinge + joint("low", "spherical", "door", "frame", "15 mm, 0, -400 mm")), ElementsAre(HasSubstr("'low'")));
  EXPECT_THAT(idle(joint("top", "spherical", "door", "frame", "15 mm, 0, 400 mm") + joint("low", "spherical", "door", "frame", "15 mm, 0, -400 mm")),
              IsEmpty());
  EXPECT_THAT(idle(hinge + joint("low", "revolute", "door", "frame", "16 mm, 0, -400 mm")), IsEmpty()) << "beside the axis: a lock";
}

TEST(IdleJoints, AreNoneOfLoopsThatMove) {
  EXPECT_THAT(idle(joint("a", "revolute", "door", "frame", "0, 0, 0") + joint("b", "revolute", "arm", "door", "600 mm, 0, 0") +
                   joint("c", "revolute", "bar", "arm", "600 mm, 430 mm, 0") + joint("d", "revolute", "bar", "frame", "0, 430 mm, 0")),
              IsEmpty());
}
