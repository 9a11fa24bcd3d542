#include "sensors/sensors.h"

#include "base/complaints.h"

namespace mortise::sensors {

Sensors::Sensors(const model::ModelInput& input) {
  const Params* wanted = input.scene.find("sensors");
  if (!wanted) return;
  Complaints wrong;
  for (const auto& [name, p] : wanted->entries()) {
    Index first = 0;
    for (const model::BodyInput& body : input.bodies) {
      if (body.name == p.text("body")) wrong.gather([&] { sensors_.emplace_back(name, p, input, body, first); });
      first += static_cast<Index>(body.nodes.size());
    }
  }
  wrong.raise();
}

std::vector<Reading> Sensors::read(Snapshot& state, const std::vector<double>& points) const {
  const auto forces = [&](const char* name) {
    const Snapshot::Values* v = state.of_points(name, 3);
    return v ? *v : Snapshot::Values{};
  };
  const Snapshot::Values contact = forces("contact_force"), friction = forces("friction_force");
  std::vector<Reading> readings;
  for (const Sensor& s : sensors_) {
    const Reading r = s.read(points, contact, friction);
    readings.push_back(r);
    const std::string group = "sensor_" + s.name();
    state.rows(group, "pressure", "Pa", 1, r.pressure);
    state.rows(group, "shear", "Pa", 2, r.shear);
    state.rows(group, "force", "N", 3, r.force);
    state.rows(group, "displacement", "m", 3, r.displacement);
    state.rows(group, "area", "m^2", 1, r.area);
    for (int k = 0; k < 3; ++k) {
      const std::string axis = std::string("_") + "xyz"[k];
      state.scalar(group, "wrench_force" + axis, "N", r.wrench_force[k]);
      state.scalar(group, "wrench_moment" + axis, "N m", r.wrench_moment[k]);
      state.scalar(group, "origin" + axis, "m", r.frame.origin[k]);
      for (int i = 0; i < 3; ++i) state.scalar(group, std::string("axis_") + "xyz"[k] + "_" + "xyz"[i], "1", r.frame.axes(i, k));
    }
  }
  return readings;
}

}  // namespace mortise::sensors
