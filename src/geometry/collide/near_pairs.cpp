#include "geometry/collide/near_pairs.h"

#include <numeric>
#include <utility>

#include "base/error.h"

namespace mortise::geometry {
namespace {

using device::Buffer;
using device::View;

// Turns counts into offsets, and wants to know those of the environments, and their sums, which cannot overflow.
void add_up(const NearPairs::Counts& counts, std::vector<double>& exact, Buffer<Index>& bounds, std::vector<Index>& env_offset,
            device::Fetch& fetch) {
  const View<const Index> count = std::as_const(counts.of).view(), first = counts.first;
  exact.assign(first.n - 1, 0.0);
  device::env_sum(
      "broadphase.total", counts.queries, [=] MORTISE_HD(Index i) { return static_cast<double>(count[i]); }, device::EnvValues{exact, fetch});
  device::scan(counts.of);
  bounds.resize(first.n);
  const View<Index> out = bounds.view();
  device::parallel_for("broadphase.env_offset", first.n, [=] MORTISE_HD(Index e) { out[e] = count[first[e]]; });
  fetch.add(View<const Index>(out), env_offset);
}

void check_countable(double pairs) {
  if (pairs > 2147483647.0) throw Error(Exit::device, "too many contact candidates: a bounding radius or a step is far too large for the mesh");
}

// Where the pairs of every environment begin in what join() leaves.
std::vector<Index> joined(const std::vector<Index>& most, const std::vector<Index>& some, const std::vector<std::uint8_t>& whose) {
  std::vector<Index> out{0};
  double end = 0;
  for (std::size_t e = 0; e < whose.size(); ++e) {
    const std::vector<Index>& of = whose[e] ? some : most;
    end += of[e + 1] - of[e];
    check_countable(end);
    out.push_back(static_cast<Index>(end));
  }
  return out;
}

template <class Pair>
void copy_pairs(const char* name, View<const Index> env_of_point, View<const Pair> from, const device::Ranges& whose, View<const Index> first,
                View<const Index> to_first, View<Pair> to) {
  device::parallel_for(name, whose, [=] MORTISE_HD(Index i) {
    const Index e = env_of_point[from[i].v[0]];
    to[to_first[e] + (i - first[e])] = from[i];
  });
}

}  // namespace

void NearPairs::begin_add_up(const Counts& points, const Counts& edges, Sums& sums, device::Fetch& fetch) {
  geometry::add_up(points, sums.pt, pt_env_first, pt_env_offset, fetch);
  geometry::add_up(edges, sums.ee, ee_env_first, ee_env_offset, fetch);
}

void NearPairs::end_add_up(const Sums& sums) {
  for (const std::vector<double>* of : {&sums.pt, &sums.ee}) check_countable(std::accumulate(of->begin(), of->end(), 0.0));
  point_triangles.resize(pt_env_offset.back());
  edge_edges.resize(ee_env_offset.back());
}

void NearPairs::take_sizes(NearPairs& o) {
  pt_env_offset = std::move(o.pt_env_offset), ee_env_offset = std::move(o.ee_env_offset);
  pt_env_first.swap(o.pt_env_first), ee_env_first.swap(o.ee_env_first);
}

void NearPairs::add_up(const Counts& points, const Counts& edges) {
  Sums sums;
  device::Fetch fetch;
  begin_add_up(points, edges, sums, fetch);
  fetch.now("pairs");
  end_add_up(sums);
}

void NearPairs::resize(std::vector<Index> pt_offset, std::vector<Index> ee_offset) {
  pt_env_offset = std::move(pt_offset), ee_env_offset = std::move(ee_offset);
  pt_env_first.upload(pt_env_offset), ee_env_first.upload(ee_env_offset);
  point_triangles.resize(pt_env_offset.back()), edge_edges.resize(ee_env_offset.back());
}

void NearPairs::copy_from(const NearPairs& o) {
  point_triangles.copy_from(o.point_triangles), edge_edges.copy_from(o.edge_edges);
  pt_env_first.copy_from(o.pt_env_first), ee_env_first.copy_from(o.ee_env_first);
  pt_env_offset = o.pt_env_offset, ee_env_offset = o.ee_env_offset;
}

void join(const SurfaceView& surface, const NearPairs& most, const NearPairs& some, const std::vector<std::uint8_t>& whose, NearPairs& out) {
  std::vector<std::uint8_t> others;
  for (std::uint8_t one : whose) others.push_back(one ? 0 : 1);
  out.resize(joined(most.pt_env_offset, some.pt_env_offset, whose), joined(most.ee_env_offset, some.ee_env_offset, whose));
  const auto take = [&](const NearPairs& from, const std::vector<std::uint8_t>& of) {
    copy_pairs("broadphase.join_point_triangle", surface.env, from.point_triangles.view(), {from.pt_env_offset, of}, from.pt_env_first.view(),
               std::as_const(out.pt_env_first).view(), out.point_triangles.view());
    copy_pairs("broadphase.join_edge_edge", surface.env, from.edge_edges.view(), {from.ee_env_offset, of}, from.ee_env_first.view(),
               std::as_const(out.ee_env_first).view(), out.edge_edges.view());
  };
  take(most, others), take(some, whose);
}

}  // namespace mortise::geometry
