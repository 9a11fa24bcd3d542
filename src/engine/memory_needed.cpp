#include "engine/memory_needed.h"

#include <algorithm>

#include "effects/list.h"
#include "effects/roles.h"
#include "model/volumetric.h"

namespace mortise::engine {
namespace {

// A little above the peaks of the runs in benchmarks/gpu/README.md (`linear: cg`, run.json). Per element: its stencil (10 or 55 pieces of
// 3x3), the sorting of these, and its share of the matrix, of block Jacobi and of fields; per node: the additive Schwarz preconditioner.
constexpr double kPerTet = 1850, kPerQuadraticTet = 13800, kPerContactTriangle = 550, kPerNode = 1500;  // [B]
// Where something is frozen (mortar contact, friction) forces are found at states beside the present one as well: pieces of forces, and their
// sorting.
constexpr double kBesidePerTet = 250, kBesidePerQuadraticTet = 650;  // [B]
// Of a linear tetrahedron whose change of volume is averaged: its share of a piece per pair of nodes of the cluster, and of the wider matrix.
constexpr double kPerAveragedTet = 1000;  // [B]
// Of a linear tetrahedron of a body that supports do not hold where it is, whose masses are not lumped: its share of a piece per edge.
constexpr double kPerMovingTet = 650;  // [B]

// Does a support hold the body where it is, for good?
bool stays(const Params& wanted, const std::string& body) {
  const auto entries = effects::of_body(wanted, effects::Role::support, body);
  return std::any_of(entries.begin(), entries.end(), [](const Params* p) { return !p->has("motion") && !p->has("release"); });
}

}  // namespace

std::size_t memory_needed(const model::ModelInput& input) {
  const Params& wanted = input.scene.at("effects");
  const bool contact = !effects::of_role(wanted, effects::Role::contact).empty();
  const bool schwarz = input.scene.at("solver").text("preconditioner") != "jacobi";
  const bool moves = !effects::of_role(wanted, effects::Role::inertia).empty();
  bool beside = false;
  for (const auto& [name, block] : wanted.entries())
    if (const effects::Kind* kind = effects::find_kind(name)) beside = beside || !kind->symmetric;
  double bytes = 0;
  for (const model::BodyInput& b : input.bodies) {
    if (beside) bytes += (b.midsides.empty() ? kBesidePerTet : kBesidePerQuadraticTet) * static_cast<double>(b.tets.size());
    if (!b.tets.empty() && b.midsides.empty() && model::averages_volume(b)) bytes += kPerAveragedTet * static_cast<double>(b.tets.size());
    if (moves && b.midsides.empty() && !stays(wanted, b.name)) bytes += kPerMovingTet * static_cast<double>(b.tets.size());
    bytes += (b.midsides.empty() ? kPerTet : kPerQuadraticTet) * static_cast<double>(b.tets.size());
    if (contact) bytes += kPerContactTriangle * static_cast<double>(b.triangles.size());
    if (schwarz && !b.tets.empty()) bytes += kPerNode * static_cast<double>(b.nodes.size());
  }
  return static_cast<std::size_t>(bytes);
}

}  // namespace mortise::engine
