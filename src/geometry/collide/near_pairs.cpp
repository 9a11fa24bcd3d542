#include "geometry/collide/near_pairs.h"

#include <utility>

#include "base/error.h"

namespace mortise::geometry {
namespace {

using device::Buffer;
using device::View;

using Exact = std::vector<double>;  // one sum that cannot overflow

// Turns counts into offsets, and wants to know those of the environments.
void add_up(Buffer<Index>& counts, View<const Index> env_first, Exact& exact, Buffer<Index>& bounds, std::vector<Index>& env_offset,
            device::Fetch& fetch) {
  const View<const Index> count = std::as_const(counts).view();
  device::env_sum(
      "broadphase.total", {0, count.n - 1}, [=] MORTISE_HD(Index i) { return static_cast<double>(count[i]); }, device::EnvValues{exact, fetch});
  device::scan(counts);
  bounds.resize(env_first.n);
  const View<Index> out = bounds.view();
  device::parallel_for("broadphase.env_offset", env_first.n, [=] MORTISE_HD(Index e) { out[e] = count[env_first[e]]; });
  fetch.add(View<const Index>(out), env_offset);
}

void check_countable(const Exact& exact) {
  if (exact[0] > 2147483647.0) throw Error(Exit::device, "too many contact candidates: a bounding radius or a step is far too large for the mesh");
}

}  // namespace

void NearPairs::add_up(Buffer<Index>& pt_counts, View<const Index> pt_first, Buffer<Index>& ee_counts, View<const Index> ee_first) {
  Exact pt{0}, ee{0};
  device::Fetch fetch;
  geometry::add_up(pt_counts, pt_first, pt, pt_env_first, pt_env_offset, fetch);
  geometry::add_up(ee_counts, ee_first, ee, ee_env_first, ee_env_offset, fetch);
  fetch.now();
  check_countable(pt);
  check_countable(ee);
  point_triangles.resize(pt_env_offset.back());
  edge_edges.resize(ee_env_offset.back());
}

}  // namespace mortise::geometry
