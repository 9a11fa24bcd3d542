#include "sensors/sensors.h"

#include "base/pass_on.h"

namespace mortise::sensors {

class Sensors::Watch : public PassOn {
 public:
  using PassOn::PassOn;
  void points(std::string_view name, std::string_view unit, int components, std::span<const double> values) override {
    PassOn::points(name, unit, components, values);
    if (name == "contact_force") contact.assign(values.begin(), values.end());
    if (name == "friction_force") friction.assign(values.begin(), values.end());
  }
  std::vector<double> contact, friction;  // 3 per point [N]
};

Sensors::Sensors(const model::ModelInput& input) {
  const Params* wanted = input.scene.find("sensors");
  if (!wanted) return;
  for (const auto& [name, p] : wanted->entries()) {
    Index first = 0;
    for (const model::BodyInput& body : input.bodies) {
      if (body.name == p.text("body")) sensors_.emplace_back(name, p, input, body, first);
      first += static_cast<Index>(body.nodes.size());
    }
  }
}

Sensors::~Sensors() = default;

FieldSink* Sensors::watch(FieldSink* next) {
  if (empty()) return next;
  next_ = next;
  watch_ = std::make_unique<Watch>(next);
  return watch_.get();
}

void Sensors::finish(const std::vector<double>& points) {
  if (empty()) return;
  readings_.clear();
  for (const Sensor& s : sensors_) {
    const Reading r = s.read(points, watch_->contact, watch_->friction);
    readings_.push_back(r);
    if (!next_) continue;
    const std::string group = "sensor_" + s.name();
    next_->rows(group, "pressure", "Pa", 1, r.pressure);
    next_->rows(group, "shear", "Pa", 2, r.shear);
    next_->rows(group, "force", "N", 3, r.force);
    next_->rows(group, "displacement", "m", 3, r.displacement);
    next_->rows(group, "area", "m^2", 1, r.area);
    for (int k = 0; k < 3; ++k) {
      const std::string axis = std::string("_") + "xyz"[k];
      next_->scalar(group, "wrench_force" + axis, "N", r.wrench_force[k]);
      next_->scalar(group, "wrench_moment" + axis, "N m", r.wrench_moment[k]);
      next_->scalar(group, "origin" + axis, "m", r.frame.origin[k]);
      for (int i = 0; i < 3; ++i) next_->scalar(group, std::string("axis_") + "xyz"[k] + "_" + "xyz"[i], "1", r.frame.axes(i, k));
    }
  }
}

}  // namespace mortise::sensors
