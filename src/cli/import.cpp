// mortise import: a robot's file becomes a scene.
#include "importers/import.h"

#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>

#include "cli/commands.h"
#include "engine/effect_tables.h"
#include "geometry/io/write.h"
#include "scene/quantity.h"
#include "scene/robot.h"

namespace mortise::cli {
namespace {

namespace fs = std::filesystem;

struct ImportOptions {
  std::string robot, output, base = "free", missing = "error";
  std::vector<std::string> packages, joints, soft;
  double clearance = 2e-3;
  std::string sway, gait;
  int apart = 2;
  bool overwrite = false;
};

std::pair<std::string, std::string> split(const std::string& flag, const std::string& text) {
  const std::size_t at = text.find('=');
  if (at == 0 || at == std::string::npos || at + 1 == text.size()) throw Error(Exit::usage, flag + " " + text + ": must be NAME=VALUE");
  return {text.substr(0, at), text.substr(at + 1)};
}

// "0.9", "50 deg", "20 mm".
importers::Stand stand(const std::string& joint, const std::string& text) {
  using As = importers::Stand::As;
  const scene::Quantity q = scene::parse_quantity(text, Unit::any);
  if (!q.error.empty()) throw Error(Exit::usage, "--joint " + joint + " " + q.error);
  const bool angle = scene::parse_quantity(text, Unit::angle).error.empty(), length = scene::parse_quantity(text, Unit::length).error.empty();
  if (!angle && !length) throw Error(Exit::usage, "--joint " + joint + "=" + text + ": must be an angle or a length");
  return {joint, q.value, angle && length ? As::any : angle ? As::angle : As::length};
}

// What --overwrite may replace: a scene, and nothing that it is made of.
void check_replaced(const ImportOptions& o) {
  std::error_code ignored;
  if (o.output == "-" || !fs::exists(o.output, ignored)) return;
  if (!o.overwrite) throw Error(Exit::usage, "'" + o.output + "' exists already; --overwrite replaces it");
  std::ifstream file(o.output);
  for (std::string line; std::getline(file, line);)
    if (line.rfind("mortise:", 0) == 0) return;
  throw Error(Exit::usage, "'" + o.output + "' is no scene: --overwrite replaces no other file");
}

double sway(const std::string& text) {
  const scene::Quantity q = scene::parse_quantity(text, Unit::angle);
  if (!q.error.empty()) throw Error(Exit::usage, "--sway " + q.error + (q.hint.empty() ? "" : "\n  " + q.hint));
  if (q.value < 0) throw Error(Exit::usage, "--sway must not be below zero");
  return q.value;
}

std::string command_line(const ImportOptions& o) {
  const auto word = [](const std::string& s) { return s.find_first_of(" *?$'\"\\&;|<>()") == std::string::npos ? s : "'" + s + "'"; };
  std::string out = "mortise import " + word(fs::path(o.robot).filename().string());
  for (const std::string& j : o.joints) out += " --joint " + word(j);
  for (const std::string& s : o.soft) out += " --soft " + word(s);
  if (!o.sway.empty()) out += " --sway " + word(o.sway);
  if (!o.gait.empty()) out += " --gait " + o.gait;
  if (o.base != "free") out += " --base " + o.base;
  if (o.missing != "error") out += " --missing-meshes " + o.missing;
  return out;
}

int cmd_import(const ImportOptions& o) {
  using namespace importers;
  const bool to_file = o.output != "-";
  check_replaced(o);
  Request r;
  for (const std::string& p : o.packages) r.meshes.packages.insert(split("--package", p));
  r.meshes.skip_missing = o.missing == "skip";
  const fs::path target = to_file ? fs::path(o.output) : fs::path(o.robot).filename().replace_extension(".yaml");
  r.meshes.folder = (target.parent_path() / (target.stem().string() + "_meshes")).string();
  r.robot = o.robot, r.target = target.string(), r.command = command_line(o);
  for (const std::string& j : o.joints) {
    const auto [name, value] = split("--joint", j);
    r.machine.stands.push_back(stand(name, value));
  }
  if (!o.sway.empty()) r.machine.sway = sway(o.sway);
  r.machine.gait.type = o.gait;
  r.machine.soft.assign(o.soft.begin(), o.soft.end());
  r.machine.held = o.base == "fixed", r.machine.clearance = o.clearance, r.machine.apart = o.apart;

  Notes notes;
  const std::string text = import_scene(r, notes);
  for (const std::string& line : notes.lines()) std::cerr << line << "\n";
  const scene::Scene scene = scene::read_scene_text(text, target.string(), {}, engine::effect_tables());
  if (!to_file) {
    std::cout << text;
    return 0;
  }
  if (const fs::path folder = target.parent_path(); !folder.empty()) fs::create_directories(folder);
  geometry::write_file(o.output, text);
  std::cout << o.output << ": " << scene.root.at("bodies").entries().size() << " bodies; try: mortise run " << o.output << "\n";
  return 0;
}

}  // namespace

void add_import(Command app, Context& context) {
  const Command sub = app.command("import", "turn a robot's file, URDF or MJCF, into a scene that runs");
  auto o = std::make_shared<ImportOptions>();
  sub.option("robot", o->robot, "URDF or MJCF file").required();
  sub.option("-o,--output", o->output, "scene file to write; - writes to the standard output").required();
  sub.option("--package", o->packages, "NAME=FOLDER where package://NAME is; without it beside or above the robot's file, and ROS_PACKAGE_PATH")
      .one_each()
      .take_all();
  sub.option("--joint", o->joints, "NAME=VALUE where a joint stands: '*_calf_joint=-1.8', elbow='50 deg'; * and ? match any; the right-most wins")
      .one_each()
      .take_all();
  sub.option("--soft", o->soft, "LINK becomes a soft pad bonded to what it is fixed to; * and ? match any: '*_foot'").one_each().take_all();
  sub.option("--sway", o->sway,
             "all joints swing by this about where they stand, once a second: '10 deg' (slides: 100 mm per radian), within their limits");
  sub.option("--gait", o->gait, "walk, trot, pace or bound: four legs step in turn, along x; mortise effects drive explains the numbers")
      .one_of(scene::kGaits);
  sub.option("--base", o->base,
             "free or fixed: bodies that move freely and have joints below them are held; a root link called world, and what MJCF fixes to its "
             "world, never moves")
      .one_of({"free", "fixed"})
      .show_default();
  sub.option("--missing-meshes", o->missing, "error, or skip: go on without them").one_of({"error", "skip"}).show_default();
  sub.option("--clearance", o->clearance, "of the lowest point above the floor [m]").positive().show_default();
  sub.option("--apart", o->apart, "bodies with no more joints than this between them pass through each other").within(1, 100).show_default();
  sub.flag("--overwrite", o->overwrite, "replace the scene file");
  sub.footer(
      "Examples:\n  mortise import arm.urdf -o arm.yaml --base fixed\n"
      "  mortise import go2.urdf -o go2.yaml --missing-meshes skip --joint '*_thigh_joint=0.9' --joint '*_calf_joint=-1.8' --soft FL_foot\n"
      "  mortise import gripper.xml -o gripper.yaml --base fixed --missing-meshes skip\n"
      "  mortise import go2.urdf -o trot.yaml --missing-meshes skip --soft '*_foot' --gait trot\n"
      "  mortise import robot.urdf -o - --sway '10 deg' | mortise run - -o out/robot       a moving robot and its pictures");
  sub.action([o, &context] { context.action = [o] { return cmd_import(*o); }; });
}

}  // namespace mortise::cli
