#include "audit/bond_overlap.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "audit/entries.h"
#include "geometry/enclosure.h"
#include "model/bonded.h"

namespace mortise::audit {
namespace {

// Middles of equal parts of a tetrahedron.
std::vector<std::array<double, 4>> parts() {
  constexpr int n = 5;
  std::vector<std::array<double, 4>> out;
  for (int a = 0; a < n; ++a)
    for (int b = 0; a + b < n; ++b)
      for (int c = 0; a + b + c < n; ++c) out.push_back({(a + 0.25) / n, (b + 0.25) / n, (c + 0.25) / n, (n - 1 - a - b - c + 0.25) / n});
  return out;
}

// What lies inside of the stiff body, of the elements of the soft one of which a node is free.
std::vector<StrainEnergy::Place> overlap(const model::BodyInput& soft, const model::BodyInput& stiff, const std::vector<bool>& held) {
  const geometry::Enclosure around(stiff.nodes, stiff.triangles);
  const std::vector<std::array<double, 4>> each = parts();
  std::vector<StrainEnergy::Place> out;
  for (std::size_t t = 0; t < soft.tets.size(); ++t) {
    bool free = false;
    for (const Index v : soft.tets[t].v) free = free || !held[v];
    for (int k = 0; !soft.midsides.empty() && k < 6; ++k) free = free || !held[soft.midsides[t].v[k]];
    if (!free) continue;
    for (const std::array<double, 4>& l : each) {
      Vec3 x = Vec3::Zero();
      for (int k = 0; k < 4; ++k) x += l[k] * soft.nodes[soft.tets[t].v[k]];
      if (around.holds(x)) out.push_back({t, l, 1.0 / static_cast<double>(each.size())});
    }
  }
  return out;
}

}  // namespace

BondOverlap::BondOverlap(const model::ModelInput& input) {
  struct Of {
    const model::BodyInput* body;
    std::size_t first;
  };
  std::map<std::string, Of> named;
  std::size_t first = 0;
  for (const model::BodyInput& body : input.bodies) {
    if (body.type == model::BodyType::half_space) continue;
    named[body.name] = {&body, first};
    first += body.nodes.size();
  }
  const std::vector<Params> bonds = entries(input.scene.at("effects"), "bond");
  std::map<std::string, std::vector<bool>> held;  // by soft body
  for (const Params& bond : bonds) {
    const std::string soft = bond.text("body");
    held[soft].resize(named.at(soft).body->nodes.size());
    for (const Index i : model::bonded(bond, *named.at(soft).body, *named.at(bond.text("to")).body)) held[soft][i] = true;
  }
  std::map<std::string, std::vector<StrainEnergy::Place>> inside;
  for (const Params& bond : bonds) {
    const std::string soft = bond.text("body");
    const std::vector<StrainEnergy::Place> more = overlap(*named.at(soft).body, *named.at(bond.text("to")).body, held[soft]);
    inside[soft].insert(inside[soft].end(), more.begin(), more.end());
  }
  for (const auto& [name, places] : inside) {
    const Of& soft = named.at(name);
    if (!places.empty()) bodies_.push_back({{*soft.body, soft.first}, {*soft.body, soft.first, places}});
  }
}

void BondOverlap::state(const std::vector<double>& points) {
  for (Body& body : bodies_)
    if (const double all = body.all.at(points); all > body.most) body.most = all, body.inside_then = body.inside.at(points);
}

double BondOverlap::value() const {
  double most = NAN;
  for (const Body& body : bodies_)
    if (body.most > body.inside_then) most = std::fmax(most, body.inside_then / (body.most - body.inside_then));
  return most;
}

void BondOverlap::checkpoint(Archive& archive) {
  std::vector<double> values;
  for (const Body& body : bodies_) values.insert(values.end(), {body.most, body.inside_then});
  archive.io("bond_overlap", values);
  for (std::size_t i = 0; i < std::min(values.size() / 2, bodies_.size()); ++i)
    bodies_[i].most = values[2 * i], bodies_[i].inside_then = values[2 * i + 1];
}

}  // namespace mortise::audit
