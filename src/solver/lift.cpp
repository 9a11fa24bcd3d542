#include "solver/lift.h"

#include <utility>

#include "geometry/refine.h"

namespace mortise::solver {
namespace {

using Weights = std::vector<std::pair<Index, double>>;

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

Index node_of(const model::BodyInput& body, std::size_t tet, int k) { return k < 4 ? body.tets[tet].v[k] : body.midsides[tet].v[k - 4]; }

// Of every node of b by those of a.
std::vector<Weights> weights_of(const model::BodyInput& a, const model::BodyInput& b) {
  std::vector<Weights> out(b.nodes.size());
  const bool quadratic = !a.midsides.empty(), cut = b.tets.size() != a.tets.size();
  if (a.tets.empty() || b.tets.size() != (cut ? geometry::kChildren : 1) * a.tets.size() || (cut && !quadratic)) unlike(a.name);
  for (std::size_t t = 0; t < b.tets.size(); ++t) {
    const std::size_t parent = cut ? t / geometry::kChildren : t;
    double corner[4][4];
    for (int k = 0; k < 4; ++k) {
      const int node = cut ? geometry::child_node(static_cast<int>(t % geometry::kChildren), k) : k;
      if (b.tets[t].v[k] != node_of(a, parent, node)) unlike(a.name);
      geometry::tet_node(node, corner[k]);
      out[b.tets[t].v[k]] = {{b.tets[t].v[k], 1.0}};
    }
    if (b.midsides.empty()) continue;
    for (int e = 0; e < 6; ++e) {
      Weights& w = out[b.midsides[t].v[e]];
      if (!w.empty()) continue;
      if (quadratic && !cut) {
        if (b.midsides[t].v[e] != a.midsides[parent].v[e]) unlike(a.name);
        w = {{b.midsides[t].v[e], 1.0}};
        continue;
      }
      double l[4];
      for (int k = 0; k < 4; ++k) l[k] = 0.5 * (corner[geometry::edge_begin(e)][k] + corner[geometry::edge_end(e)][k]);
      for (int k = 0; k < (quadratic ? 10 : 4); ++k)
        if (const double N = quadratic ? geometry::tet_shape_function(k, l) : l[k]; N != 0) w.emplace_back(node_of(a, parent, k), N);
    }
  }
  return out;
}

}  // namespace

Lift::Lift(const model::Model& from, const model::Model& to) {
  const std::vector<const model::BodyInput*> a = moving(from.input), b = moving(to.input);
  if (a.size() != b.size()) throw Error(Exit::usage, "there are other bodies: displacements cannot be told from one to the other");
  const std::vector<Vec3> rest = from.rest.download(), there = to.rest.download();
  std::vector<Vec3> at_rest;
  transposed_.of.resize(rest.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    const model::Body &x = from.bodies[i], &y = to.bodies[i];
    if (x.type != y.type) unlike(x.name);
    std::vector<Weights> of;
    if (x.type == model::BodyType::soft)
      of = weights_of(*a[i], *b[i]);
    else
      for (Index k = 0; k < y.block_end - y.block_begin; ++k) of.push_back({{k, 1.0}});
    for (const Weights& w : of) {
      if (w.empty()) unlike(x.name);
      const auto row = static_cast<Index>(at_rest.size());
      Vec3 Q = there[row];
      N_.of.emplace_back();
      for (const auto& [node, N] : w) {
        const Index block = x.block_begin + node;
        N_.of.back().emplace_back(block, N), transposed_.of[block].emplace_back(row, N), Q -= N * rest[block];
      }
      at_rest.push_back(Q);
    }
  }
  N_.upload(), transposed_.upload(), at_rest_.upload(at_rest);
}

void Lift::Rows::upload() {
  std::vector<Index> first{0}, blocks;
  std::vector<double> weights;
  for (const auto& row : of) {
    for (const auto& [b, w] : row) blocks.push_back(b), weights.push_back(w);
    first.push_back(static_cast<Index>(blocks.size()));
  }
  offset.upload(first), block.upload(blocks), weight.upload(weights);
  of.clear();
}

void Lift::Rows::product(device::View<const Vec3> x, device::View<const Vec3> plus, device::Buffer<Vec3>& out) const {
  out.resize(offset.size() - 1);
  const device::View<const Index> first = offset.view(), at = block.view();
  const device::View<const double> w = weight.view();
  const device::View<Vec3> to = out.view();
  device::parallel_for("solver.lift", to.n, [=] MORTISE_HD(Index i) {
    Vec3 sum = plus.n > 0 ? plus[i] : Vec3(Vec3::Zero());
    for (Index k = first[i]; k < first[i + 1]; ++k) sum += w[k] * x[at[k]];
    to[i] = sum;
  });
}

void Lift::apply(device::View<const Vec3> q, device::Buffer<Vec3>& out) const { N_.product(q, at_rest_.view(), out); }
void Lift::along(device::View<const Vec3> d, device::Buffer<Vec3>& out) const { N_.product(d, {}, out); }
void Lift::transposed(device::View<const Vec3> f, device::Buffer<Vec3>& out) const { transposed_.product(f, {}, out); }

}  // namespace mortise::solver
