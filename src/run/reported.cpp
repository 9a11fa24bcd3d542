#include "run/reported.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <vector>

#include "audit/entries.h"
#include "base/complaints.h"
#include "base/error.h"
#include "effects/roles.h"
#include "effects/tie_name.h"
#include "geometry/bounds.h"
#include "run/tuning.h"
#include "scene/scene.h"
#include "scene/suggest.h"

namespace mortise::run {

namespace {

// What scalars of ties, motors, supports and balances end with.
const std::set<std::string>& ends() {
  static const std::set<std::string> all{"x",        "y",           "z",       "defect",  "force",   "torque",   "target",   "error",
                                         "power",    "drag",        "rate",    "angle",   "travel",  "stop",     "coupling", "beside",
                                         "error_mm", "mimic_error", "force_x", "force_y", "force_z", "moment_x", "moment_y", "moment_z",
                                         "place_x",  "place_y",     "place_z", "guide_x", "guide_y", "guide_z"};
  return all;
}

// One of these names, and such an end.
bool of_any(const std::string& leaf, const std::vector<std::string>& names) {
  return std::any_of(names.begin(), names.end(),
                     [&](const std::string& name) { return leaf.rfind(name + "_", 0) == 0 && ends().count(leaf.substr(name.size() + 1)) > 0; });
}

// What scalars of a group begin with that come only with a step: forces of ties and motors, of supports, and of balances.
std::vector<std::string> stems(const std::string& group, const Params& scene) {
  const Params& effects = scene.at("effects");
  std::vector<std::string> out;
  if (group == "supports")
    for (const auto& [name, body] : scene.at("bodies").entries()) out.push_back(name);
  if (group == "balance") {
    out = {"defect", "support"};
    for (const auto& [name, block] : effects.entries()) out.push_back(name);
  }
  using effects::Role;
  if (effects.has(group) && effects::has_role(group, Role::tie)) {
    out.emplace_back("tie");
    for (const Params& tie : audit::entries(effects, group.c_str())) out.push_back(effects::tie_name(tie));
  }
  if (effects.has(group) && effects::has_role(group, Role::motor))
    for (const Params& motor : audit::entries(effects, group.c_str())) out.push_back(motor.text("joint"));
  return out;
}

}  // namespace

bool may_report(const std::string& scalar, const Params& scene, const Snapshot& start) {
  if (start.has(scalar)) return true;
  const std::string group = group_of(scalar), leaf = leaf_of(scalar);
  static const std::set<std::string> always{"balance/largest", "balance/written_defect", "audit/total_energy"},
      of_motion{"supports/work", "supports/work_lag", "audit/support_work", "audit/largest_energy_gain"};
  if (of_motion.count(scalar)) return !effects::of_role(scene.at("effects"), effects::Role::inertia).empty();
  return always.count(scalar) > 0 || of_any(leaf, stems(group, scene));
}

void not_reported(const SourceLoc& where, const std::string& what, const std::string& scalar, const Params& scene, const Snapshot& said) {
  const std::string group = group_of(scalar);
  std::vector<std::string> known;
  std::set<std::string> of_group, groups{"supports"};
  for (const auto& [name, number] : said.number) {
    known.push_back(name), groups.insert(group_of(name));
    if (group_of(name) == group) of_group.insert(leaf_of(name));
  }
  for (const std::string& stem : stems(group, scene))
    for (const std::string& end : ends()) known.push_back(group + "/" + stem + "_" + end);
  std::string hint = scene::suggestion(scalar, known);
  const auto list = [](const std::set<std::string>& names) { return scene::join({names.begin(), names.end()}, ", "); };
  if (hint.empty()) hint = of_group.empty() ? "there are groups " + list(groups) : "of '" + group + "' there are " + list(of_group);
  throw Error(Exit::scene, where, what + ": nothing reports '" + scalar + "'; " + hint);
}

namespace {

// A quantity at a place of a body.
void check_place(const Params& q, const std::string& what, const std::vector<model::BodyInput>& bodies) {
  for (const model::BodyInput& b : bodies) {
    if (b.name != q.text("body") || b.nodes.empty()) continue;
    const Vec3 x = q.vec3("point");
    const auto box = geometry::bounds_of(b.nodes);
    const double beside = (x - x.cwiseMax(box.lo).cwiseMin(box.hi)).norm();
    if (beside > tuning::kOnBody * box.size().norm())
      throw Error(Exit::scene, q.at("point").where(), fmt::format("{}: the point lies {:.3g} m beside body '{}'", what, beside, b.name));
  }
}

// `what`: its path.
void check_quantity(const Params& q, const std::string& what, const model::ModelInput& input, const Snapshot& start) {
  const Params& scene = input.scene;
  const double ends = scene::end_time(scene);
  const std::string& value = q.text("value");
  if (q.has("point") && q.has("body")) check_place(q, what, input.bodies);
  if (const long every = scene.at("time").integer("frame_every"); q.text("when") == "sum" && group_of(value) != "steps" && every > 1)
    throw Error(Exit::scene, q.at("when").where(),
                fmt::format("{}: a sum is of all steps, and only one in {} has a frame; 'time.frame_every: 1' gives each one", what, every));
  if (q.has("at") && q.number("at") > ends * (1 + tuning::kRounding))
    throw Error(Exit::scene, q.at("at").where(), fmt::format("{}: {:g} s is after the end, at {:g} s", what, q.number("at"), ends));
  if (value.find('/') == std::string::npos || group_of(value) == "steps") return;
  if (start.row.count(value) && !start.has(value + "_x"))
    throw Error(Exit::scene, q.where(), what + ": '" + value + "' is a table, of which a run has one per frame; a quantity is a scalar");
  if (!may_report(value, scene, start) && !may_report(value + "_x", scene, start)) not_reported(q.where(), what, value, scene, start);
}

}  // namespace

void check_quantities(const model::ModelInput& input, const Snapshot& start) {
  Complaints wrong;
  const Params* list = input.scene.find("quantities");
  for (std::size_t i = 0; list && i < list->items().size(); ++i)
    wrong.gather([&] { check_quantity(list->items()[i], "quantities." + std::to_string(i), input, start); });
  const Params* checks = input.scene.find("checks");
  for (std::size_t i = 0; checks && i < checks->items().size(); ++i)
    if (const Params* value = checks->items()[i].find("value"); value && !may_report(value->as_text(), input.scene, start))
      wrong.gather([&] { not_reported(value->where(), fmt::format("checks.{}", i), value->as_text(), input.scene, start); });
  wrong.raise();
}

}  // namespace mortise::run
