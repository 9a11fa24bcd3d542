#include "importers/mjcf/actuators.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "importers/mjcf/words.h"

namespace mortise::importers::mjcf {
namespace {

template <class List>
std::size_t named(const List& list, const Element& e, const char* attribute, const char* what) {
  const std::string name = e.text(attribute);
  std::vector<std::string> names;
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (list[i].name == name) return i;
    names.push_back(list[i].name);
  }
  e.fail(with_hint(std::string("there is no ") + what + " '" + name + "'", name, names));
}

// Is it one of those that let a body go anywhere?
bool freed(const Robot& robot, const Element& e, const char* attribute) {
  return e.has(attribute) && std::find(robot.freed.begin(), robot.freed.end(), e.text(attribute)) != robot.freed.end();
}

double largest(const Element& e, const char* attribute) {
  const std::vector<double> range = e.numbers(attribute, 2);
  return std::max(std::abs(range[0]), std::abs(range[1]));
}

// An actuator's force f = g u + b0 + b1 q + b2 q' at the joint times its gear: a PD motor where b1 = -g, and with b1 = 0, b2 = -g one that holds a
// speed, which is a damper where none is asked for. Does the joint have a motor?
bool drive(const Element& e, Joint& j, Notes& notes) {
  const std::string kind = e.name();
  const double gear = e.has("gear") ? std::abs(e.numbers("gear").at(0)) : 1, square = gear * gear;
  std::vector<double> gain{0}, bias;
  if (kind == "position" || kind == "intvelocity")
    gain[0] = e.number("kp", 1.0), bias = {0, -gain[0], -e.number("kv", 0.0)};
  else if (kind == "velocity")
    gain[0] = e.number("kv", 1.0), bias = {0, 0, -gain[0]};
  else if (kind == "general" && e.has("gainprm") && e.has("biasprm") && e.text("biastype", "none") == "affine")
    gain = e.numbers("gainprm"), bias = e.numbers("biasprm");
  bias.resize(3, 0);
  if (gain.at(0) > 0 && bias[1] == 0 && bias[2] == -gain[0]) {
    j.damping += square * gain[0];
    notes.add(e.where(),
              "a motor that holds a speed has no equal: its joint is damped by its gain (kv), as if it held zero, without a limit of force");
    return false;
  }
  if (kind == "damper") {
    notes.add(e.where(), "<damper> in <actuator> is not imported");
    return false;
  }
  if (gain[0] > 0 && bias[1] == -gain[0])
    j.kp = square * gain[0], j.kd = std::max(0.0, square * -bias[2]);
  else
    notes.add(e.where(), "an actuator without gains of a position: its joint has a position motor whose gains are chosen");
  if (kind == "intvelocity") notes.add(e.where(), "<intvelocity> becomes a position motor: the integral of its input is to be given as the target");
  double effort = e.has("forcerange") ? gear * largest(e, "forcerange") : 0;
  if (effort == 0 && kind == "motor" && e.has("ctrlrange")) effort = gear * largest(e, "ctrlrange");
  if (effort > 0) j.effort = j.effort > 0 ? std::min(j.effort, effort) : effort;
  return true;
}

}  // namespace

void read_actuators(const Element& root, const Defaults& defaults, Robot& robot, Notes& notes) {
  bool any = false;
  std::map<std::string, std::vector<std::size_t>> tendons;  // joints that they pull
  std::set<std::string> idle;                               // that no actuator pulls
  std::map<std::string, SourceLoc> places;
  for (const Element& section : root.children("tendon"))
    for (const Element& fixed : section.children()) {
      if (fixed.name() != "fixed") {
        notes.add(fixed.where(), "<" + fixed.name() + "> in <tendon> is not imported");
        continue;
      }
      fixed.expect(words::tendon, {"joint"}, words::dropped_tendon, notes);
      const std::string name = fixed.text("name", "");
      idle.insert(name), places[name] = fixed.where();
      if (name.empty()) continue;
      for (const Element& j : fixed.children("joint"))
        if (!freed(robot, j, "joint")) tendons[name].push_back(named(robot.joints, j, "joint", "joint"));
    }
  std::vector<std::uint8_t> driven(robot.joints.size(), 0);
  for (const Element& section : root.children("actuator"))
    for (const Element& one : section.children()) {
      const Element e = defaults.complete(
          one, "main", one.name() == "general" ? std::vector<std::string>{"general"} : std::vector<std::string>{one.name(), "general"});
      any = true;
      if (e.has("joint") && !freed(robot, e, "joint")) {
        const std::size_t j = named(robot.joints, e, "joint", "joint");
        if (drive(e, robot.joints[j], notes)) driven[j] = 1;
      } else if (e.has("tendon") && tendons.count(e.text("tendon")) > 0) {
        for (const std::size_t j : tendons[e.text("tendon")]) driven[j] = 1;
        idle.erase(e.text("tendon"));
        notes.add(e.where(), "joints that a tendon pulls have motors of their own");
      } else {
        notes.add(e.where(), "an actuator that acts on no joint, or on one of a free body, is left out");
      }
    }
  for (const std::string& name : idle) notes.add(places[name], "a tendon that no actuator pulls is not imported");
  for (std::size_t j = 0; j < robot.joints.size(); ++j) robot.joints[j].passive = any && driven[j] == 0;
}

namespace {

// Two bodies that are held together at a point, or wholly, as they stand in the file.
void read_loop(const Element& e, Robot& robot, Notes& notes) {
  const bool weld = e.name() == "weld";
  e.expect({"name", "class", "active", "body1", "body2", weld ? "relpose" : "anchor"}, {},
           {"solref", "solimp", "torquescale", weld ? "anchor" : "relpose"}, notes);
  Loop l;
  l.where = e.where(), l.fixed = weld;
  l.a = named(robot.links, e, "body1", "body"), l.b = e.has("body2") ? named(robot.links, e, "body2", "body") : 0;
  l.name = e.text("name", robot.links[l.a].name + "_" + robot.links[l.b].name);
  if (!weld) l.at = e.vector("anchor");
  if (l.a == l.b) e.fail("<" + e.name() + "> ties a body to itself");
  if (weld && e.has("relpose")) notes.add(e.where(), "a <weld> holds its bodies as they stand: 'relpose' is not imported");
  robot.loops.push_back(l);
}

}  // namespace

void read_equality(const Element& root, Robot& robot, Notes& notes) {
  for (const Element& section : root.children("equality"))
    for (const Element& e : section.children()) {
      if (e.has("active") && e.text("active") == "false") continue;
      if ((e.name() == "connect" || e.name() == "weld") && e.has("body1")) {
        read_loop(e, robot, notes);
        continue;
      }
      if (e.name() != "joint" || freed(robot, e, "joint1") || freed(robot, e, "joint2")) {
        notes.add(e.where(), "<" + e.name() + "> in <equality> is not imported");
        continue;
      }
      e.expect({"name", "class", "active", "joint1", "joint2", "polycoef"}, {}, {"solref", "solimp"}, notes);
      std::vector<double> c = e.has("polycoef") ? e.numbers("polycoef") : std::vector<double>{0, 1};
      c.resize(5, 0);
      if (!e.has("joint2")) {  // it stays where it is told to
        Joint& held = robot.joints[named(robot.joints, e, "joint1", "joint")];
        if (held.moves()) held.limits = {held.zero + c[0], held.zero + c[0]};
        continue;
      }
      if (c[2] != 0 || c[3] != 0 || c[4] != 0) {
        notes.add(e.where(), "an equality of joints that is no straight line between two is not imported");
        continue;
      }
      // y - y0 = c0 + c1 (x - x0), of what they are beyond where they stand in the file
      const Joint& leader = robot.joints[named(robot.joints, e, "joint2", "joint")];
      Joint& j = robot.joints[named(robot.joints, e, "joint1", "joint")];
      j.mimic = Joint::Mimic{leader.name, c[1], j.zero + c[0] - c[1] * leader.zero};
    }
}

void read_contact(const Element& root, Robot& robot, Notes& notes) {
  for (const Element& section : root.children("contact")) {
    section.expect({}, {"exclude"}, {"pair"}, notes);
    for (const Element& e : section.children("exclude"))
      robot.apart.emplace_back(named(robot.links, e, "body1", "body"), named(robot.links, e, "body2", "body"));
  }
}

}  // namespace mortise::importers::mjcf
