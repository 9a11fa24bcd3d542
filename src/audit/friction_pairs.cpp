#include "audit/friction_pairs.h"

#include <algorithm>

#include "audit/vector_at.h"

namespace mortise::audit {

std::map<std::string, FrictionLaw> friction_laws(const model::ModelInput& input) {
  const Params& effects = input.scene.at("effects");
  std::map<std::string, FrictionLaw> out;
  for (const std::string& name : effects::of_role(effects, effects::Role::follower))
    out[name] = {effects::friction::creep(effects.at(name), input).speed, effects.at(name).has("follows") ? effects.at(name).text("follows") : ""};
  return out;
}

namespace {

Rubbing pairs_of(const std::string& effect, const FrictionLaw& law, const Snapshot& said) {
  const auto force = said.row.find(effect + "/force"), slip = said.row.find(effect + "/slip"), normal = said.row.find(effect + "/normal_force"),
             sticks = said.row.find(effect + "/sticks");
  if (force == said.row.end() || slip == said.row.end()) return {};
  // Bodies of every sample, in the order of friction's rows: those that press, then those of a guard.
  std::vector<double> bodies;
  for (const char* rows : {"/bodies", "/guard_bodies"})
    if (const auto it = said.row.find(law.follows + rows); it != said.row.end()) bodies.insert(bodies.end(), it->second.begin(), it->second.end());
  const std::size_t samples = force->second.size() / 3;
  if (bodies.size() != 2 * samples) return {};
  Rubbing out;
  double work = 0;
  for (std::size_t i = 0; i < samples; ++i) {
    const Vec3 F = at(force->second, i);
    const double taken = -F.dot(at(slip->second, i));
    FrictionPair& of = out[std::minmax(static_cast<std::size_t>(bodies[2 * i]), static_cast<std::size_t>(bodies[2 * i + 1]))];
    of.force += F.norm(), of.power += taken, work += taken;
    if (sticks != said.row.end() && sticks->second[i] != 0)
      of.stuck += taken;
    else
      of.slips += F, of.slid += F.norm();
    if (normal == said.row.end()) continue;
    const double N = normal->second[i];
    of.normal += N, of.pressed += N * at(slip->second, i).norm();
  }
  const double rate = work > 0 ? said.at(effect + "/power") / work : 0;  // [1/s]
  for (auto& [of, pair] : out) pair.power *= rate, pair.stuck *= rate, pair.pressed *= rate;
  return out;
}

}  // namespace

std::vector<Rubbing> rubbing(const std::map<std::string, FrictionLaw>& laws, const Snapshot& said) {
  std::vector<Rubbing> out;
  for (const auto& [effect, law] : laws) out.push_back(pairs_of(effect, law, said));
  return out;
}

}  // namespace mortise::audit
