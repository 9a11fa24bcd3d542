#include "solver/tie_forces.h"

#include <algorithm>
#include <map>

#include "effects/body_blocks.h"
#include "effects/per_environment.h"
#include "linalg/dense.h"

namespace mortise::solver {

TieForces::TieForces(const model::Model& model, const std::vector<Vec3>& q, std::vector<Vec3> gradient)
    : model_(model), of_(model.ties.list().size()), on_body_(model.bodies.size(), Vec3::Zero()), pull_(model.blocks, Vec3::Zero()) {
  const std::vector<double> position = effects::translation_weight(model);
  const std::vector<Vec3> rest = model.rest_points.download();
  std::vector<Index> body(model.blocks);
  std::vector<double> radius(model.bodies.size(), 0.0);
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const model::Body& b = model.bodies[i];
    std::fill(body.begin() + b.block_begin, body.begin() + b.block_end, static_cast<Index>(i));
    for (Index p = b.point_begin; p < b.point_end; ++p) radius[i] = std::max(radius[i], (rest[p] - b.centre).norm());
  }
  const auto at = [&](const model::Follow& f) {
    Vec3 x = f.fixed;
    for (const model::TieTerm& t : f.terms) x += t.weight * q[t.block];
    return x;
  };
  const std::vector<model::Tie>& ties = model.ties.list();
  for (std::size_t i = 0; i < ties.size(); ++i) {
    of_[i].place = at(ties[i].anchor);
    if (ties[i].driven()) of_[i].axis = at(ties[i].axis).normalized();
  }

  const auto pull = [&](std::size_t i, Index block, const Vec3& f) {
    pull_[block] += f;
    Figures& figures = of_[i];
    on_body_[body[block]] += position[block] * f;
    figures.on_all += position[block] * f;
    if (body[block] != ties[i].body) return;
    figures.force += position[block] * f;
    figures.moment += (q[block] - position[block] * figures.place).cross(f);
  };
  // The equation f of tie i holds its block with `force`, and hands on to those that it follows.
  const auto hold = [&](std::size_t i, const model::Follow& f, const Vec3& force) {
    gradient[f.block] -= force;
    pull(i, f.block, force);
    for (const model::TieTerm& t : f.terms) {
      gradient[t.block] += t.weight * force;
      pull(i, t.block, -t.weight * force);
    }
  };
  // Equations that close loops take first what the tree of ties would leave at the blocks that they give: (T^T (g - sum_e C_e lambda_e))_j = 0, with
  // T without these equations, so that T^T C_e is their row.
  const std::vector<model::Closing>& closings = model.ties.closings();
  if (const auto n = static_cast<Index>(closings.size()); n > 0) {
    std::vector<Vec3> folded = gradient;
    for (auto next = model.ties.order().rbegin(); next != model.ties.order().rend(); ++next) {
      const model::Follow& f = ties[next->first].follows[next->second];
      for (const model::TieTerm& t : f.terms) folded[t.block] += t.weight * folded[f.block];
    }
    linalg::DenseMatrix C(n, n), g(n, 3);
    for (Index j = 0; j < n; ++j) {
      for (int k = 0; k < 3; ++k) g(j, k) = folded[closings[j].pivot][k];
      for (Index e = 0; e < n; ++e)
        for (const model::TieTerm& t : closings[e].row)
          if (t.block == closings[j].pivot) C(j, e) = t.weight;
    }
    const linalg::DenseMatrix lambda = linalg::solve(C, g);
    for (Index e = 0; e < n; ++e) {
      const auto i = static_cast<std::size_t>(closings[e].tie);
      hold(i, ties[i].closes[closings[e].place], Vec3(lambda(e, 0), lambda(e, 1), lambda(e, 2)));
    }
  }
  const auto miss = [&](std::size_t i, const model::Follow& f) {
    of_[i].error = std::max(of_[i].error, (position[f.block] == 1 ? 1 : radius[body[f.block]]) * (q[f.block] - at(f)).norm());
  };
  for (std::size_t i = 0; i < ties.size(); ++i)
    for (const model::Follow& f : ties[i].closes) miss(i, f);
  const auto& order = model.ties.order();
  for (auto next = order.rbegin(); next != order.rend(); ++next) {
    const auto i = static_cast<std::size_t>(next->first);
    const model::Follow& f = ties[i].follows[next->second];
    hold(i, f, Vec3(gradient[f.block]));
    miss(i, f);
  }
}

Vec3 TieForces::of_effect(std::string_view effect, Index env) const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < of_.size(); ++i)
    if (model_.ties.list()[i].effect == effect && model_.bodies[model_.ties.list()[i].body].env == env) sum += of_[i].on_all;
  return sum;
}

// Of driven ties, about or along their axis. A joint that is given because another is goes with it, ratio times as far: what holds it there is, as
// power goes, ratio times as much for the motor of that one.
std::vector<double> TieForces::motors() const {
  std::vector<double> own(of_.size(), 0.0);
  for (std::size_t i = 0; i < of_.size(); ++i) {
    const model::Tie& tie = model_.ties.list()[i];
    if (tie.driven()) own[i] = (tie.slides ? of_[i].force : of_[i].moment).dot(of_[i].axis);
  }
  std::vector<double> out = own;
  for (const model::Joint& j : model_.joints) {
    double ratio = 1;
    if (model_.ties.list()[j.tie].driven())
      for (const model::Joint* at = &j; at->leader >= 0 && !at->mimics; at = &model_.joints[at->leader])
        ratio *= at->ratio, out[model_.joints[at->leader].tie] += ratio * own[j.tie];
  }
  return out;
}

void TieForces::report(const FieldSinks& sinks) const {
  std::vector<std::map<std::string, double>> error(model_.envs);
  bool any = false;
  std::vector<double> field(3 * static_cast<std::size_t>(model_.points), 0.0);
  const std::vector<double> motor = motors();
  for (std::size_t i = 0; i < of_.size(); ++i) {
    const model::Tie& tie = model_.ties.list()[i];
    const Index env = model_.bodies[tie.body].env;
    FieldSink& sink = sinks[env];
    for (const auto& [what, unit, v] : {std::tuple{"force", "N", of_[i].force}, {"moment", "N m", of_[i].moment}, {"place", "m", of_[i].place}})
      for (int k = 0; k < 3; ++k) sink.scalar(tie.effect, tie.name + "_" + what + "_" + "xyz"[k], unit, v[k]);
    if (tie.driven() && tie.slides) sink.scalar(tie.driver, tie.name + "_force", "N", motor[i]);
    if (tie.driven() && !tie.slides) sink.scalar(tie.driver, tie.name + "_torque", "N m", motor[i]);
    double& worst = error[env][tie.effect];
    worst = std::max(worst, of_[i].error);
    any = any || model_.bodies[tie.body].type == model::BodyType::soft;
  }
  for (const model::Body& body : model_.bodies)
    for (Index b = body.block_begin; b < body.block_end && body.type == model::BodyType::soft; ++b)
      for (int k = 0; k < 3; ++k) field[3 * static_cast<std::size_t>(body.point_begin + (b - body.block_begin)) + k] = pull_[b][k];
  for (Index e = 0; e < sinks.size(); ++e)
    for (const auto& [effect, worst] : error[e])
      sinks[e].scalar(effect, "tie_error", "m", worst), sinks[e].scalar(effect, "tie_error_mm", "mm", 1e3 * worst);
  if (any) effects::report_points(sinks, model_, "tie_force", "N", 3, field);
}

}  // namespace mortise::solver
