#include "run/stiffness_error.h"

#include <algorithm>
#include <cmath>

#include "geometry/rigid_motion.h"
#include "run/entries.h"
#include "run/vector_at.h"

namespace mortise::run {

StiffnessError::StiffnessError(const model::ModelInput& input) {
  std::map<std::string, int> supports;
  for (const auto& [effect, keys] :
       std::map<const char*, std::vector<const char*>>{{"pin", {"body"}}, {"bond", {"body"}}, {"mortar_tie", {"body", "to"}}})
    for (const Params& p : entries(input.scene.at("effects"), effect))
      for (const char* key : keys) ++supports[p.text(key)];
  for (const model::BodyInput& in : input.bodies) {
    if (in.type == model::BodyType::half_space) continue;
    bodies_.push_back({points_, in.nodes, in.type == model::BodyType::soft, supports[in.name]});
    points_ += in.nodes.size();
  }
}

double StiffnessError::deformed(const Body& body, std::optional<geometry::Motion> base, std::span<const double> displacement) {
  std::vector<Vec3> to;
  for (std::size_t i = 0; i < body.rest.size(); ++i) to.push_back(body.rest[i] + at(displacement, body.first + i));
  if (!base) base = geometry::fixes_a_frame(body.rest) ? geometry::nearest_motion(body.rest, to) : geometry::Motion{};
  double farthest = 0;
  for (std::size_t i = 0; i < to.size(); ++i) farthest = std::max(farthest, (to[i] - base->R * body.rest[i] - base->t).norm());
  return farthest;
}

double StiffnessError::way(const Body& body, std::span<const double> displacement) {
  double farthest = 0;
  for (std::size_t i = 0; i < body.rest.size(); ++i) farthest = std::max(farthest, at(displacement, body.first + i).norm());
  return farthest;
}

double StiffnessError::of(const std::map<std::size_t, double>& errors, const std::vector<std::size_t>& group,
                          const std::vector<LayerError::Travel>& travels, const Bases& bases, std::span<const double> displacement) const {
  double worst = NAN;
  const bool moves = displacement.size() == 3 * points_;
  for (const auto& [number, error] : errors) {
    double follows = 0, deformed = 0, way = 0;
    for (std::size_t b = 0; moves && b < bodies_.size(); ++b) {
      if (group[b] != number) continue;
      if (bodies_[b].soft && bodies_[b].supports > 1) follows = 1;
      if (bodies_[b].soft) deformed = std::max(deformed, this->deformed(bodies_[b], bases[b], displacement));
      way = std::max(way, this->way(bodies_[b], displacement));
    }
    for (const LayerError::Travel& t : travels)
      for (const std::size_t b : t.bodies)
        if (b < bodies_.size() && group[b] == number) follows = std::max(follows, t.stiffness());
    worst = std::fmax(worst, error * std::max(follows, way > deformed ? deformed / way : 1));
  }
  return worst;
}

}  // namespace mortise::run
