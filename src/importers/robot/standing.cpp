#include "importers/robot/standing.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "importers/robot/names.h"
#include "importers/robot/tuning.h"
#include "scene/suggest.h"

namespace mortise::importers {
namespace {

// Throws where a pattern fits no joint that moves.
void check_names(const Robot& robot, const MachineOptions& options) {
  for (const Stand& s : options.stands)
    if (std::none_of(robot.joints.begin(), robot.joints.end(), [&](const Joint& j) { return j.moves() && matches(s.joint, j.name); })) {
      std::vector<std::string> names;
      for (const Joint& j : robot.joints)
        if (j.moves()) names.push_back(j.name);
      throw Error(Exit::usage, options.asked_joint + s.joint + ": no joint that moves is called so; " + scene::suggestion(s.joint, names));
    }
}

// May this joint be asked to stand so? Patterns may fit joints that follow others, which do so.
void check_asked(const Robot& robot, const Joint& j, const Stand& s, const std::string& asked) {
  const bool slides = j.type == Joint::Type::prismatic;
  if (s.as == (slides ? Stand::As::angle : Stand::As::length))
    throw Error(Exit::usage, asked + j.name + (slides ? ": it slides, and is given a length" : ": it turns, and is given an angle"));
  if (j.mimic && s.joint == j.name)
    throw Error(Exit::usage, asked + j.name + ": it mimics '" + robot.joints[j.mimic->leader].name + "', which says where both stand");
}

std::string beyond(const Joint& j, double at) {
  return std::to_string(at) + ": its limits are " + std::to_string(j.limits->first) + " and " + std::to_string(j.limits->second);
}

// Joints on the ways between the two ends of a loop.
std::vector<std::uint8_t> in_loops(const Robot& robot) {
  std::vector<std::uint8_t> out(robot.joints.size(), 0);
  for (const Loop& loop : robot.loops) {
    std::vector<std::uint8_t> above(robot.joints.size(), 0);
    const auto up = [&](std::size_t link, const auto& visit) {
      for (; robot.joint_of[link] >= 0; link = robot.joints[robot.joint_of[link]].parent) visit(static_cast<std::size_t>(robot.joint_of[link]));
    };
    up(loop.a, [&](std::size_t j) { above[j] = 1; });
    up(loop.b, [&](std::size_t j) { above[j] ^= 1; });
    for (std::size_t j = 0; j < out.size(); ++j) out[j] = out[j] != 0 || above[j] != 0;
  }
  return out;
}

// Links in the world.
std::vector<Pose> place(const Robot& robot, const std::vector<double>& at) {
  std::vector<Pose> out(robot.links.size());
  for (const std::size_t link : robot.order) {
    if (link == robot.root) continue;
    const Joint& j = robot.joints[robot.joint_of[link]];
    out[link] = out[j.parent] * j.origin * j.motion(at[robot.joint_of[link]]);
  }
  return out;
}

// Of hinges that cannot be straight.
void bend_back(const Robot& robot, const std::vector<std::uint8_t>& free, Standing& out) {
  constexpr double kParallel = 1e-3;
  const std::vector<double> bent = out.at;
  std::vector<double> zero;
  for (const Joint& j : robot.joints) zero.push_back(j.zero);
  const std::vector<Pose> in_world = place(robot, zero);  // axes as the file has them
  const auto axis = [&](const Joint& j) -> Vec3 { return in_world[j.child].R * j.axis; };
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const Joint& j = robot.joints[i];
    if (!free[i] || bent[i] == j.zero) continue;
    std::ptrdiff_t before = robot.joint_of[j.parent];
    while (before >= 0 && robot.joints[before].type == Joint::Type::fixed) before = robot.joint_of[robot.joints[before].parent];
    if (before < 0 || !free[before] || bent[before] != robot.joints[before].zero || axis(robot.joints[before]).cross(axis(j)).norm() > kParallel)
      continue;
    const double back = -0.5 * (bent[i] - j.zero) * (axis(robot.joints[before]).dot(axis(j)) > 0 ? 1 : -1);
    const auto& limits = robot.joints[before].limits;
    const double there = robot.joints[before].zero + back;
    if (!limits || (limits->first + kStopRange[0] < there && there < limits->second - kStopRange[0])) out.at[before] = there;
  }
}

}  // namespace

double widest_swing(const MachineOptions& options, Joint::Type type) { return options.sway * (type == Joint::Type::prismatic ? kSwaySlide : 1); }

Standing stand(const Robot& robot, const MachineOptions& options) {
  check_names(robot, options);
  Standing out;
  for (const Joint& j : robot.joints) out.at.push_back(j.zero);
  out.looped = in_loops(robot);
  std::vector<std::uint8_t> free(robot.joints.size(), 0);
  const bool held = options.held || robot.links[robot.root].name == "world";
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const Joint& j = robot.joints[i];
    if (!j.moves()) continue;
    bool asked = false;
    for (const Stand& s : options.stands)
      if (matches(s.joint, j.name)) check_asked(robot, j, s, options.asked_joint), out.at[i] = s.value, asked = true;
    if (out.looped[i] && asked)
      throw Error(Exit::usage, options.asked_joint + j.name + ": it is part of a loop of joints, which stands as the file has it");
    if (out.looped[i]) continue;
    if (!asked && j.stand) out.at[i] = *j.stand;
    free[i] = !asked && !j.stand && !j.mimic && j.type == Joint::Type::revolute;
    if (!j.limits || j.mimic) continue;
    const auto [low, high] = *j.limits;
    if (asked && !(low < out.at[i] && out.at[i] < high)) throw Error(Exit::usage, options.asked_joint + j.name + "=" + beyond(j, out.at[i]));
    const double range = std::min(kStopRange[j.type == Joint::Type::prismatic], (high - low) / 20);
    if (!asked) out.at[i] = std::clamp(out.at[i], low + kFromLimit * range, high - kFromLimit * range);
    if (!asked && !j.stand && options.sway > 0 && held) {  // room to swing; who stands on the floor would fall
      const double room = widest_swing(options, j.type) / kSwayRoom;
      out.at[i] = high - low > 2 * room ? std::clamp(out.at[i], low + room, high - room) : 0.5 * (low + high);
    }
  }
  bend_back(robot, free, out);
  for (std::size_t round = 0; round < robot.joints.size(); ++round)  // leaders that follow others
    for (std::size_t i = 0; i < robot.joints.size(); ++i) {
      const Joint& j = robot.joints[i];
      if (j.mimic && j.moves() && !out.looped[i]) out.at[i] = j.mimic->multiplier * out.at[j.mimic->leader] + j.mimic->offset;
    }
  for (std::size_t i = 0; i < robot.joints.size() && !options.stands.empty(); ++i) {
    const Joint& j = robot.joints[i];
    if (!j.mimic || !j.limits || !j.moves() || out.looped[i]) continue;
    if (const double room = kSameLimit * (j.limits->second - j.limits->first);
        out.at[i] < j.limits->first - room || out.at[i] > j.limits->second + room)
      throw Error(Exit::usage, options.asked_joint + robot.joints[j.mimic->leader].name + ": '" + j.name + "', which mimics it, would stand at " +
                                   beyond(j, out.at[i]));
  }
  out.in_world = place(robot, out.at);
  return out;
}

}  // namespace mortise::importers
