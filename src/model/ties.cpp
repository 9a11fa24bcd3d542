#include "model/ties.h"

#include <algorithm>
#include <map>
#include <sstream>

#include "model/model.h"

namespace mortise::model {
namespace {

const Body& body_of(const Model& model, Index block) {
  return *std::find_if(model.bodies.begin(), model.bodies.end(), [&](const Body& b) { return block >= b.block_begin && block < b.block_end; });
}

std::string text(const Vec3& v) {
  std::ostringstream s;
  s << "[" << v[0] << ", " << v[1] << ", " << v[2] << "]";
  return s.str();
}

}  // namespace

// Blocks by those that they hang on, and h.
struct Ties::Composed {
  std::map<Index, std::map<Index, double>> of;
  std::map<Index, Vec3> fixed;
};

void Ties::add(Model& model, std::vector<Tie> ties) {
  if (ties.empty()) return;
  for (Tie& tie : ties) {
    for (const Tie& other : ties_)
      if (other.name == tie.name && model.bodies[other.body].env == model.bodies[tie.body].env)
        throw Error(Exit::scene, tie.where,
                    "two ties are called '" + tie.name + "' (the other at " + other.where.text() + "): give one of them a 'name'");
    ties_.push_back(std::move(tie));
  }
  settle(model);
}

void Ties::settle(Model& model) {
  compose(model);
  upload();
  for (Index b : blocks_) model.held[b] = Model::kTied;
  name_carriages(model);
  start(model);
}

void Ties::hand_over(Model& model, Index tie, std::string driver, std::vector<Follow> follows, Follow axis, bool slides) {
  Tie& t = ties_[tie];
  if (t.follows.empty())
    throw Error(Exit::scene, t.where,
                "closes a loop: what it would move is given by the loop's other joints. Drive one of those, or this one by a torque");
  t.driver = std::move(driver), t.follows = std::move(follows), t.axis = std::move(axis), t.slides = slides;
  driven_ = true;
  settle(model);
  for (const Closing& closing : closings_)
    if (model.bodies[ties_[closing.tie].body].env == model.bodies[ties_[tie].body].env)
      throw Error(Exit::scene, ties_[closing.tie].where,
                  "closes a loop, and the joint at " + ties_[tie].where.text() +
                      " is driven to given positions: loops go with drives of mode pd or effort only");
}

void Ties::drive(const Model& model, std::vector<std::pair<Index, std::vector<Follow>>> follows) {
  for (auto& [tie, equations] : follows) ties_[tie].follows = std::move(equations);
  compose(model);
  upload();
}

void Ties::compose(const Model& model) {
  constexpr std::pair<Index, Index> kNone{-1, -1};
  std::vector<std::pair<Index, Index>> equation(model.blocks, kNone);
  for (std::size_t t = 0; t < ties_.size(); ++t) {
    Index pinned = 0;
    for (std::size_t f = 0; f < ties_[t].follows.size(); ++f) {
      const Index b = ties_[t].follows[f].block;
      pinned += model.held[b] == 1 || model.held[b] == 2;
      if (equation[b] != kNone)
        throw Error(Exit::scene, ties_[t].where,
                    "ties what the tie at " + ties_[equation[b].first].where.text() + " ties already: parts of '" + body_of(model, b).name + "'");
      equation[b] = {static_cast<Index>(t), static_cast<Index>(f)};
    }
    if (pinned > 0)
      throw Error(Exit::scene, ties_[t].where,
                  "ties " + std::to_string(pinned) + " nodes of '" + body_of(model, ties_[t].follows[0].block).name +
                      "' that a pin holds or moves: what is tied cannot be pinned too");
  }

  // Depth first, so that what is followed is composed before its followers.
  order_.clear();
  Composed all;
  auto& composed = all.of;
  auto& fixed = all.fixed;
  enum : std::uint8_t { fresh, open, done };
  std::vector<std::uint8_t> state(model.blocks, fresh), moving(model.blocks, 0);
  const auto visit = [&](const auto& self, Index b) -> void {
    if (equation[b] == kNone || state[b] == done) return;
    const Tie& tie = ties_[equation[b].first];
    if (state[b] == open) throw Error(Exit::scene, tie.where, "closes a circle of ties: '" + body_of(model, b).name + "' would follow itself");
    state[b] = open;
    const Follow& follow = tie.follows[equation[b].second];
    fixed[b] = follow.fixed;
    moving[b] = tie.driven();
    for (const TieTerm& term : follow.terms) {
      self(self, term.block);
      moving[b] |= moving[term.block];
      if (equation[term.block] == kNone) {
        composed[b][term.block] += term.weight;
        continue;
      }
      for (const auto& [k, w] : composed[term.block]) composed[b][k] += term.weight * w;
      fixed[b] += term.weight * fixed[term.block];
    }
    std::erase_if(composed[b], [](const auto& term) { return term.second == 0; });
    order_.push_back(equation[b]);
    state[b] = done;
  };
  for (Index b = 0; b < model.blocks; ++b) visit(visit, b);
  close(model, all);
  place_.assign(model.blocks, -1);
  blocks_.clear(), terms_.clear(), fixed_.clear(), moving_.clear();
  offset_.assign(1, 0);
  ++version_;
  for (const auto& [b, row] : composed) {
    place_[b] = static_cast<Index>(blocks_.size());
    blocks_.push_back(b);
    for (const auto& [k, w] : row) terms_.push_back({k, w});
    offset_.push_back(static_cast<Index>(terms_.size()));
    fixed_.push_back(fixed[b]);
    moving_.push_back(moving[b]);
  }
}

void Ties::close(const Model& model, Composed& all) {
  constexpr double kNothing = 1e-12;  // of the largest weight in an equation: what rounding leaves of weights that cancel
  closings_.clear();
  Composed given;  // by the equations so far: their pivots
  const auto expand = [](std::map<Index, double>& row, Vec3& constant, const Composed& by) {
    std::map<Index, double> out;
    for (const auto& [b, w] : row) {
      const auto known = by.of.find(b);
      if (known == by.of.end()) {
        out[b] += w;
        continue;
      }
      for (const auto& [k, t] : known->second) out[k] += w * t;
      constant += w * by.fixed.at(b);
    }
    row = std::move(out);
  };
  for (std::size_t t = 0; t < ties_.size(); ++t)
    for (std::size_t f = 0; f < ties_[t].closes.size(); ++f) {
      const Follow& equation = ties_[t].closes[f];
      std::map<Index, double> row{{equation.block, 1.0}};
      Vec3 constant = -equation.fixed;
      double largest = 1;
      for (const TieTerm& term : equation.terms) row[term.block] -= term.weight, largest = std::max(largest, std::abs(term.weight));
      const auto clean = [&] { std::erase_if(row, [&](const auto& term) { return std::abs(term.second) <= kNothing * largest; }); };
      expand(row, constant, all);
      clean();
      Closing closing{static_cast<Index>(t), static_cast<Index>(f), {}, -1};
      for (const auto& [k, w] : row) closing.row.push_back({k, w});
      expand(row, constant, given);
      clean();
      if (row.empty()) continue;
      double heaviest = 0;
      for (const auto& [k, w] : row)
        if (model.held[k] != 1 && model.held[k] != 2 && std::abs(w) > heaviest) heaviest = std::abs(w), closing.pivot = k;
      if (closing.pivot < 0) throw Error(Exit::scene, ties_[t].where, "joins what supports hold already: no joint can move it");
      const Index j = closing.pivot;
      const double pivot = row[j];
      row.erase(j);
      Composed one;
      for (const auto& [k, w] : row) one.of[j][k] = -w / pivot;
      one.of[j];
      one.fixed[j] = -constant / pivot;
      for (auto& [b, known] : given.of) expand(known, given.fixed[b], one);
      given.of[j] = one.of[j], given.fixed[j] = one.fixed[j];
      closings_.push_back(std::move(closing));
    }
  if (closings_.empty()) return;
  for (auto& [b, row] : all.of) expand(row, all.fixed[b], given);
  all.of.merge(given.of), all.fixed.merge(given.fixed);
}

void Ties::upload() {
  std::vector<Index> of, follower;
  std::vector<double> weight;
  std::vector<std::uint64_t> key;
  for (std::size_t i = 0; i < blocks_.size(); ++i)
    for (Index j = offset_[i]; j < offset_[i + 1]; ++j) {
      of.push_back(terms_[j].block), weight.push_back(terms_[j].weight), follower.push_back(blocks_[i]);
      key.push_back(static_cast<std::uint64_t>(terms_[j].block));
    }
  block_.upload(blocks_), start_.upload(offset_), of_.upload(of), weight_.upload(weight), follower_.upload(follower), fixed_on_device_.upload(fixed_),
      moving_on_device_.upload(moving_);
  linalg::group(Buffer<std::uint64_t>(key), device::kNoKey, followed_);
}

// Bodies that are tied wholly to what is prescribed are prescribed themselves; driven ones go ways of their own.
void Ties::name_carriages(Model& model) const {
  Index last = Body::kStill;
  for (const Body& body : model.bodies) last = std::max(last, body.carriage);
  for (Body& body : model.bodies) {
    std::vector<Index> carriages;
    bool wholly = true, moving = false;
    for (Index b = body.block_begin; b < body.block_end && wholly; ++b) {
      wholly = tied(b);
      if (!wholly) break;
      const Index i = place_[b];
      moving = moving || moving_[i];
      if (offset_[i] == offset_[i + 1] || !fixed_[i].isZero(0)) carriages.push_back(Body::kStill);
      for (Index j = offset_[i]; j < offset_[i + 1]; ++j) carriages.push_back(body_of(model, terms_[j].block).carriage);
    }
    if (!wholly) continue;
    std::sort(carriages.begin(), carriages.end());
    if (moving) {
      if (carriages.front() == Body::kFree) continue;
      body.carriage = ++last;
      model.driven = true;
    } else if (carriages.front() == carriages.back()) {
      body.carriage = carriages.front();
    }
  }
}

// The ties hold at the start already, but for rounding; a velocity that the scene gives to a tied body has to be one that its ties allow.
void Ties::start(Model& model) const {
  constexpr double kSame = 1e-6, kRounding = 1e-12;  // of what turns, at a metre
  place(model.q.view());
  const std::vector<Vec3> given = model.initial_velocity.download();
  carry(model.initial_velocity.view());
  const std::vector<Vec3> v = model.initial_velocity.download();
  for (const Closing& closing : closings_)
    if ((given[closing.pivot] - v[closing.pivot]).norm() > kSame * (given[closing.pivot].norm() + v[closing.pivot].norm()))
      throw Error(Exit::scene, ties_[closing.tie].where,
                  "'" + body_of(model, closing.pivot).name + "' starts with a motion that this joint, which closes a loop, does not allow");
  for (const Tie& tie : ties_)
    for (const Follow& follow : tie.follows) {
      const Index b = follow.block;
      const Body& body = body_of(model, b);
      const bool soft = body.type == BodyType::soft;
      // Of the centre of a body that turns: some of it may be rounding [m/s].
      double rounding = 0;
      for (Index k = body.block_begin + 1; !soft && b == body.block_begin && k < body.block_end; ++k) rounding += kRounding * given[k].norm();
      if ((given[b] - v[b]).norm() <= kSame * (given[b].norm() + v[b].norm()) + rounding) continue;
      if (soft || (b == body.block_begin && given[b].norm() > rounding))
        throw Error(Exit::scene, tie.where,
                    "'" + body.name + "' starts with the velocity " + text(given[b]) + " m/s where the tie makes it " + text(v[b]) +
                        " m/s: give it that" +
                        (soft                    ? " (velocity and angular_velocity of the body that it is tied to)"
                         : tie.to == Tie::kWorld ? ", or none"
                                                 : ", or none, or '" + model.bodies[tie.to].name + "' the velocity that it starts with"));
      if (b == body.block_begin) continue;
      Mat3 rate;
      for (int k = 0; k < 3; ++k) rate.col(k) = v[body.block_begin + 1 + k];
      if ((rate + rate.transpose()).norm() > kSame * rate.norm())
        throw Error(Exit::scene, tie.where,
                    "'" + body.name +
                        "' starts with a turning that the tie does not allow: its angular_velocity may differ from that of the other body only about "
                        "the axis");
    }
}

bool Ties::pass(Index a, Index b) const {
  return std::any_of(ties_.begin(), ties_.end(),
                     [&](const Tie& t) { return !t.contact && ((t.body == a && t.to == b) || (t.body == b && t.to == a)); });
}

std::vector<TieTerm> Ties::terms(Index block) const {
  if (!tied(block)) return {{block, 1.0}};
  const Index i = place_[block];
  return {terms_.begin() + offset_[i], terms_.begin() + offset_[i + 1]};
}

bool Ties::held(Index block, const std::vector<std::uint8_t>& held) const {
  if (!tied(block)) return held[block] == 2;
  const std::vector<TieTerm> all = terms(block);
  return std::all_of(all.begin(), all.end(), [&](const TieTerm& t) { return held[t.block] == 2; });
}

void Ties::place(View<Vec3> q) const {
  const View<const Index> block = block_.view(), start = start_.view(), of = of_.view();
  const View<const double> weight = weight_.view();
  const View<const Vec3> fixed = fixed_on_device_.view();
  device::parallel_for("ties.place", block.n, [=] MORTISE_HD(Index i) {
    Vec3 sum = fixed[i];
    for (Index j = start[i]; j < start[i + 1]; ++j) sum += weight[j] * q[of[j]];
    q[block[i]] = sum;
  });
}

void Ties::carry(View<Vec3> dq) const {
  const View<const Index> block = block_.view(), start = start_.view(), of = of_.view();
  const View<const double> weight = weight_.view();
  device::parallel_for("ties.carry", block.n, [=] MORTISE_HD(Index i) {
    Vec3 sum = Vec3::Zero();
    for (Index j = start[i]; j < start[i + 1]; ++j) sum += weight[j] * dq[of[j]];
    dq[block[i]] = sum;
  });
}

void Ties::add_offset(View<const Vec3> q, View<Vec3> c) const {
  const View<const Index> block = block_.view(), start = start_.view(), of = of_.view();
  const View<const double> weight = weight_.view();
  const View<const Vec3> fixed = fixed_on_device_.view();
  const View<const std::uint8_t> moving = moving_on_device_.view();
  device::parallel_for("ties.offset", block.n, [=] MORTISE_HD(Index i) {
    if (!moving[i]) return;
    Vec3 sum = fixed[i];
    for (Index j = start[i]; j < start[i + 1]; ++j) sum += weight[j] * q[of[j]];
    c[block[i]] += sum - q[block[i]];
  });
}

void Ties::add_offset_of(View<const Vec3> c, View<Vec3> dq) const {
  const View<const Index> block = block_.view(), start = start_.view(), of = of_.view();
  const View<const double> weight = weight_.view();
  const View<const std::uint8_t> moving = moving_on_device_.view();
  device::parallel_for("ties.offset", block.n, [=] MORTISE_HD(Index i) {
    if (!moving[i]) return;
    Vec3 sum = Vec3::Zero();
    for (Index j = start[i]; j < start[i + 1]; ++j) sum += weight[j] * c[of[j]];
    dq[block[i]] += c[block[i]] - sum;
  });
}

void Ties::place_after(View<const Vec3> q, View<const double> alpha, View<const Index> block_env, View<Vec3> trial) const {
  const View<const Index> block = block_.view(), start = start_.view(), of = of_.view();
  const View<const double> weight = weight_.view();
  const View<const Vec3> fixed = fixed_on_device_.view();
  const View<const std::uint8_t> moving = moving_on_device_.view();
  device::parallel_for("ties.place_after", block.n, [=] MORTISE_HD(Index i) {
    Vec3 sum = fixed[i], before = fixed[i];
    for (Index j = start[i]; j < start[i + 1]; ++j) sum += weight[j] * trial[of[j]], before += weight[j] * q[of[j]];
    if (moving[i]) sum -= (1 - alpha[block_env[block[i]]]) * (before - q[block[i]]);
    trial[block[i]] = sum;
  });
}

void Ties::fold(View<Vec3> g) const {
  if (!any()) return;
  const View<const Index> block = block_.view(), follower = follower_.view();
  const View<const double> weight = weight_.view();
  const View<const std::uint64_t> to = followed_.key.view();
  linalg::grouped_sum<Vec3>(
      "ties.fold", followed_, [=] MORTISE_HD(Index e) -> Vec3 { return weight[e] * g[follower[e]]; },
      [=] MORTISE_HD(Index k, const Vec3& t) { g[static_cast<Index>(to[k])] += t; });
  device::parallel_for("ties.fold", block.n, [=] MORTISE_HD(Index i) { g[block[i]] = Vec3::Zero(); });
}

}  // namespace mortise::model
