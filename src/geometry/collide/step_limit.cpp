#include "geometry/collide/step_limit.h"

#include "geometry/collide/ccd.h"

namespace mortise::geometry {
namespace {

using device::Buffer;
using device::View;

template <class Pair>
void limit(const char* name, const Chosen<Pair>& chosen, const device::Ranges& whose, bool edges, View<const Vec3> y, View<const Vec3> dy,
           double keep, device::EnvValues alpha) {
  const Chosen<Pair> list = chosen;
  const View<const Pair> pairs = list.pair;
  Buffer<double> limits(pairs.n);
  const View<double> out = limits.view();
  device::parallel_for(name, whose, [=] MORTISE_HD(Index i) {
    out[i] = kNoImpact;
    if (!list.has(i)) return;
    Vec3 x0[4], x1[4];
    for (int k = 0; k < 4; ++k) {
      x0[k] = y[pairs[i].v[k]];
      x1[k] = x0[k] + dy[pairs[i].v[k]];
    }
    out[i] = detail::step_limit(x0, x1, edges, keep);
  });
  const View<const double> t = limits.view();
  device::env_min(
      "step_limit.least", whose, [=] MORTISE_HD(Index i) { return t[i]; }, alpha);
}

}  // namespace

void limit_step(const ChosenPairs& pairs, View<const Vec3> y, View<const Vec3> dy, double keep, device::EnvValues alpha) {
  limit("step_limit.point_triangle", pairs.points, pairs.of_points, false, y, dy, keep, alpha);
  limit("step_limit.edge_edge", pairs.edges, pairs.of_edges, true, y, dy, keep, alpha);
}

void limit_step(const Broadphase& pairs, View<const Vec3> y, View<const Vec3> dy, double keep, device::EnvValues alpha) {
  limit_step(pairs.pairs(), y, dy, keep, alpha);
}

}  // namespace mortise::geometry
