#include "importers/robot_block.h"

#include <filesystem>
#include <iostream>
#include <set>

#include "base/read_file.h"
#include "base/sha256.h"
#include "geometry/cache_folder.h"
#include "importers/import.h"

namespace fs = std::filesystem;

namespace mortise::importers {
namespace {

// By what the robot's file says and where it is: two robots of one name keep their meshes apart.
std::string mesh_folder(const std::string& robot) {
  fs::path cache = geometry::cache_folder();
  if (cache.empty()) cache = fs::temp_directory_path();
  return (cache / ("robot_" + sha256(fs::absolute(robot).string() + "\n" + read_regular_file(robot, max_bytes::scene)).substr(0, 16))).string();
}

}  // namespace

std::string scene_of_robot(const Params& block, const std::string& path) {
  Request r;
  r.robot = block.text("file"), r.target = path, r.command = "robot: {file: " + r.robot + "}";
  r.meshes.skip_missing = block.text("missing_meshes") == "skip";
  r.meshes.folder = mesh_folder(r.robot);
  r.meshes.where = [](const std::string& p) { return "\n  robot.packages: [{name: " + p + ", folder: FOLDER}] says where the package is"; };
  r.meshes.skip_hint = "\n  robot.missing_meshes: skip goes on without them";
  const fs::path folder = fs::absolute(path).parent_path();
  if (const Params* packages = block.find("packages"))
    for (const Params& p : packages->items()) r.meshes.packages[p.text("name")] = (folder / p.text("folder")).lexically_normal().string();
  MachineOptions& m = r.machine;
  m.asked_soft = "robot.override: link ", m.asked_joint = "robot.joints: ";
  m.held = block.text("base") == "fixed", m.clearance = block.number("clearance"), m.sway = block.number("sway");
  if (const Params* g = block.find("gait")) {
    const auto given = [&](const char* key) { return g->has(key) ? std::optional<double>(g->number(key)) : std::nullopt; };
    m.gait = {g->text("type"), given("period"), given("stride"), given("clearance"), given("duty"), "robot.gait: "};
  }
  m.apart = static_cast<int>(block.integer("apart"));
  if (const Params* joints = block.find("joints"))
    for (const Params& j : joints->items())
      m.stands.push_back(j.has("angle") ? Stand{j.text("joint"), j.number("angle"), Stand::As::angle}
                                        : Stand{j.text("joint"), j.number("travel"), Stand::As::length});
  if (const Params* links = block.find("override"))
    for (const Params& l : links->items()) {
      if (l.has("color")) m.colours.emplace_back(l.text("link"), l.vec3("color"));
      if (l.text("type") != "soft") continue;
      SoftLink& s = m.soft.emplace_back(l.text("link"));
      if (l.has("youngs_modulus")) s.youngs_modulus = l.number("youngs_modulus");
      if (l.has("poisson_ratio")) s.poisson_ratio = l.number("poisson_ratio");
      if (l.has("edge_length")) s.edge_length = l.number("edge_length");
    }
  Notes notes;
  std::string text = import_scene(r, notes);
  static std::set<std::string> told;  // a scene may be read several times
  for (const std::string& line : notes.lines())
    if (told.insert(line).second) std::cerr << line << "\n";
  return text;
}

}  // namespace mortise::importers
