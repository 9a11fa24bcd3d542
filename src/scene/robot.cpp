#include "scene/robot.h"

#include <algorithm>

#include "scene/checker.h"
#include "scene/merge.h"

namespace mortise::scene {
namespace {

using Kind = Param::Kind;
using namespace param;

RobotReader& reader() {
  static RobotReader r;
  return r;
}

const ParamTable& package_table() {
  static const ParamTable t{"package",
                            "Where package://NAME is.",
                            {required(of(Kind::text, "name", Unit::none, {}, "NAME.")),
                             required(of(Kind::text, "folder", Unit::none, {}, "Its folder; relative ones start at the scene's."))}};
  return t;
}

const ParamTable& joint_table() {
  static const ParamTable t{
      "place of a joint",
      "Where a joint stands at the start.",
      {required(of(Kind::text, "joint", Unit::none, {}, "Its name; * and ? match any characters; the last entry that fits holds.")),
       optional(of(Kind::number, "angle", Unit::angle, {}, "Of a hinge.")), optional(of(Kind::number, "travel", Unit::length, {}, "Of a slide."))}};
  return t;
}

const ParamTable& link_table() {
  static const ParamTable t{
      "override",
      "What differs from the robot's file at some links.",
      {required(of(Kind::text, "link", Unit::none, {}, "Name of a link; * and ? match any characters; the last entry that fits holds.")),
       choice("type", {"stiff", "soft"}, "stiff", "soft: a rubber pad in the shape of the link, bonded to what the link is fixed to."),
       positive(optional(of(Kind::number, "youngs_modulus", Unit::pressure, {}, "Of a soft link; absent: 1 MPa."))),
       optional(range(number("poisson_ratio", Unit::none, "0.45", 0, "Of a soft link; absent: 0.45."), 0, 0.4999)),
       positive(optional(of(Kind::number, "edge_length", Unit::length, {}, "Of a soft link's mesh; absent: a sixth of its size."))),
       range(optional(of(Kind::vec3, "color", Unit::none, {}, "Red, green, blue of the body that the link belongs to.")), 0, 1)}};
  return t;
}

const ParamTable& gait_table() {
  static const ParamTable t{
      "gait of a robot",
      "Four legs, each the last two hinges of a limb, step in turn along x. What is absent suits their length.",
      {required(choice("type", kGaits, "", "trot: diagonal feet together; pace: those of a side; bound: those in front; walk: one after the other.")),
       positive(optional(of(Kind::number, "period", Unit::time, {}, "Of a cycle."))),
       optional(of(Kind::number, "stride", Unit::length, {}, "Way of a foot along the ground while it stands.")),
       range(optional(of(Kind::number, "clearance", Unit::length, {}, "Height of a swinging foot.")), 0, INFINITY),
       range(optional(of(Kind::number, "duty", Unit::none, {}, "Share of a cycle that a foot stands.")), 0, 1)}};
  return t;
}

Param blocks(std::string key, const ParamTable* sub, std::string help) {
  Param p = table(std::move(key), sub, std::move(help));
  p.kind = Kind::tables;
  return p;
}

}  // namespace

const ParamTable& robot_table() {
  static const ParamTable t{
      "robot",
      "A robot's file, which stands for bodies, joints, motors, contact and cameras; what the scene says itself goes over them.",
      {required(of(Kind::path, "file", Unit::none, {}, "URDF or MJCF file.")),
       blocks("packages", &package_table(), "Where packages of its meshes are."),
       choice("missing_meshes", {"error", "skip"}, "error", "What happens where a mesh of the robot is not there; skip: it goes without."),
       choice("base", {"free", "fixed"}, "free", "Whether bases of robots move: bodies that move freely and have joints below them."),
       positive(number("clearance", Unit::length, "2 mm", 0, "Of the lowest point above the floor.")),
       number("sway", Unit::angle, "0 rad", 0, "All joints swing by this about where they stand, once a second (slides: 100 mm per radian)."),
       table("gait", &gait_table(), "It walks."),
       range(of(Kind::integer, "apart", Unit::none, "2", "Bodies with no more joints than this between them pass through each other."), 1, 100),
       blocks("joints", &joint_table(), "Where joints stand; others as near to zero as their limits allow."),
       blocks("override", &link_table(), "What is soft, what has another colour.")}};
  return t;
}

void set_robot_reader(RobotReader r) { reader() = std::move(r); }

void expand_robot(Node& root, const std::string& path, const std::string& folder, const ParamTable& root_table, Diagnostics& errors) {
  const auto entry = std::find_if(root.entries.begin(), root.entries.end(), [](const auto& e) { return e.first == "robot"; });
  if (entry == root.entries.end()) return;
  const Node written = std::move(entry->second);
  root.entries.erase(entry);
  const SourceLoc at = written.key_at;
  Checker checker(errors, folder);
  const Params block = checker.table(robot_table(), written, "robot");
  if (errors.empty())
    if (const Params* joints = block.find("joints"))
      for (const Params& j : joints->items())
        if (j.has("angle") == j.has("travel")) errors.add(j.where(), "robot.joints: give the joint an angle, or a travel");
  if (errors.empty())
    if (const Params* links = block.find("override"))
      for (const Params& l : links->items())
        for (const char* key : {"youngs_modulus", "poisson_ratio", "edge_length"})
          if (l.text("type") != "soft" && l.has(key))
            errors.add(l.at(key).where(), std::string("robot.override: only soft links have '") + key + "'", "type: soft");
  if (!errors.empty()) return;
  if (!reader()) {
    errors.add(at, "this program reads no files of robots");
    return;
  }
  std::string text;
  try {
    text = reader()(block, path);
  } catch (const Error& e) {
    if (e.located() || e.code() == Exit::file) throw;
    errors.add(at, e.what());
    return;
  }
  Node under = parse_yaml(text, "", &at);
  merge(under, root, root_table);
  under.at = root.at, under.key_at = root.key_at;
  root = std::move(under);
}

}  // namespace mortise::scene
