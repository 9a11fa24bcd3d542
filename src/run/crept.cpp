#include "run/crept.h"

#include <algorithm>
#include <cmath>

#include "effects/friction/creep.h"
#include "effects/roles.h"
#include "geometry/bounds.h"
#include "run/tuning.h"
#include "run/vector_at.h"

namespace mortise::run {

namespace {

// Bodies of every sample, in the order of friction's rows: those that press, then those of a guard.
std::vector<double> bodies_of(const Snapshot& said, const std::string& contact) {
  std::vector<double> out;
  for (const char* rows : {"/bodies", "/guard_bodies"})
    if (const auto it = said.row.find(contact + rows); it != said.row.end()) out.insert(out.end(), it->second.begin(), it->second.end());
  return out;
}

}  // namespace

Crept::Crept(const model::ModelInput& input) {
  const Params& effects = input.scene.at("effects");
  for (const std::string& name : effects::of_role(effects, effects::Role::follower))
    laws_[name] = {effects::friction::creep_speed(effects.at(name), input), effects.at(name).has("follows") ? effects.at(name).text("follows") : ""};
  std::size_t first = 0;
  for (const model::BodyInput& body : input.bodies) {
    if (body.type == model::BodyType::half_space) continue;
    bodies_.push_back({first, body.nodes.size(), body.nodes.empty() ? INFINITY : geometry::bounds_of(body.nodes).size().norm()});
    first += body.nodes.size();
  }
}

double Crept::speed() const {
  double out = NAN;
  for (const auto& [effect, law] : laws_) out = std::fmax(out, law.speed);
  return out;
}

void Crept::state(const Snapshot& said) {
  for (auto& [bodies, pair] : pairs_) pair.now = 0;
  for (const auto& [effect, law] : laws_) creeps(effect, law, said);
  if (const Snapshot::Values* u = said.of_points("displacement", 3))
    for (auto& [bodies, pair] : pairs_) pair.far = std::max(pair.far, farthest(bodies, *u));
}

void Crept::creeps(const std::string& effect, const Law& law, const Snapshot& said) {
  const auto force = said.row.find(effect + "/force"), slip = said.row.find(effect + "/slip");
  if (force == said.row.end() || slip == said.row.end()) return;
  const std::vector<double> bodies = bodies_of(said, law.follows);
  const std::size_t samples = force->second.size() / 3;
  if (bodies.size() != 2 * samples) return;
  struct Sum {
    double force = 0, work = 0;  // [N], [J]
  };
  std::map<Bodies, Sum> sums;
  double work = 0;
  for (std::size_t i = 0; i < samples; ++i) {
    const Vec3 F = at(force->second, i);
    const double taken = -F.dot(at(slip->second, i));
    Sum& of = sums[std::minmax(static_cast<std::size_t>(bodies[2 * i]), static_cast<std::size_t>(bodies[2 * i + 1]))];
    of.force += F.norm(), of.work += taken, work += taken;
  }
  const double rate = work > 0 ? said.at(effect + "/power") / work : 0;  // [1/s]
  for (const auto& [of, sum] : sums) {
    Pair& pair = pairs_[of];
    const double slips = sum.force > 0 ? rate * sum.work / sum.force : 0;
    if (slips < law.speed) pair.now = std::max(pair.now, slips);
  }
}

double Crept::farthest(const Bodies& bodies, const Snapshot::Values& displacement) const {
  std::vector<Body> two;
  std::vector<Vec3> gone;  // each on the whole
  for (const std::size_t b : {bodies.first, bodies.second}) {
    const Body& body = two.emplace_back(b < bodies_.size() ? bodies_[b] : Body{});
    Vec3& mean = gone.emplace_back(Vec3::Zero());
    for (std::size_t i = body.first; i < body.first + body.count; ++i) mean += at(displacement, i) / static_cast<double>(body.count);
  }
  double far = 0;
  for (const Vec3& with : gone)
    for (const Body& body : two)
      for (std::size_t i = body.first; i < body.first + body.count; ++i) far = std::max(far, (at(displacement, i) - with).norm());
  return far;
}

void Crept::step(double dt) {
  for (auto& [bodies, pair] : pairs_) pair.crept += pair.now * dt;
}

double Crept::share() const {
  if (laws_.empty()) return NAN;
  double most = 0;
  for (const auto& [bodies, pair] : pairs_) {
    double size = INFINITY;
    for (const std::size_t b : {bodies.first, bodies.second})
      if (b < bodies_.size()) size = std::min(size, bodies_[b].size);
    most = std::max(most, pair.crept / std::max(pair.far, tuning::kStill * size));
  }
  return most;
}

void Crept::checkpoint(Archive& archive) {
  std::vector<double> values;
  for (const auto& [bodies, pair] : pairs_)
    for (const double v : {static_cast<double>(bodies.first), static_cast<double>(bodies.second), pair.crept, pair.far}) values.push_back(v);
  archive.io("crept.pairs", values);
  if (!archive.loading()) return;
  pairs_.clear();
  for (std::size_t i = 0; i + 3 < values.size(); i += 4)
    pairs_[{static_cast<std::size_t>(values[i]), static_cast<std::size_t>(values[i + 1])}] = {values[i + 2], values[i + 3], 0};
}

}  // namespace mortise::run
