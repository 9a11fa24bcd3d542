#include "geometry/collide/bvh.h"

#include <utility>
#include <vector>

#include "geometry/collide/tuning.h"

namespace mortise::geometry {
namespace {

using device::Buffer;
using device::View;

struct Extent {
  double lo[3], hi[3];
};

struct Widen {
  MORTISE_HD static Extent start() { return {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}}; }
  MORTISE_HD void take(Extent& e, const Extent& o) const {
    for (int d = 0; d < 3; ++d) {
      e.lo[d] = o.lo[d] < e.lo[d] ? o.lo[d] : e.lo[d];
      e.hi[d] = o.hi[d] > e.hi[d] ? o.hi[d] : e.hi[d];
    }
  }
};

// One extent per chunk of extents.
template <class Term>
void widen(Index n, Term extent, Buffer<Extent>& out) {
  constexpr Index kSpan = 256;
  out.resize((n - 1) / kSpan + 1);
  const View<Extent> all = out.view();
  device::fold(
      "bvh.bounds", all.n, [=] MORTISE_HD(Index c, Index & from, Index & to) { from = c * kSpan, to = n - from < kSpan ? n : from + kSpan; }, extent,
      Widen(), [=] MORTISE_HD(Index c, const Extent& e) { all[c] = e; });
}

// Bounds of the positions that primitives refer to, left in all[0].
void bounds(const Primitives& p, View<const Vec3> y, Buffer<Extent>& all) {
  const Index* v = p.v;
  const int corners = p.corners;
  const auto of_primitive = [=] MORTISE_HD(Index i) {
    const Vec3& x = y[v[i * corners]];
    return Extent{{x[0], x[1], x[2]}, {x[0], x[1], x[2]}};
  };
  widen(p.n, of_primitive, all);
  Buffer<Extent> fewer;
  while (all.size() > 1) {
    const View<const Extent> wide = std::as_const(all).view();
    widen(
        wide.n, [=] MORTISE_HD(Index k) { return wide[k]; }, fewer);
    all.swap(fewer);
  }
}

// Orders primitives by environment, then along a Morton curve through their centroids.
void morton_order(const Primitives& p, const SurfaceView& s, Index environments, View<const Vec3> y, Buffer<Index>& order) {
  Buffer<Extent> all;
  bounds(p, y, all);
  int env_bits = 0;
  while ((Index{1} << env_bits) < environments && env_bits < 30) ++env_bits;
  const int bits = (63 - env_bits) / 3 < 16 ? (63 - env_bits) / 3 : 16;  // per axis; more only lengthens the sort
  const double cells = static_cast<double>(1 << bits);
  const Index* v = p.v;
  const int corners = p.corners;
  const View<const Index> env = s.env;
  Buffer<std::uint64_t> keys(p.n);
  order.resize(p.n);
  const View<std::uint64_t> k = keys.view();
  const View<Index> o = order.view();
  const View<const Extent> whole = all.view();
  device::parallel_for("bvh.morton", p.n, [=] MORTISE_HD(Index i) {
    const Extent& e = whole[0];
    // The same cell size on every axis: cells as wide as thin scenes are flat would make slabs of the nodes.
    double extent = 0;
    for (int d = 0; d < 3; ++d) extent = e.hi[d] - e.lo[d] > extent ? e.hi[d] - e.lo[d] : extent;
    const double scale = extent > 0 ? cells / extent : 0;
    const Vec3 lo(e.lo[0], e.lo[1], e.lo[2]);
    const Index point = v[i * corners];
    Vec3 f = y[point];
    for (int c = 1; c < corners; ++c) f += y[v[i * corners + c]];
    f = (f / corners - lo) * scale;
    std::uint64_t key = 0;
    for (int d = 0; d < 3; ++d) {
      // Written so that NaN lands in cell 0.
      const std::uint64_t cell = f[d] > 0 ? static_cast<std::uint64_t>(f[d] < cells - 1 ? f[d] : cells - 1) : 0;
      for (int b = 0; b < bits; ++b) key |= (cell >> b & 1) << (3 * b + d);
    }
    k[i] = static_cast<std::uint64_t>(env[point]) << (3 * bits) | key;
    o[i] = i;
  });
  device::sort_pairs(keys, order, 3 * bits + env_bits);
}

// First leaf of every environment, and their number.
void first_leaves(const Primitives& p, const SurfaceView& s, Index environments, const Buffer<Index>& order, Buffer<Index>& first) {
  first.resize(environments + 1);
  const View<Index> out = first.view();
  const View<const Index> leaf = order.view(), env = s.env;
  const Index* v = p.v;
  const int corners = p.corners;
  device::parallel_for("bvh.environments", leaf.n, [=] MORTISE_HD(Index i) {
    const Index here = env[v[leaf[i] * corners]];
    for (Index e = i > 0 ? env[v[leaf[i - 1] * corners]] + 1 : 0; e <= here; ++e) out[e] = i;
    for (Index e = here + 1; i == leaf.n - 1 && e < out.n; ++e) out[e] = leaf.n;
  });
}

// Leaves lie in order of environment, as many of each as it has primitives.
void build_leaves(const Primitives& p, const SurfaceView& s, const device::Ranges& whose, View<const Index> order, View<const Vec3> y,
                  View<const Vec3> dy, Growth growth, View<BvhNode> nodes) {
  const Index* v = p.v;
  const int corners = p.corners;
  device::parallel_for("bvh.leaves", whose, [=] MORTISE_HD(Index i) {
    const Index* corner = v + order[i] * corners;
    nodes[i] = swept_box(corner, corners, order[i], s, y, dy, growth.of(order[i], s.env[corner[0]]));
  });
}

void build_level(View<BvhNode> nodes, Index from, Index count, Index to, Index n) {
  device::parallel_for("bvh.level", n, [=] MORTISE_HD(Index i) {
    BvhNode b = nodes[from + 4 * i];
    const Index end = 4 * i + 4 < count ? 4 * i + 4 : count;
    for (Index c = 4 * i + 1; c < end; ++c) {
      const BvhNode& o = nodes[from + c];
      for (int d = 0; d < 3; ++d) {
        b.lo[d] = o.lo[d] < b.lo[d] ? o.lo[d] : b.lo[d];
        b.hi[d] = o.hi[d] > b.hi[d] ? o.hi[d] : b.hi[d];
      }
      b.env_lo = o.env_lo < b.env_lo ? o.env_lo : b.env_lo;
      b.env_hi = o.env_hi > b.env_hi ? o.env_hi : b.env_hi;
      b.body = o.body == b.body ? b.body : -1;
      b.id = o.id > b.id ? o.id : b.id;
    }
    nodes[to + i] = b;
  });
}

}  // namespace

void Bvh::update(const Primitives& p, const SurfaceView& surface, Index environments, View<const Vec3> y, View<const Vec3> dy, Growth growth,
                 const device::Ranges* whose) {
  if (p.n == 0) {
    shape_.levels = 0;
    return;
  }
  const bool anew = age_ < 0 || age_ >= tuning::kReorderEvery;
  if (anew) {
    morton_order(p, surface, environments, y, order_);
    if (age_ < 0) first_leaves(p, surface, environments, order_, env_first_);
    age_ = 0;
  }
  age_ += whose ? static_cast<double>(whose->size()) / p.n : 1;
  Index total = 0, n = p.n;
  shape_.levels = 0;
  for (;; n = (n + 3) / 4) {
    shape_.start[shape_.levels] = total;
    shape_.size[shape_.levels++] = n;
    total += n;
    if (n == 1) break;
  }
  nodes_.resize(total);
  const View<BvhNode> nodes = nodes_.view();
  // Leaves that change places need their boxes, whoever they belong to.
  build_leaves(p, surface, anew || !whose ? device::Ranges{0, p.n} : *whose, order_.view(), y, dy, growth, nodes);
  for (int l = 1; l < shape_.levels; ++l) build_level(nodes, shape_.start[l - 1], shape_.size[l - 1], shape_.start[l], shape_.size[l]);
}

BvhView Bvh::view() const {
  BvhView v = shape_;
  v.nodes = nodes_.view(), v.env_first = env_first_.view();
  return v;
}

}  // namespace mortise::geometry
