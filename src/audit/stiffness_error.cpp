#include "audit/stiffness_error.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "audit/entries.h"
#include "audit/tuning.h"
#include "audit/vector_at.h"
#include "geometry/bounds.h"
#include "geometry/rigid_motion.h"

namespace mortise::audit {

StiffnessError::StiffnessError(const model::ModelInput& input) {
  const Holds holds(input.scene.at("effects"));
  std::map<std::string, int> supports;
  std::set<std::string> guided;  // whose supports let it go somewhere
  for (const auto& [effect, key] : {std::pair{"pin", "body"}, {"bond", "body"}, {"mortar_tie", "body"}, {"mortar_tie", "to"}})
    for (const Params& p : entries(input.scene.at("effects"), effect)) {
      ++supports[p.text(key)];
      if (p.has("axes") && p.text("axes") != "xyz") guided.insert(p.text(key));
    }
  for (const model::BodyInput& in : input.bodies) {
    if (in.type == model::BodyType::half_space) continue;
    bodies_.push_back({points_, in.nodes, in.type == model::BodyType::soft, supports[in.name],
                       in.nodes.empty() ? 0 : geometry::bounds_of(in.nodes).size().minCoeff(), holds.held(in.name),
                       holds.given(in.name) && !guided.count(in.name)});
    points_ += in.nodes.size();
  }
}

double StiffnessError::deformed(const Body& body, std::optional<geometry::Motion> base, std::span<const double> displacement) {
  std::vector<Vec3> to;
  for (std::size_t i = 0; i < body.rest.size(); ++i) to.push_back(body.rest[i] + at(displacement, body.first + i));
  if (!base) base = geometry::nearest_motion_of_any(body.rest, to);
  double farthest = 0;
  for (std::size_t i = 0; i < to.size(); ++i) farthest = std::max(farthest, (to[i] - base->R * body.rest[i] - base->t).norm());
  return farthest;
}

double StiffnessError::carried(const Body& body, const std::vector<geometry::Motion>& bases, std::span<const double> displacement) {
  double farthest = 0;
  for (std::size_t i = 0; bases.size() > 1 && i < body.rest.size(); ++i) {
    const auto taken = [&](const geometry::Motion& base) { return Vec3(base.R * body.rest[i] + base.t); };
    const Vec3 now = body.rest[i] + at(displacement, body.first + i);
    double from = INFINITY, apart = 0;
    for (const geometry::Motion& base : bases)
      from = std::min(from, (now - taken(base)).norm()), apart = std::max(apart, (taken(base) - taken(bases.front())).norm());
    if (from > apart) farthest = std::max(farthest, from);
  }
  return farthest;
}

double StiffnessError::way(const std::vector<std::size_t>& of, const Bases& bases, std::span<const double> displacement) const {
  std::vector<geometry::Motion> frames(1);  // the world
  if (std::all_of(of.begin(), of.end(), [this](std::size_t b) { return bodies_[b].held; }))
    for (const std::size_t b : of)
      if (bodies_[b].soft && bodies_[b].given && bases[b]) frames.push_back(*bases[b]);
  double least = INFINITY;
  for (const geometry::Motion& frame : frames) {
    double farthest = 0;
    for (const std::size_t b : of)
      for (std::size_t i = 0; i < bodies_[b].rest.size(); ++i) {
        const Vec3& x = bodies_[b].rest[i];
        farthest = std::max(farthest, (x + at(displacement, bodies_[b].first + i) - frame.R * x - frame.t).norm());
      }
    least = std::min(least, farthest);
  }
  return least;
}

double StiffnessError::of(const std::map<std::size_t, double>& errors, const std::vector<std::size_t>& group,
                          const std::vector<LayerError::Travel>& travels, const Bases& bases, std::span<const double> displacement,
                          const std::map<std::size_t, double>& bending) const {
  double worst = NAN;
  const bool moves = displacement.size() == 3 * points_;
  for (const auto& [number, error] : errors) {
    double follows = 0, deformed = 0;
    std::vector<std::size_t> members;
    std::vector<geometry::Motion> supports;  // of its soft bodies
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      if (group[b] == number && bodies_[b].soft && bases[b]) supports.push_back(*bases[b]);
    for (std::size_t b = 0; moves && b < bodies_.size(); ++b) {
      if (group[b] != number) continue;
      if (bodies_[b].soft && bodies_[b].supports > 1) follows = 1;
      deformed =
          std::max(deformed, bodies_[b].soft ? this->deformed(bodies_[b], bases[b], displacement) : carried(bodies_[b], supports, displacement));
      members.push_back(b);
    }
    for (const LayerError::Travel& t : travels)
      for (const std::size_t b : t.bodies)
        if (b < bodies_.size() && group[b] == number) follows = std::max(follows, t.stiffness());
    const double way = this->way(members, bases, displacement), moved = way > deformed ? deformed / way : 1;
    worst = std::fmax(worst, error * std::max(follows, moved));
    if (const auto bends = bending.find(number); bends != bending.end())
      worst = std::max(worst, bends->second * (1 - std::min(follows, 1.0)) * moved);
  }
  return worst;
}

double StiffnessError::layer_over_way(const LayerError::Samples& samples, const Bases& bases, std::span<const double> displacement) const {
  if (displacement.size() != 3 * points_) return NAN;
  struct Pair {
    double force = 0, work = 0;
  };
  std::map<std::pair<std::size_t, std::size_t>, Pair> pairs;
  for (std::size_t i = 0; i < samples.force.size(); ++i) {
    Pair& pair = pairs[{static_cast<std::size_t>(samples.bodies[2 * i]), static_cast<std::size_t>(samples.bodies[2 * i + 1])}];
    pair.force += samples.force[i], pair.work += samples.force[i] * samples.gap[i];
  }
  double worst = NAN;
  for (const auto& [both, pair] : pairs) {
    if (!(pair.force > 0)) continue;
    bool noticeably = false;
    std::vector<std::size_t> members;
    for (const std::size_t b : {both.first, both.second}) {
      if (b >= bodies_.size()) continue;
      const Body& body = bodies_[b];
      noticeably |= body.soft && deformed(body, bases[b], displacement) > tuning::kNoticeably * body.thickness;
      members.push_back(b);
    }
    const double gap = pair.work / pair.force, way = this->way(members, bases, displacement);
    if (noticeably && way > 0) worst = std::fmax(worst, gap / (way + gap));
  }
  return worst;
}

}  // namespace mortise::audit
