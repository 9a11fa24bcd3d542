#include "bridge/state.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/json_text.h"
#include "effects/tie_name.h"
#include "geometry/rigid_motion.h"

namespace mortise::bridge {
namespace {

using Json = nlohmann::ordered_json;

Json of(const Vec3& v) { return {v[0], v[1], v[2]}; }

bool ends_with(const std::string& s, const char* tail) { return s.size() > 2 && s.compare(s.size() - 2, 2, tail) == 0; }

}  // namespace

State::State(const model::ModelInput& input, const sensors::Sensors& sensors) : sensors_(sensors) {
  std::size_t first = 0;
  for (const model::BodyInput& b : input.bodies) {
    if (b.type == model::BodyType::stiff) bodies_.push_back({b.name, b.nodes, first, geometry::Placement(b.params)});
    first += b.nodes.size();
  }
  if (const Params* joints = input.scene.at("effects").find("joint"))
    for (const Params& j : joints->items()) joints_.push_back(effects::tie_name(j));
}

std::string State::hello(const Facts& f, const std::vector<Drive>& drives) const {
  Json j{{"hello", "mortise"},       {"protocol", 1},
         {"scene", f.scene},         {"episode", f.episode},
         {"time_step", f.time_step}, {"control_step", f.time_step * static_cast<double>(f.every)},
         {"steps", f.steps},         {"step", f.step}};
  if (f.environment >= 0) j["environment"] = f.environment;
  j["drives"] = Json::object();
  for (const Drive& d : drives) {
    Json& drive = j["drives"][d.joint] = {{"mode", d.mode_name()}, {"unit", d.unit()}};
    if (std::isfinite(d.low)) drive["limits"] = {d.low, d.high};
  }
  j["sensors"] = Json::object();
  for (const sensors::Sensor& s : sensors_.all())
    j["sensors"][s.name()] = {{"body", s.body()}, {"rows", s.spec().rows}, {"columns", s.spec().columns}};
  j["poses"] = Json::array();
  for (const Body& b : bodies_) j["poses"].push_back(b.name);
  return json_text(j);
}

std::string State::line(long step, double time, const Snapshot& said, const std::vector<double>& points,
                        const std::vector<sensors::Reading>& readings) const {
  Json j{{"step", step}, {"time", time}};
  // All numbers that effects report of a joint, under the names of the fields; x, y and z as one vector.
  Json& joints = j["joints"] = Json::object();
  for (const std::string& name : joints_) joints[name] = Json::object();
  for (const auto& [key, value] : said.number) {
    const std::string group = group_of(key), leaf = leaf_of(key);
    if (group != "joint" && group != "drive") continue;
    const std::string* joint = nullptr;
    for (const std::string& name : joints_)
      if (leaf.size() > name.size() && leaf.compare(0, name.size(), name) == 0 && leaf[name.size()] == '_' && (!joint || name.size() > joint->size()))
        joint = &name;
    if (!joint) continue;
    const std::string what = leaf.substr(joint->size() + 1);
    const bool vector = ends_with(what, "_x") || ends_with(what, "_y") || ends_with(what, "_z");
    if (vector) {
      // Beside the torque of its motor a slide has a force, and both are "force": the pull of the joint as a whole is its reaction.
      const std::string stem = what.substr(0, what.size() - 2);
      Json& v = joints[*joint][stem == "place" || stem == "guide" ? stem : "reaction_" + stem];
      if (v.is_null()) v = {0.0, 0.0, 0.0};
      v[static_cast<std::size_t>(what.back() - 'x')] = value;
    } else {
      joints[*joint][what] = value;
    }
  }
  Json& sensors = j["sensors"] = Json::object();
  for (std::size_t i = 0; i < readings.size(); ++i) {
    const sensors::Reading& r = readings[i];
    sensors[sensors_.all()[i].name()] = {{"force", of(r.wrench_force)},
                                         {"moment", of(r.wrench_moment)},
                                         {"pressure", r.pressure},
                                         {"shear", r.shear},
                                         {"displacement", r.displacement}};
  }
  Json& poses = j["poses"] = Json::object();
  for (const Body& b : bodies_) {
    std::vector<Vec3> now;
    for (std::size_t i = b.first; i < b.first + b.rest.size(); ++i) now.emplace_back(points[3 * i], points[3 * i + 1], points[3 * i + 2]);
    const geometry::Motion m = geometry::nearest_motion(b.rest, now);
    const Eigen::Quaterniond q(Mat3(m.R * b.placed.R));
    const double sign = q.w() < 0 ? -1 : 1;
    poses[b.name] = {{"position", of(m.R * b.placed.t + m.t)}, {"quaternion", {sign * q.w(), sign * q.x(), sign * q.y(), sign * q.z()}}};
  }
  return json_text(j);
}

}  // namespace mortise::bridge
