#include "importers/mjcf/keyframe.h"

#include <Eigen/Geometry>

namespace mortise::importers::mjcf {

void read_keyframe(const Element& root, Robot& robot, Notes& notes) {
  std::vector<Element> keys;
  for (const Element& section : root.children("keyframe"))
    for (const Element& e : section.children("key"))
      if (e.has("qpos")) keys.push_back(e);
  if (keys.empty()) return;
  std::size_t home = 0;
  for (std::size_t k = keys.size(); k-- > 0;)
    if (keys[k].has("name") && keys[k].text("name") == "home") home = k;
  const Element& key = keys[home];
  if (!robot.loops.empty() || !robot.freed.empty()) {
    notes.add(key.where(), "a <key> is not imported where joints form loops, or six of them make a body free");
    return;
  }
  const std::vector<double> q = key.numbers("qpos");
  std::size_t wanted = 0;
  for (const Joint& j : robot.joints) wanted += j.type == Joint::Type::floating ? 7 : j.type == Joint::Type::spherical ? 4 : j.moves() ? 1 : 0;
  if (q.size() != wanted)
    key.fail("attribute 'qpos' of <key> has " + std::to_string(q.size()) + " numbers; the joints have " + std::to_string(wanted));
  std::size_t at = 0;
  for (Joint& j : robot.joints) {
    if (j.moves()) j.stand = q[at++];
    if (j.type == Joint::Type::spherical) {
      if (q[at] * q[at] < 1 - 1e-9) notes.add(key.where(), "ball joints do not stand as the <key> says, but as the bodies do");
      at += 4;
    }
    if (j.type != Joint::Type::floating) continue;
    const Eigen::Quaterniond turn(q[at + 3], q[at + 4], q[at + 5], q[at + 6]);
    if (!(turn.norm() > 0)) key.fail("a quaternion of 'qpos' is zero");
    j.origin = {turn.normalized().toRotationMatrix(), Vec3(q[at], q[at + 1], q[at + 2])};
    at += 7;
  }
  notes.add(key.where(), "joints stand as this <key> says" + (keys.size() > 1 ? ", of " + std::to_string(keys.size()) : ""));
}

}  // namespace mortise::importers::mjcf
