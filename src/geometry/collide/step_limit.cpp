#include "geometry/collide/step_limit.h"

#include "geometry/collide/ccd.h"

namespace mortise::geometry {
namespace {

using device::Buffer;
using device::View;

template <class Pair>
void limit(const char* name, View<const Pair> pairs, const std::vector<Index>& offset, bool edges, View<const Vec3> y, View<const Vec3> dy,
           double keep, device::EnvValues alpha) {
  Buffer<double> limits(pairs.n);
  const View<double> out = limits.view();
  device::parallel_for(name, pairs.n, [=] MORTISE_HD(Index i) {
    Vec3 x0[4], x1[4];
    for (int k = 0; k < 4; ++k) {
      x0[k] = y[pairs[i].v[k]];
      x1[k] = x0[k] + dy[pairs[i].v[k]];
    }
    out[i] = detail::step_limit(x0, x1, edges, keep);
  });
  const View<const double> t = limits.view();
  device::env_min(
      "step_limit.least", offset, [=] MORTISE_HD(Index i) { return t[i]; }, alpha);
}

}  // namespace

void limit_step(const Broadphase& pairs, View<const Vec3> y, View<const Vec3> dy, double keep, device::EnvValues alpha) {
  limit("step_limit.point_triangle", pairs.point_triangles(), pairs.pt_env_offset(), false, y, dy, keep, alpha);
  limit("step_limit.edge_edge", pairs.edge_edges(), pairs.ee_env_offset(), true, y, dy, keep, alpha);
}

}  // namespace mortise::geometry
