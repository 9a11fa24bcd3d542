#include "audit/layer_error.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "audit/tuning.h"
#include "audit/vector_at.h"
#include "base/disjoint_sets.h"

namespace mortise::audit {

LayerError::LayerError(const model::ModelInput& input) : holds_(input.scene.at("effects")) {
  for (const model::BodyInput& in : input.bodies) {
    if (in.type == model::BodyType::half_space) continue;
    number_[in.name] = bodies_.size();
    bodies_.push_back({in.name, rest_.size(), in.nodes.size(), in.type == model::BodyType::soft});
    rest_.insert(rest_.end(), in.nodes.begin(), in.nodes.end());
  }
}

geometry::Motion LayerError::motion(std::size_t number, const Fields& f) const {
  const Body& body = bodies_[number];
  std::vector<Vec3> from, to;
  for (std::size_t i = body.first; i < body.first + body.count; ++i) from.push_back(rest_[i]), to.push_back(rest_[i] + at(f.displacement, i));
  return geometry::nearest_motion_of_any(from, to);
}

std::optional<geometry::Motion> LayerError::motion_of_supports(std::size_t body, const Fields& f) const {
  if (!bodies_[body].soft) return {};
  std::size_t base = body;
  for (std::size_t turns = 0; turns < bodies_.size(); ++turns) {
    const std::string* next = holds_.tied_to(bodies_[base].name);
    if (!next || !number_.count(*next)) break;
    base = number_.at(*next);
  }
  const auto [first, end] = std::pair{bodies_[base].first, bodies_[base].first + bodies_[base].count};
  // Of the points at which these forces act; where something presses, not of guides across it.
  const auto motion_by = [&, first = first, end = end](std::span<const double> bears, const Vec3& pressed) -> std::optional<geometry::Motion> {
    if (bears.size() != 3 * rest_.size() || f.displacement.size() != bears.size()) return {};
    std::vector<Vec3> from, to;
    for (std::size_t i = first; i < end; ++i) {
      const Vec3 force = at(bears, i);
      if (force.isZero(0) || std::abs(force.dot(pressed)) < tuning::kBears * force.norm() * pressed.norm()) continue;
      from.push_back(rest_[i]), to.push_back(rest_[i] + at(f.displacement, i));
    }
    if (from.empty()) return {};
    return geometry::nearest_motion_of_any(from, to);
  };
  if (!holds_.pinned(bodies_[base].name) || f.support.empty()) return motion_by(f.tie, Vec3::Zero());
  // A skin that is tied to something and guided besides is borne by what it is tied to, as far as guides lie across the contact force.
  bool tied = false;
  Vec3 pressed = Vec3::Zero();
  for (std::size_t i = first; i < end && !f.tie.empty() && !f.contact.empty(); ++i)
    pressed += at(f.contact, i), tied = tied || !at(f.tie, i).isZero(0);
  if (!tied) return motion_by(f.support, Vec3::Zero());
  const auto supported = motion_by(f.support, pressed);
  return supported ? supported : motion_by(f.tie, pressed);
}

double LayerError::indentation(std::size_t body, const Fields& f) const {
  const Body& b = bodies_[body];
  if (!b.soft) return 0;
  const std::optional<geometry::Motion> base = motion_of_supports(body, f);
  if (!base) return -1;
  double farthest = 0;
  for (std::size_t i = b.first; i < b.first + b.count; ++i)
    if (f.pressure[i] > 0) farthest = std::max(farthest, (rest_[i] + at(f.displacement, i) - base->R * rest_[i] - base->t).norm());
  return farthest;
}

LayerError::Way LayerError::way(std::size_t body, std::pair<std::size_t, std::size_t> pair, const Pair& of, const Fields& f,
                                const std::map<std::string, double>& number) const {
  if (body >= bodies_.size()) return {};  // a half-space
  const Body& b = bodies_[body];
  if (balances(body, f)) return {.free = true};
  Holds::Load load;
  load.gap = of.gap();
  if (of.known) {
    const double sign = body == pair.first ? 1 : -1;
    load.force = sign * of.on_first, load.moment = sign * of.moment;
  } else {
    for (std::size_t i = b.first; i < b.first + b.count; ++i)
      load.force += at(f.contact, i), load.moment += (rest_[i] + at(f.displacement, i)).cross(at(f.contact, i));
  }
  const auto motion_of = [&](const std::string& name) { return motion(number_.at(name), f); };
  const auto distance = [&](const std::string& name, const Vec3& place) {
    const Body& of = bodies_[number_.at(name)];
    Vec3 middle = Vec3::Zero();
    for (std::size_t i = of.first; i < of.first + of.count; ++i) middle += (rest_[i] + at(f.displacement, i)) / static_cast<double>(of.count);
    return (middle - place).norm();
  };
  const Holds::Give give = holds_.give(b.name, load, {number, motion_of, distance});
  const double pressed = indentation(body, f);
  return {.pressed = pressed, .give = give.way, .imposed = pressed >= 0, .free = std::isinf(give.way), .along = give.along};
}

double LayerError::borne(std::size_t body, const Fields& f) const {
  if (body >= bodies_.size() || !bodies_[body].soft) return 1;
  Vec3 contact = Vec3::Zero(), support = Vec3::Zero();
  for (std::size_t i = bodies_[body].first; i < bodies_[body].first + bodies_[body].count; ++i) {
    contact += at(f.contact, i);
    for (const std::span<const double> bears : {f.support, f.tie})
      if (!bears.empty()) support += at(bears, i);
  }
  return std::clamp(-support.dot(contact) / contact.squaredNorm(), 0.0, 1.0);
}

bool LayerError::balances(std::size_t body, const Fields& f) const {
  const Body& b = bodies_[body];
  if (!holds_.held(b.name)) return true;
  if (!b.soft) return false;
  Vec3 contact = Vec3::Zero();
  double all = 0;
  for (std::size_t i = b.first; i < b.first + b.count; ++i) contact += at(f.contact, i), all += at(f.contact, i).norm();
  return !(contact.norm() > tuning::kOneWay * all);
}

bool LayerError::goes(std::size_t body, const Pair& pair, const Fields& f) const {
  if (body >= bodies_.size()) return false;
  const Body& b = bodies_[body];
  for (std::size_t i = b.first; i < b.first + b.count; ++i)
    if (at(f.displacement, i).norm() > pair.gap()) return true;
  return false;
}

double LayerError::deformation_work(std::size_t body, const Fields& f) const {
  const Body& b = bodies_[body];
  const geometry::Motion rigid = motion_of_supports(body, f).value_or(motion(body, f));
  double work = 0;
  for (std::size_t i = b.first; i < b.first + b.count; ++i)
    work += at(f.contact, i).dot(rest_[i] + at(f.displacement, i) - rigid.R * rest_[i] - rigid.t);
  return work;
}

void LayerError::squeezed(const Pairs& pairs, const Fields& f, std::vector<Travel>& out) const {
  // Free bodies that touch, and what hangs together with them and touches nothing that holds it.
  std::vector<bool> free(bodies_.size(), false), touches(bodies_.size(), false);
  DisjointSets sets(bodies_.size());
  for (const auto& [bodies, pair] : pairs) {
    for (const auto& [body, way] : {std::pair{bodies.first, &pair.first}, std::pair{bodies.second, &pair.second}})
      if (body < bodies_.size()) touches[body] = true, free[body] = free[body] || way->free;
    if (pair.first.free && pair.second.free) sets.join(bodies.first, bodies.second);
  }
  for (const auto& [one, other] : holds_.together()) {
    if (!number_.count(one) || !number_.count(other)) continue;
    const auto hangs = [&](std::size_t i) { return free[i] || !(touches[i] || holds_.given(bodies_[i].name)); };
    if (const std::size_t a = number_.at(one), b = number_.at(other); hangs(a) && hangs(b)) sets.join(a, b);
  }
  struct Group {
    std::vector<std::size_t> bodies;
    double gaps = 0, deformed = 0, give = 0, forces = 0;
    double parts = 0, wholes = 0;  // of all pairs: forces of samples, and their resultants [N]
    Vec3 load = Vec3::Zero();
    std::set<std::size_t> pressed;    // what is free of pairs with what is held
    double along = 0, all_along = 0;  // on it: sums with and without sign [N]
    int sides = 0;                    // pairs with what is held
    bool given = false;               // something that presses gives a force, and no travel
  };
  std::map<std::size_t, Group> groups;
  for (const auto& [bodies, pair] : pairs) {
    const bool first = pair.first.free, second = pair.second.free;
    if (!(first || second) || bodies.first == bodies.second || !(pair.force > 0)) continue;
    Group& g = groups[sets.of(first ? bodies.first : bodies.second)];
    g.gaps += pair.work, g.bodies.insert(g.bodies.end(), {bodies.first, bodies.second}), g.given = g.given || !pair.known;
    g.parts += pair.force, g.wholes += pair.on_first.norm();
    if (first && second) continue;
    const Way& way = first ? pair.second : pair.first;
    const double along = first ? pair.first.along : pair.second.along;
    g.pressed.insert(first ? bodies.first : bodies.second), g.along += along, g.all_along += std::abs(along);
    ++g.sides, g.given = g.given || !way.imposed;
    g.deformed += pair.force * way.pressed, g.give += pair.force * way.give, g.forces += pair.on_first.norm(),
        g.load += (first ? 1 : -1) * pair.on_first;
  }
  for (std::size_t i = 0; i < bodies_.size(); ++i)
    if (const auto g = groups.find(sets.of(i)); free[i] && bodies_[i].soft && g != groups.end()) g->second.deformed += deformation_work(i, f);
  for (const auto& [name, g] : groups) {
    const double work = g.deformed + g.give;
    if (g.given || !(g.parts > 0)) continue;
    const bool fits = g.sides < 2;  // by what presses it from one side, or from all around
    const bool lever = g.pressed.size() == 1 && g.all_along > 0;
    // Of F + w and F: a load w bears w / (F + w) = 2 resultant / (1 + resultant).
    const double resultant = fits ? g.wholes / g.parts : lever ? std::abs(g.along) / g.all_along : g.load.norm() / g.forces;
    const double share = std::max(0.0, (1 - 3 * resultant) / (1 + resultant));
    if (fits && share == 0) continue;
    if (work > 0)
      out.push_back({g.bodies, share, g.gaps, g.deformed, work});
    else if (work == 0 && share > tuning::kSqueezed)
      out.push_back(Travel::of_layer(g.bodies));
  }
}

std::vector<LayerError::Travel> LayerError::travels(const Samples& s, const Fields& f, const std::map<std::string, double>& number) const {
  const std::size_t n = f.displacement.size();
  if (n != 3 * rest_.size() || f.contact.size() != n || 3 * f.pressure.size() != n) return {};
  for (const std::span<const double> bears : {f.support, f.tie})
    if (!bears.empty() && bears.size() != n) return {};
  Pairs pairs;
  for (std::size_t i = 0; i < s.force.size(); ++i) {
    Pair& pair = pairs[std::minmax(static_cast<std::size_t>(s.bodies[2 * i]), static_cast<std::size_t>(s.bodies[2 * i + 1]))];
    pair.force += s.force[i], pair.work += s.force[i] * s.gap[i];
  }
  for (std::size_t i = 0; 3 * i < std::min(s.pair_force.size(), s.pair_moment.size()); ++i) {
    const auto it = pairs.find({static_cast<std::size_t>(s.pair_bodies[2 * i]), static_cast<std::size_t>(s.pair_bodies[2 * i + 1])});
    if (it != pairs.end()) it->second.on_first = at(s.pair_force, i), it->second.moment = at(s.pair_moment, i), it->second.known = true;
  }
  for (auto& [bodies, pair] : pairs)
    if (pair.force > 0) pair.first = way(bodies.first, bodies, pair, f, number), pair.second = way(bodies.second, bodies, pair, f, number);
  double most = 0;  // force of a pair
  for (const auto& [bodies, pair] : pairs) most = std::max(most, pair.force);
  std::vector<Travel> out;
  squeezed(pairs, f, out);
  for (const auto& [bodies, pair] : pairs) {
    const Way &one = pair.first, &other = pair.second;
    if (!(pair.force > 0) || one.free || other.free) continue;
    const double deformed = one.pressed + other.pressed, all = deformed + one.give + other.give;
    if (!(one.imposed && other.imposed)) continue;
    if (all == 0 && pair.force > tuning::kPart * most && (goes(bodies.first, pair, f) || goes(bodies.second, pair, f)))
      out.push_back(Travel::of_layer({bodies.first, bodies.second}));
    if (!(all > 0)) continue;
    const double share = std::max(0.0, 2 * std::min(borne(bodies.first, f), borne(bodies.second, f)) - 1);
    out.push_back({{bodies.first, bodies.second}, share, pair.gap(), deformed, all});
  }
  return out;
}

double LayerError::worst(const std::vector<Travel>& travels, bool alone) {
  double worst = NAN;
  for (const Travel& t : travels)
    if (alone || !t.alone) worst = std::fmax(worst, t.layer());
  return worst;
}

}  // namespace mortise::audit
