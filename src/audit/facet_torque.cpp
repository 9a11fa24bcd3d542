#include "audit/facet_torque.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "audit/entries.h"
#include "audit/holds.h"
#include "audit/shape_defect.h"
#include "audit/tuning.h"
#include "audit/vector_at.h"
#include "effects/contact/layer.h"
#include "effects/roles.h"
#include "effects/tie_name.h"

namespace mortise::audit {

FacetTorque::FacetTorque(const model::ModelInput& input) {
  const Params& effects = input.scene.at("effects");
  const Holds holds(effects);
  const auto layer = [&] {
    double d_hat = INFINITY;
    for (const std::string& contact : effects::of_role(effects, effects::Role::contact))
      d_hat = std::min(d_hat, effects::contact::support_radius(effects.at(contact), input));
    return d_hat;
  };
  std::size_t number = 0;
  for (const model::BodyInput& body : input.bodies) {
    if (body.type == model::BodyType::half_space) continue;
    for (const Vec3& x : body.nodes) start_.insert(start_.end(), x.data(), x.data() + 3);
    const std::size_t own = number++;
    const Params* shape = body.params.find("shape");
    if (body.type != model::BodyType::stiff || !shape || round_volume(*shape) == 0) continue;
    for (const Params& joint : entries(effects, "joint")) {
      const bool on_it = joint.text("body") == body.name || (joint.has("to") && joint.text("to") == body.name);
      const std::string name = effects::tie_name(joint);
      if (!on_it || joint.text("type") != "revolute" || holds.driven(name) != Holds::Driven::yes) continue;
      const Params& round = shape->entries().begin()->second;
      const double s = round.number("edge_length"), depth = s * s / (8 * round.number("radius"));
      wheels_.push_back({own, 0.5 * s * depth / (depth + tuning::kEvens * layer()), "drive/" + name + "_torque", joint.vec3("axis").normalized()});
    }
  }
  off_.assign(wheels_.size(), 0.0), torque_ = off_, last_ = off_;
}

void FacetTorque::state(const Snapshot& said, const std::vector<double>& points, const std::vector<MovingBody>& bodies) {
  const Snapshot::Values* contact = said.of_points("contact_force", 3);
  if (bodies.empty() || !contact) return;
  for (std::size_t i = 0; i < wheels_.size(); ++i) {
    const Wheel& wheel = wheels_[i];
    const MovingBody& body = bodies[wheel.body];
    const double torque = std::fmax(std::abs(said.at(wheel.torque)), 0.0);
    torque_[i] = std::max(torque_[i], std::min(torque, std::exchange(last_[i], torque)));
    if (!body.touches || (body.on && bodies[*body.on].body.soft())) continue;
    const Vec3 turned = body.body.rotation(start_, points);
    const double angle = turned.norm();
    const Vec3 axis = angle > 0 ? Vec3(Eigen::AngleAxisd(angle, turned / angle) * wheel.axis) : wheel.axis;
    double pressed = 0;
    for (std::size_t k = 0; k < body.body.count; ++k) pressed += at(*contact, body.body.first + k).cross(axis).norm();
    off_[i] = std::fmax(off_[i], wheel.off * pressed);
  }
}

void FacetTorque::checkpoint(Archive& archive) {
  archive.io("facet_torque.off", off_), archive.io("facet_torque.torque", torque_), archive.io("facet_torque.last", last_);
}

double FacetTorque::share() const {
  double most = NAN;
  for (std::size_t i = 0; i < wheels_.size(); ++i)
    if (off_[i] > 0 && torque_[i] > 0) most = std::fmax(most, off_[i] / torque_[i]);
  return most;
}

}  // namespace mortise::audit
