#include "effects/contact/report.h"

#include <algorithm>
#include <cmath>

#include "effects/per_environment.h"

namespace mortise::effects::contact {
namespace {

Vec3 vec(const double v[3]) { return {v[0], v[1], v[2]}; }
void append(std::vector<double>& to, const Vec3& v) { to.insert(to.end(), v.data(), v.data() + 3); }

}  // namespace

PointForces::PointForces(const model::Model& model, const device::Buffer<Vec3>& y)
    : model_(model),
      body_(model.surface.body.download()),
      y_(y.download()),
      force_(3 * static_cast<std::size_t>(model.points), 0.0),
      resultant_(model.bodies.size(), Vec3::Zero()) {}

void PointForces::add(Index point, const Vec3& force, Index from) {
  for (int c = 0; c < 3; ++c) force_[3 * point + c] += force[c];
  resultant_[body_[point]] += force;
  if (body_[point] >= from) return;  // the pair's second body, or contact of a body with itself
  Wrench& w = pairs_[{body_[point], from}];
  w.force += force;
  w.moment += y_[point].cross(force);
}

Vec3 PointForces::on_first(const BodyPair& pair) const {
  const auto it = pairs_.find(pair);
  return it == pairs_.end() ? Vec3(0, 0, 0) : it->second.force;
}

void PointForces::report(const FieldSinks& sinks, std::string_view group) const {
  report_points(sinks, model_, "contact_force", "N", 3, force_);
  for (std::size_t b = 0; b < model_.bodies.size(); ++b)
    for (int c = 0; c < 3; ++c) sinks[model_.bodies[b].env].scalar(group, "force_" + model_.bodies[b].name + "_" + "xyz"[c], "N", resultant_[b][c]);
  auto next = pairs_.begin();  // ordered by their first body, and so by environment
  for (Index e = 0; e < sinks.size(); ++e) {
    std::vector<double> bodies, force, moment;
    for (; next != pairs_.end() && model_.bodies[next->first.first].env == e; ++next) {
      const auto& [pair, w] = *next;
      bodies.push_back(model_.number_alone(pair.first, e)), bodies.push_back(model_.number_alone(pair.second, e));
      append(force, w.force), append(moment, w.moment);
    }
    sinks[e].rows(group, "pair_bodies", "1", 2, bodies);
    sinks[e].rows(group, "pair_force", "N", 3, force);
    sinks[e].rows(group, "pair_moment", "N m", 3, moment);
  }
}

void SampleRows::add(const model::ContactSample& s) {
  append(position_, vec(s.position)), append(normal_, vec(s.normal));
  force_.push_back(s.force), area_.push_back(s.area), gap_.push_back(s.gap), pressure_.push_back(s.pressure);
  bodies_.push_back(model_->number_alone(s.body_a, env_)), bodies_.push_back(model_->number_alone(s.body_b, env_));
  if (s.body_a == s.body_b) return;
  // The normal points at the second body, or, against an obstacle that does not move, at the first.
  const bool away = model::against_obstacle(s) == (s.body_a < s.body_b);
  Sum& sum = sums_[{std::min(s.body_a, s.body_b), std::max(s.body_a, s.body_b)}];
  sum.force += (away ? s.force : -s.force) * vec(s.normal);
  sum.size += std::abs(s.force);
}

void SampleRows::report(FieldSink& sink, std::string_view group, const std::string& prefix) const {
  sink.rows(group, prefix + "position", "m", 3, position_);
  sink.rows(group, prefix + "normal", "1", 3, normal_);
  sink.rows(group, prefix + "force", "N", 1, force_);
  sink.rows(group, prefix + "area", "m^2", 1, area_);
  sink.rows(group, prefix + "gap", "m", 1, gap_);
  sink.rows(group, prefix + "pressure", "Pa", 1, pressure_);
  sink.rows(group, prefix + "bodies", "1", 2, bodies_);
}

double sum_defect(const PointForces& forces, const std::vector<const SampleRows*>& samples) {
  std::map<BodyPair, SampleRows::Sum> sums;
  for (const SampleRows* rows : samples)
    for (const auto& [pair, sum] : rows->sums()) sums[pair].force += sum.force, sums[pair].size += sum.size;
  double worst = 0;
  for (const auto& [pair, sum] : sums)
    if (sum.size > 0) worst = std::max(worst, (sum.force - forces.on_first(pair)).norm() / sum.size);
  return worst;
}

}  // namespace mortise::effects::contact
