#include "geometry/collide/broadphase.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/collide/tuning.h"

namespace mortise::geometry {
namespace {

using device::Buffer;
using device::View;

// Largest |y - from| + |dy|, without `from` |dy|.
double farthest(View<const Vec3> from, View<const Vec3> y, View<const Vec3> dy) {
  std::vector<double> out{0};
  device::Fetch fetch;
  device::env_max(
      "broadphase.farthest", {0, y.n},
      [=] MORTISE_HD(Index i) {
        return (from.n > 0 ? (y[i] - from[i]).norm() : 0.0) + (dy.n > 0 ? dy[i].norm() : 0.0) + tuning::kCoordinate * y[i].norm();
      },
      device::EnvValues{out, fetch});
  fetch.now();
  return out[0];
}

// The pairs of `from` among `whose` whose swept boxes overlap; `counts`: scratch.
template <class Pair, class Near>
void mark(const char* name, const Buffer<Pair>& from, const device::Ranges& whose, Buffer<Index>& counts, Near near) {
  counts.resize(from.size() + 1);
  if (whose.size() < from.size()) counts.zero();
  const View<Index> count = counts.view();
  const View<const Pair> pair = from.view();
  device::parallel_for(name, whose, [=] MORTISE_HD(Index i) { count[i] = near(pair[i]) ? 1 : 0; });
}

// Are all of `some` among `most`? Empty: all environments.
bool all_among(const std::vector<std::uint8_t>& some, const std::vector<std::uint8_t>& most) {
  for (std::size_t e = 0; e < most.size(); ++e)
    if (!most[e] && (some.empty() || some[e])) return false;
  return true;
}

template <class Pair>
void compact(const char* name, const Buffer<Pair>& from, const Buffer<Index>& counts, Buffer<Pair>& to) {
  const View<const Index> at = counts.view();
  const View<const Pair> pair = from.view();
  const View<Pair> out = to.view();
  device::parallel_for(name, pair.n, [=] MORTISE_HD(Index i) {
    if (at[i + 1] > at[i]) out[at[i]] = pair[i];
  });
}

// The pairs that a search at (y, dy) finds, out of those kept.
void pick(const SurfaceView& surface, const NearPairs& kept, View<const Vec3> y, View<const Vec3> dy, double radius,
          const std::vector<std::uint8_t>& whose, NearPairs& found) {
  const SurfaceView s = surface;
  const double grow = radius / 2;
  Buffer<Index> pt_counts, ee_counts;
  mark("broadphase.near_point_triangle", kept.point_triangles, {kept.pt_env_offset, whose}, pt_counts, [=] MORTISE_HD(const PointTriangle& p) {
    if (!boxes_overlap(swept_box(p.v, 1, 0, s, y, dy, grow), swept_box(p.v + 1, 3, 0, s, y, dy, grow))) return false;
    return s.body[p.v[0]] != s.body[p.v[1]] || !stay_apart(p.v, 1, y, dy, radius);
  });
  mark("broadphase.near_edge_edge", kept.edge_edges, {kept.ee_env_offset, whose}, ee_counts, [=] MORTISE_HD(const EdgeEdge& p) {
    if (!boxes_overlap(swept_box(p.v, 2, 0, s, y, dy, grow), swept_box(p.v + 2, 2, 0, s, y, dy, grow))) return false;
    return s.body[p.v[0]] != s.body[p.v[2]] || !stay_apart(p.v, 2, y, dy, radius);
  });
  found.add_up(pt_counts, kept.pt_env_first.view(), ee_counts, kept.ee_env_first.view());
  compact("broadphase.pick_point_triangle", kept.point_triangles, pt_counts, found.point_triangles);
  compact("broadphase.pick_edge_edge", kept.edge_edges, ee_counts, found.edge_edges);
}

}  // namespace

Broadphase::Broadphase(const Surface& surface) : surface_(surface), search_(surface) {
  found_.pt_env_offset.assign(search_.environments() + 1, 0);
  found_.ee_env_offset = found_.pt_env_offset;
}

void Broadphase::update(View<const Vec3> y, View<const Vec3> dy, double radius, const std::vector<std::uint8_t>& whose) {
  const auto answer = [&] { pick(surface_.view(), kept_, y, dy, radius, whose, found_); };
  if (kept_radius_ >= radius && all_among(whose, kept_whose_) && radius + 2 * farthest(std::as_const(kept_at_).view(), y, dy) <= kept_radius_)
    return answer();
  ++searches_;
  const double more = dy.n > 0 ? tuning::kSurplus * farthest({}, y, dy) : INFINITY;
  if (!(more <= most_surplus(y))) return search_.find(y, dy, radius, whose, found_);
  search_.find(y, {}, radius + more, whose, kept_);
  kept_radius_ = radius + more;
  kept_whose_ = whose;
  kept_at_.resize(y.n);
  device::copy(kept_at_.view().p, y.p, static_cast<std::size_t>(y.n) * sizeof(Vec3));
  answer();
}

double Broadphase::most_surplus(View<const Vec3> y) {
  if (most_surplus_ >= 0) return most_surplus_;
  std::vector<double> length(surface_.pairs.bodies(), 0.0), count(surface_.pairs.bodies(), 0.0);
  const std::vector<Index> body = surface_.body.download();
  std::vector<Vec3> at(y.n);
  device::copy_out(at.data(), y.p, at.size() * sizeof(Vec3));
  for (const Edge& e : surface_.edges.download()) length[body[e.v[0]]] += (at[e.v[0]] - at[e.v[1]]).norm(), count[body[e.v[0]]] += 1;
  double finest = INFINITY;
  for (Index b = 0; b < surface_.pairs.bodies(); ++b)
    if (count[b] > 0) finest = std::min(finest, length[b] / count[b]);
  return most_surplus_ = std::isfinite(finest) ? tuning::kLargestSurplus * finest : 0;
}

}  // namespace mortise::geometry
