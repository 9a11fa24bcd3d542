#include "solver/convergence.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "effects/body_blocks.h"
#include "model/radius.h"
#include "solver/kernels.h"
#include "solver/tuning.h"

namespace mortise::solver {

// Per block: what places are rounded by that it feels beside its own [m]. Of a soft body that has tied nodes: the farthest that a block they follow
// reaches, by its weight (the place of a node at the foot of a long stiff body is a small difference of large numbers, whose rounding all nodes
// beside it feel). Of a block that they follow: the farthest node of their body. Of a stiff body's position: its radius, as its axes are rounded.
static std::vector<double> reaches(const model::Model& model, const std::vector<double>& radius) {
  std::vector<double> reach(model.blocks, 0.0);
  const std::vector<Vec3> rest = model.rest.download();
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const model::Body& body = model.bodies[i];
    if (body.type != model::BodyType::soft) {
      reach[body.block_begin] = std::max(reach[body.block_begin], radius[i]);
      continue;
    }
    double far = 0, farthest = 0;
    for (Index b = body.block_begin; b < body.block_end; ++b) farthest = std::max(farthest, rest[b].norm());
    for (Index b = body.block_begin; b < body.block_end; ++b) {
      if (!model.ties.tied(b)) continue;
      for (const model::TieTerm& t : model.ties.terms(b))
        far = std::max(far, std::abs(t.weight) * rest[t.block].norm()), reach[t.block] = std::max(reach[t.block], farthest);
    }
    for (Index b = body.block_begin; b < body.block_end; ++b) reach[b] = std::max(reach[b], far);
  }
  return reach;
}

Convergence::Convergence(const model::Model& model, const Options& options) : model_(model), options_(options) {
  std::vector<Index> blocks{0};
  const std::vector<Vec3> rest = model.rest_points.download();
  const std::vector<double> position = effects::translation_weight(model);
  std::vector<double> lever(model.blocks, 1.0);
  for (const model::Body& body : model.bodies) {
    const double radius = model::radius(body, rest);
    radius_.push_back(radius);
    blocks.push_back(body.block_end);
    for (Index b = body.block_begin; b < body.block_end; ++b)
      if (position[b] == 0) lever[b] = radius;
  }
  blocks_ = Chunks(blocks);
  lever_.upload(lever);
  position_.upload(position);
  reach_.upload(reaches(model, radius_));
}

void Convergence::begin_step() {
  loose_.clear(), held_.clear();
  for (const model::Body& body : model_.bodies) {
    const auto first = model_.held.begin() + body.block_begin, last = model_.held.begin() + body.block_end;
    loose_.push_back(std::all_of(first, last, [](auto held) { return held == 0; }));
    held_.push_back(std::all_of(first, last, [](auto held) { return held >= 2; }));
  }
  connect({}, EnvMask(model_.envs, 1));
  rounding_.assign(model_.bodies.size(), 0.0);
  rounding_sum_ = rounding_;
  step_.assign(model_.bodies.size(), -1.0);
  last_ = begin();
  comparable_.assign(model_.bodies.size(), 0);
}

void Convergence::set_rows(const std::vector<Index>& row_of_block) {
  std::vector<Index> rows{0};
  for (const model::Body& body : model_.bodies) {
    Index end = rows.back();
    for (Index b = body.block_begin; b < body.block_end; ++b) end = std::max(end, row_of_block[b] + 1);
    rows.push_back(end);
  }
  rows_ = Chunks(rows);
}

void Convergence::connect(const std::vector<const model::ContactView*>& contacts, const EnvMask& whose) {
  const Index n = static_cast<Index>(model_.bodies.size());
  group_.resize(n);
  for (Index e = 0; e < model_.envs; ++e)
    if (whose[e]) std::iota(group_.begin() + model_.env_bodies[e], group_.begin() + model_.env_bodies[e + 1], model_.env_bodies[e]);
  const auto root = [&](Index b) {
    while (group_[b] != b) b = group_[b] = group_[group_[b]];
    return b;
  };
  if (std::count(held_.begin(), held_.end(), 0) < 2) return;
  for (const model::ContactView* view : contacts)
    for (const auto& [one, other] : touching(view->samples.view())) {
      if (one >= n || held_[one] || held_[other] || !whose[model_.bodies[one].env]) continue;  // a half-space counts after the bodies
      const Index a = root(one), b = root(other);
      group_[std::max(a, b)] = std::min(a, b);
    }
  for (Index b = 0; b < n; ++b) group_[b] = root(b);
}

void Convergence::finish(Residual& r) const {
  std::vector<double> largest(r.scale.size(), 0.0);
  for (std::size_t i = 0; i < largest.size(); ++i) largest[group_[i]] = std::max(largest[group_[i]], r.scale[i]);
  for (std::size_t i = 0; i < largest.size(); ++i) r.scale[i] = largest[group_[i]];
}

Residual Convergence::begin() const {
  Residual r;
  r.support_gap.assign(model_.envs, 0.0);
  const std::vector<double> none(model_.bodies.size(), 0.0);
  r.force = r.scale = r.net[0] = r.net[1] = r.net[2] = r.load = r.way = none;
  return r;
}

void Convergence::see_effect(const effects::Kind& kind, View<const Vec3> gradient, Residual& r, Fetch& fetch) const {
  force_sizes(blocks_, gradient, model_.projector.view(), lever_.view(), position_.view(), fetch,
              [&r, moves = kind.role != effects::Role::store](const std::vector<Part>& bodies) {
                for (std::size_t i = 0; i < bodies.size(); ++i) {
                  r.scale[i] = device::Larger()(r.scale[i], bodies[i].largest);
                  if (moves) r.load[i] = device::Larger()(r.load[i], bodies[i].sum[0]);
                }
              });
}

void Convergence::see_sum(View<const Vec3> gradient, View<const Vec3> q, Residual& r, Fetch& fetch) const {
  residual_sizes(blocks_, gradient, model_.projector.view(), lever_.view(), position_.view(), q, model_.q.view(), fetch,
                 [&r](const std::vector<Part>& bodies) {
                   for (std::size_t i = 0; i < bodies.size(); ++i) {
                     r.force[i] = bodies[i].largest, r.way[i] = bodies[i].far;
                     for (int k = 0; k < 3; ++k) r.net[k][i] = bodies[i].sum[k];
                   }
                 });
}

void Convergence::see_matrix(const linalg::BlockMatrix& matrix, View<const Vec3> q, View<const Index> block_of_row, const EnvMask& whose,
                             Fetch& fetch) {
  rounding_sizes(rows_, matrix, q, block_of_row, lever_.view(), reach_.view(), fetch, [this, whose](const std::vector<Part>& bodies) {
    for (std::size_t i = 0; i < bodies.size(); ++i)
      if (whose[model_.bodies[i].env]) rounding_[i] = bodies[i].largest, rounding_sum_[i] = bodies[i].sum[0];
  });
}

void Convergence::see_step(View<const Vec3> dq, const Residual& r, const EnvMask& whose, Fetch& fetch) {
  for (std::size_t i = 0; i < step_.size(); ++i) {
    if (!whose[model_.bodies[i].env]) continue;
    last_.force[i] = r.force[i], last_.scale[i] = r.scale[i], last_.load[i] = r.load[i], last_.way[i] = r.way[i];
    for (int k = 0; k < 3; ++k) last_.net[k][i] = r.net[k][i];
    comparable_[i] = 1;
  }
  step_sizes(blocks_, dq, lever_.view(), fetch, [this, whose](const std::vector<Part>& bodies) {
    for (std::size_t i = 0; i < bodies.size(); ++i)
      if (whose[model_.bodies[i].env]) step_[i] = bodies[i].far;
  });
}

double Convergence::net(const Residual& r, Index body) const { return std::hypot(r.net[0][body], r.net[1][body], r.net[2][body]); }

// Of the two comparisons in (a), the one that is farther from holding.
Convergence::Figures Convergence::figures(const Residual& r, Index body, double relative) const {
  const auto tolerance = [&](double of, double rounding) { return std::max({options_.force_tolerance, relative * of, rounding}); };
  const Figures one{r.force[body], tolerance(r.scale[body], rounding_[body])};
  if (!loose_[body]) return one;
  const Figures all{net(r, body), tolerance(r.load[body], rounding_sum_[body])};
  return all.force * one.tolerance > one.force * all.tolerance ? all : one;
}

// The floor of rounding is a bound; the residual may well fall below it, and is given one more iteration to do so where the last one gained
// a digit, unless it is far below already.
bool Convergence::balanced(const Residual& r, Index body, double relative) const {
  const Figures now = figures(r, body, relative);
  if (!(now.force <= now.tolerance)) return false;
  const double asked = std::max(options_.force_tolerance, relative * r.scale[body]);
  if (r.force[body] <= asked || !comparable_[body]) return true;
  return r.force[body] > tuning::kGains * last_.force[body] || r.force[body] <= tuning::kGains * rounding_[body];
}

bool Convergence::at_rest(const Residual& r, Index body, double relative) const {
  if (step_[body] < 0) return r.force[body] == 0;
  const auto had_to_move = [&](Index i) {
    const Figures then = figures(last_, i, relative);
    return then.force > then.tolerance;
  };
  double fell = 0;
  if (had_to_move(body)) {
    fell = r.force[body] / last_.force[body];
  } else {  // its neighbours moved it: as fast as the slowest of them
    const Index env = model_.bodies[body].env;
    for (Index i = model_.env_bodies[env]; i < model_.env_bodies[env + 1]; ++i)
      if (had_to_move(i)) fell = std::max(fell, r.force[i] / last_.force[i]);
  }
  const double settled = std::max(options_.lag_tolerance, options_.relative_tolerance), early = std::max(1.0, relative / settled);
  return fell * step_[body] <= early * std::max(tuning::kMotion * r.way[body], tuning::kSize * radius_[body]);
}

double Convergence::largest_force(const Residual& r, Index env) const {
  double largest = 0;
  for (Index i = model_.env_bodies[env]; i < model_.env_bodies[env + 1]; ++i) largest = std::max(largest, r.force[i]);
  return largest;
}

double Convergence::loose_sum(const Residual& r, Index env) const {
  double largest = 0;
  for (Index i = model_.env_bodies[env]; i < model_.env_bodies[env + 1]; ++i)
    if (loose_[i]) largest = std::max(largest, Vec3(r.net[0][i], r.net[1][i], r.net[2][i]).norm());
  return largest;
}

double Convergence::over(const Residual& r, Index env, double relative) const {
  double largest = 0;
  for (Index i = model_.env_bodies[env]; i < model_.env_bodies[env + 1]; ++i) {
    const Figures f = figures(r, i, relative);
    if (f.force > 0) largest = std::max(largest, f.force / f.tolerance);
  }
  return largest;
}

bool Convergence::finite(const Residual& r, Index env) const {
  for (Index i = model_.env_bodies[env]; i < model_.env_bodies[env + 1]; ++i)
    if (!std::isfinite(r.force[i])) return false;
  return true;
}

double Convergence::relative_residual(const Residual& r, Index env) const {
  double largest = 0;
  for (Index i = model_.env_bodies[env]; i < model_.env_bodies[env + 1]; ++i) {
    if (r.force[i] > rounding_[i]) largest = std::max(largest, r.force[i] / r.scale[i]);
    const double all = net(r, i);
    if (loose_[i] && all > rounding_sum_[i]) largest = std::max(largest, all / r.load[i]);
  }
  return largest;
}

bool Convergence::solved(const Residual& r, Index env, double relative) const {
  for (Index i = model_.env_bodies[env]; i < model_.env_bodies[env + 1]; ++i) {
    if (!(balanced(r, i, relative) && at_rest(r, i, relative))) return false;
  }
  return true;
}

double Convergence::least_tolerance(const Residual& r, Index env, double relative) const {
  double least = INFINITY;
  for (Index i = model_.env_bodies[env]; i < model_.env_bodies[env + 1]; ++i) {
    const Index body = i;
    if (held_[i]) continue;
    const Figures f = figures(r, body, relative);
    // Rows of axes are moments: force times lever.
    const double lever = model_.bodies[i].type == model::BodyType::stiff ? std::min(1.0, radius_[i]) : 1;
    least = std::min(least, lever * (balanced(r, body, relative) && !at_rest(r, body, relative) ? f.force : f.tolerance));
  }
  return least;
}

Convergence::Worst Convergence::worst(const Residual& r, Index env, double relative) const {
  Worst worst;
  double largest = -1;
  for (Index i = model_.env_bodies[env]; i < model_.env_bodies[env + 1]; ++i) {
    const Figures f = figures(r, i, relative);
    const double ratio = f.force > 0 ? f.force / f.tolerance : 0;
    if (ratio > largest) largest = ratio, worst = {i, f.force, f.tolerance};
  }
  return worst;
}

}  // namespace mortise::solver
