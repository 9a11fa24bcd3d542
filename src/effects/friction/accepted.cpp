#include "effects/friction/accepted.h"

#include "effects/per_environment.h"

namespace mortise::effects::friction {

Accepted::Accepted(const model::Model& model)
    : model_(model), env_offset_(model.envs + 1, 0), power_(model.envs, 0.0), dissipated_(model.envs, 0.0) {}

void Accepted::take(const StepInfo& info, const Slips& of, const device::Buffer<ContactSample>& samples, const std::vector<Index>& env_offset,
                    const std::vector<double>& dt, Positions q) {
  std::vector<Rub> rubs = measure(of, q);
  for (Index e = 0; e < model_.envs; ++e) {
    if (!info.taken_by(e)) continue;
    double step = 0;
    for (Index i = env_offset[e]; i < env_offset[e + 1]; ++i) step -= rubs[i].force.dot(rubs[i].slip);
    dissipated_[e] += step;
    power_[e] = dt[e] > 0 ? step / dt[e] : 0;
  }
  if (info.whose.empty()) {
    samples_.copy_from(samples);
    rubs_ = std::move(rubs), env_offset_ = env_offset;
    return;
  }
  const std::vector<ContactSample> old = samples_.download(), now = samples.download();
  std::vector<ContactSample> all;
  std::vector<Rub> all_rubs;
  std::vector<Index> offset{0};
  for (Index e = 0; e < model_.envs; ++e) {
    const bool taken = info.taken_by(e);
    const std::vector<Index>& range = taken ? env_offset : env_offset_;
    for (Index i = range[e]; i < range[e + 1]; ++i) all.push_back(taken ? now[i] : old[i]), all_rubs.push_back(taken ? rubs[i] : rubs_[i]);
    offset.push_back(static_cast<Index>(all.size()));
  }
  samples_.upload(all);
  rubs_ = std::move(all_rubs), env_offset_ = std::move(offset);
}

void Accepted::report(const FieldSinks& sinks) const {
  const std::vector<ContactSample> samples = samples_.download();
  const std::vector<Index> body = model_.surface.body.download();
  std::vector<double> point_force(3 * model_.points, 0.0);
  std::vector<Vec3> resultant(model_.bodies.size(), Vec3::Zero());
  struct Rows {
    std::vector<double> force, slip, traction, normal_force, sticks;
  };
  std::vector<Rows> rows(model_.envs);
  for (Index e = 0; e < model_.envs; ++e) {
    auto& [force, slip, traction, normal_force, sticks] = rows[e];
    for (Index i = env_offset_[e]; i < env_offset_[e + 1]; ++i) {
      const ContactSample& s = samples[i];
      const Rub& rub = rubs_[i];
      const double sign = model::against_obstacle(s) ? 1 : -1;
      for (Index k = 0; k < s.points; ++k) {
        const Vec3 f = sign * s.weight[k] * rub.force;
        for (int c = 0; c < 3; ++c) point_force[3 * s.point[k] + c] += f[c];
        resultant[body[s.point[k]]] += f;
      }
      for (int c = 0; c < 3; ++c) {
        force.push_back(rub.force[c]), slip.push_back(rub.slip[c]);
        traction.push_back(s.area != 0 ? rub.force[c] / s.area : 0);
      }
      normal_force.push_back(s.force), sticks.push_back(rub.sticks ? 1 : 0);
    }
  }
  report_points(sinks, model_, "friction_force", "N", 3, point_force);
  for (Index e = 0; e < sinks.size(); ++e) {
    sinks[e].rows("friction", "force", "N", 3, rows[e].force);
    sinks[e].rows("friction", "slip", "m", 3, rows[e].slip);
    sinks[e].rows("friction", "traction", "Pa", 3, rows[e].traction);
    sinks[e].rows("friction", "normal_force", "N", 1, rows[e].normal_force);
    sinks[e].rows("friction", "sticks", "1", 1, rows[e].sticks);
  }
  sinks.scalar("friction", "power", "W", power_);
  sinks.scalar("friction", "dissipation", "J", dissipated_);
  for (std::size_t b = 0; b < model_.bodies.size(); ++b)
    for (int c = 0; c < 3; ++c)
      sinks[model_.bodies[b].env].scalar("friction", "force_" + model_.bodies[b].name + "_" + "xyz"[c], "N", resultant[b][c]);
}

void Accepted::checkpoint(Archive& archive) { archive.io("friction.dissipated", dissipated_, one_each(model_.envs)); }

}  // namespace mortise::effects::friction
