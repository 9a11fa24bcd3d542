#include "geometry/collide/near_pairs.h"

#include <utility>

#include "base/error.h"

namespace mortise::geometry {
namespace {

using device::Buffer;
using device::View;

// Pairs counted by query, and on their way to the host.
struct Counted {
  std::vector<double> exact{0.0};  // a sum that cannot overflow
  Buffer<Index> bounds;
};

// Turns counts into offsets, and wants to know those of the environments.
void add_up(Buffer<Index>& counts, View<const Index> env_first, Counted& found, std::vector<Index>& env_offset, device::Fetch& fetch) {
  const View<const Index> count = std::as_const(counts).view();
  device::env_sum(
      "broadphase.total", {0, count.n - 1}, [=] MORTISE_HD(Index i) { return static_cast<double>(count[i]); }, device::EnvValues{found.exact, fetch});
  device::scan(counts);
  found.bounds.resize(env_first.n);
  const View<Index> out = found.bounds.view();
  device::parallel_for("broadphase.env_offset", env_first.n, [=] MORTISE_HD(Index e) { out[e] = count[env_first[e]]; });
  fetch.add(View<const Index>(out), env_offset);
}

void check_countable(const Counted& found) {
  if (found.exact[0] > 2147483647.0) throw Error(Exit::device, "too many contact candidates: a bounding radius or a step is far too large for the mesh");
}

}  // namespace

void NearPairs::add_up(Buffer<Index>& pt_counts, View<const Index> pt_first, Buffer<Index>& ee_counts, View<const Index> ee_first) {
  Counted pt, ee;
  device::Fetch fetch;
  geometry::add_up(pt_counts, pt_first, pt, pt_env_offset, fetch);
  geometry::add_up(ee_counts, ee_first, ee, ee_env_offset, fetch);
  fetch.now();
  check_countable(pt);
  check_countable(ee);
  point_triangles.resize(pt_env_offset.back());
  edge_edges.resize(ee_env_offset.back());
}

}  // namespace mortise::geometry
