#include "effects/contact/report.h"

#include <cmath>

namespace mortise::effects::contact {

PointForces::PointForces(const model::Model& model)
    : model_(model),
      body_(model.surface.body.download()),
      force_(3 * static_cast<std::size_t>(model.points), 0.0),
      resultant_(model.bodies.size(), Vec3::Zero()) {}

void PointForces::add(Index point, const Vec3& force) {
  for (int c = 0; c < 3; ++c) force_[3 * point + c] += force[c];
  resultant_[body_[point]] += force;
}

double PointForces::size(Index point) const { return std::hypot(force_[3 * point], force_[3 * point + 1], force_[3 * point + 2]); }

void PointForces::report(FieldSink& sink, std::string_view group) const {
  sink.points("contact_force", "N", 3, force_);
  for (std::size_t b = 0; b < model_.bodies.size(); ++b)
    for (int c = 0; c < 3; ++c) sink.scalar(group, "force_" + model_.bodies[b].name + "_" + "xyz"[c], "N", resultant_[b][c]);
}

void SampleRows::add(const model::ContactSample& s) {
  position_.insert(position_.end(), s.position, s.position + 3);
  normal_.insert(normal_.end(), s.normal, s.normal + 3);
  force_.push_back(s.force), area_.push_back(s.area), gap_.push_back(s.gap), pressure_.push_back(s.pressure);
  bodies_.push_back(s.body_a), bodies_.push_back(s.body_b);
}

void SampleRows::report(FieldSink& sink, std::string_view group) const {
  sink.rows(group, "position", "m", 3, position_);
  sink.rows(group, "normal", "1", 3, normal_);
  sink.rows(group, "force", "N", 1, force_);
  sink.rows(group, "area", "m^2", 1, area_);
  sink.rows(group, "gap", "m", 1, gap_);
  sink.rows(group, "pressure", "Pa", 1, pressure_);
  sink.rows(group, "bodies", "1", 2, bodies_);
}

}  // namespace mortise::effects::contact
