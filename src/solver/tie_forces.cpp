#include "solver/tie_forces.h"

#include <algorithm>
#include <map>
#include <utility>

#include "effects/body_blocks.h"
#include "effects/per_environment.h"
#include "linalg/dense.h"

namespace mortise::solver {

TieForces::TieForces(const model::Model& model, std::vector<Vec3> q, std::vector<Vec3> gradient)
    : model_(model),
      q_(std::move(q)),
      position_(effects::translation_weight(model)),
      body_(model.blocks),
      of_(model.ties.list().size()),
      on_body_(model.bodies.size(), Vec3::Zero()),
      pull_(model.blocks, Vec3::Zero()) {
  const std::vector<Vec3> rest = model.rest_points.download();
  std::vector<double> radius(model.bodies.size(), 0.0);
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const model::Body& b = model.bodies[i];
    std::fill(body_.begin() + b.block_begin, body_.begin() + b.block_end, static_cast<Index>(i));
    for (Index p = b.point_begin; p < b.point_end; ++p) radius[i] = std::max(radius[i], (rest[p] - b.centre).norm());
  }
  const std::vector<model::Tie>& ties = model.ties.list();
  for (std::size_t i = 0; i < ties.size(); ++i) {
    of_[i].place = place_of(ties[i].anchor);
    if (ties[i].driven()) of_[i].axis = place_of(ties[i].axis).normalized();
  }

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
      hold(i, ties[i].closes[closings[e].place], Vec3(lambda(e, 0), lambda(e, 1), lambda(e, 2)), gradient);
    }
  }
  const auto miss = [&](std::size_t i, const model::Follow& f) {
    of_[i].error = std::max(of_[i].error, (position_[f.block] == 1 ? 1 : radius[body_[f.block]]) * (q_[f.block] - place_of(f)).norm());
  };
  for (std::size_t i = 0; i < ties.size(); ++i)
    for (const model::Follow& f : ties[i].closes) miss(i, f);
  const auto& order = model.ties.order();
  for (auto next = order.rbegin(); next != order.rend(); ++next) {
    const auto i = static_cast<std::size_t>(next->first);
    const model::Follow& f = ties[i].follows[next->second];
    hold(i, f, Vec3(gradient[f.block]), gradient);
    miss(i, f);
  }
  guide(gradient);
}

Vec3 TieForces::place_of(const model::Follow& f) const {
  Vec3 x = f.fixed;
  for (const model::TieTerm& t : f.terms) x += t.weight * q_[t.block];
  return x;
}

void TieForces::pull(std::size_t i, Index block, const Vec3& force) {
  pull_[block] += force;
  Figures& figures = of_[i];
  on_body_[body_[block]] += position_[block] * force;
  figures.on_all += position_[block] * force;
  if (body_[block] != model_.ties.list()[i].body) return;
  figures.force += position_[block] * force;
  figures.moment += (q_[block] - position_[block] * figures.place).cross(force);
}

void TieForces::hold(std::size_t i, const model::Follow& f, const Vec3& force, std::vector<Vec3>& gradient) {
  gradient[f.block] -= force;
  pull(i, f.block, force);
  for (const model::TieTerm& t : f.terms) {
    gradient[t.block] += t.weight * force;
    pull(i, t.block, -t.weight * force);
  }
}

// Slides and ties take what sliders hand on in such an order that all that a block has to bear is there before it hands it on itself.
void TieForces::guide(const std::vector<Vec3>& folded) {
  const std::vector<model::Guided> slides = model::guided(model_);
  if (slides.empty()) return;
  handed_.assign(model_.blocks, Vec3::Zero());
  carried_.assign(model_.blocks, 0);
  const std::vector<Mat3> P = model_.projector.download();
  struct Link {
    const model::Guided* slide;  // or
    Index tie, place;            // an equation of a tie
    Index block;
    std::vector<Index> follows;
  };
  std::vector<Link> links;
  for (const model::Guided& g : slides) {
    Link link{&g, -1, -1, model_.bodies[g.slider].block_begin, {}};
    for (Index k = 0; k < 4 && g.carrier != model::Tie::kWorld; ++k) link.follows.push_back(model_.bodies[g.carrier].block_begin + k);
    links.push_back(std::move(link));
  }
  const auto& order = model_.ties.order();
  for (auto next = order.rbegin(); next != order.rend(); ++next) {
    const model::Follow& f = model_.ties.list()[next->first].follows[next->second];
    Link link{nullptr, next->first, next->second, f.block, {}};
    for (const model::TieTerm& t : f.terms) link.follows.push_back(t.block);
    links.push_back(std::move(link));
  }
  std::vector<int> awaited(model_.blocks, 0);
  for (const Link& link : links)
    for (Index b : link.follows) ++awaited[b];

  while (!links.empty()) {
    const std::size_t before = links.size();
    std::erase_if(links, [&](const Link& link) {
      if (awaited[link.block] > 0) return false;
      for (Index b : link.follows) --awaited[b];
      if (!link.slide) {
        hold(link.tie, model_.ties.list()[link.tie].follows[link.place], Vec3(handed_[link.block]), handed_);
        return true;
      }
      if (link.slide->carrier == model::Tie::kWorld) return true;  // what bears it is a support
      const Vec3 g = folded[link.block] + handed_[link.block], force = g - P[link.block] * g;
      const model::Joint& joint = model_.joints[link.slide->joint];
      of_[joint.tie].guide = joint.follower == joint.body ? force : Vec3(-force);
      carried_[link.block] = 1;
      const Index p = link.follows[0];
      Mat3 A;
      for (int k = 0; k < 3; ++k) A.col(k) = q_[p + 1 + k];
      const Vec3 X = A.inverse() * (q_[link.block] - q_[p]);
      handed_[link.block] -= force;
      handed_[p] += force;
      for (int k = 0; k < 3; ++k) handed_[p + 1 + k] += X[k] * force;
      on_body_[link.slide->slider] += force;
      on_body_[link.slide->carrier] -= force;
      return true;
    });
    if (links.size() == before) break;  // no forest: nothing is handed on any more
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
    for (int k = 0; k < 3 && of_[i].guide; ++k) sink.scalar(tie.effect, tie.name + "_guide_" + "xyz"[k], "N", (*of_[i].guide)[k]);
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
