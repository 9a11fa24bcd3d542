#include "engine/memory_needed.h"

namespace mortise::engine {
namespace {

// Least squares over the peaks of these runs (`linear: cg`, run.json; benchmarks/gpu/README.md has the table). Per element: its
// stencil (10 or 55 pieces of 3x3), the sorting of these, and its share of the matrix, of the preconditioner and of fields.
constexpr double kPerTet = 1750, kPerQuadraticTet = 13100, kPerContactTriangle = 500;  // [B]

}  // namespace

std::size_t memory_needed(const model::ModelInput& input) {
  const Params& effects = input.scene.at("effects");
  const bool contact = effects.has("barrier_contact") || effects.has("mortar_contact");
  double bytes = 0;
  for (const model::BodyInput& b : input.bodies) {
    bytes += (b.midsides.empty() ? kPerTet : kPerQuadraticTet) * static_cast<double>(b.tets.size());
    if (contact) bytes += kPerContactTriangle * static_cast<double>(b.triangles.size());
  }
  return static_cast<std::size_t>(bytes);
}

}  // namespace mortise::engine
