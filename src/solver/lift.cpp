#include "solver/lift.h"

#include <utility>

#include "geometry/quadratic.h"

namespace mortise::solver {
namespace {

[[noreturn]] void unlike(const std::string& body) {
  throw Error(Exit::usage, "the meshes of '" + body + "' have nothing to do with each other: displacements cannot be told from one to the other");
}

// Bodies that move or are held, in the order of the model's.
std::vector<const model::BodyInput*> moving(const model::ModelInput& input) {
  std::vector<const model::BodyInput*> out;
  for (const model::BodyInput& body : input.bodies)
    if (body.type != model::BodyType::half_space) out.push_back(&body);
  return out;
}

}  // namespace

Lift::Lift(const model::Model& from, const model::Model& to) {
  const std::vector<const model::BodyInput*> a = moving(from.input), b = moving(to.input);
  if (a.size() != b.size()) throw Error(Exit::usage, "there are other bodies: displacements cannot be told from one to the other");
  std::vector<Index> first, second;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const model::Body &x = from.bodies[i], &y = to.bodies[i];
    const Index blocks = x.block_end - x.block_begin;
    if (x.type != y.type || (x.type == model::BodyType::soft && a[i]->tets.size() != b[i]->tets.size())) unlike(x.name);
    for (Index k = 0; k < y.block_end - y.block_begin; ++k) first.push_back(k < blocks ? x.block_begin + k : -1), second.push_back(first.back());
    for (std::size_t t = 0; t < b[i]->tets.size(); ++t) {
      const Tet& corners = b[i]->tets[t];
      for (int k = 0; k < 4; ++k)
        if (corners.v[k] != a[i]->tets[t].v[k]) unlike(x.name);
      if (b[i]->midsides.empty() || !a[i]->midsides.empty()) continue;
      for (int e = 0; e < 6; ++e) {
        const Index middle = y.block_begin + b[i]->midsides[t].v[e];
        first[middle] = x.block_begin + corners.v[geometry::edge_begin(e)], second[middle] = x.block_begin + corners.v[geometry::edge_end(e)];
      }
    }
    for (Index k = y.block_begin; k < y.block_end; ++k)
      if (first[k] < 0) unlike(x.name);
  }
  const std::vector<Vec3> rest = from.rest.download(), there = to.rest.download();
  std::vector<Vec3> at_rest;
  for (std::size_t k = 0; k < there.size(); ++k) at_rest.push_back(there[k] - 0.5 * (rest[first[k]] + rest[second[k]]));
  first_.upload(first), second_.upload(second), at_rest_.upload(at_rest);
}

void Lift::apply(device::View<const Vec3> q, device::Buffer<Vec3>& out) const {
  out.resize(at_rest_.size());
  const device::View<const Index> a = first_.view(), b = second_.view();
  const device::View<const Vec3> rest = at_rest_.view();
  const device::View<Vec3> to = out.view();
  device::parallel_for("solver.lift", to.n, [=] MORTISE_HD(Index k) { to[k] = rest[k] + 0.5 * (q[a[k]] + q[b[k]]); });
}

}  // namespace mortise::solver
