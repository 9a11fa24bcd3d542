#pragma once
// Picking those of many that a condition holds for, and the condition that matters here.
#include "effects/contact/pair_energy.h"

namespace mortise::effects::contact {

// Offsets of those i < n that `keep` wants: i is kept where offset[i+1] > offset[i], and the last offset is their number.
template <class Keep>
void mark(const char* name, Index n, Keep keep, Buffer<Index>& offset) {
  offset.resize(n + 1);
  const View<Index> o = offset.view();
  device::parallel_for(name, n + 1, [=] MORTISE_HD(Index i) { o[i] = i < n && keep(i) ? 1 : 0; });
  device::scan(offset);
}

// The same of those i < n that are among `whose`; none of the others is kept.
template <class Keep>
void mark(const char* name, Index n, const device::Ranges& whose, Keep keep, Buffer<Index>& offset) {
  if (whose.size() == n) return mark(name, n, keep, offset);
  offset.resize(n + 1);
  offset.zero();
  const View<Index> o = offset.view();
  device::parallel_for(name, whose, [=] MORTISE_HD(Index i) { o[i] = keep(i) ? 1 : 0; });
  device::scan(offset);
}

// Is a candidate within range at y?
MORTISE_HD inline bool near(const BarrierView& s, const PointTriangle& pair, View<const Vec3> y) {
  if (!s.sees(pair.v[0], pair.v[1])) return false;
  Vec3 x[4];
  gather(y, pair.v, x);
  const double range = point_range(s, pair.v[0], pair.v[1]);
  return geometry::closest_point_triangle(x).squared < range * range;
}
MORTISE_HD inline bool near(const BarrierView& s, const EdgeEdge& pair, View<const Vec3> y) {
  if (!s.sees(pair.v[0], pair.v[2])) return false;
  Vec3 x[4];
  gather(y, pair.v, x);
  const double range = edge_range(s, pair.v);
  return geometry::closest_edge_edge(x).squared < range * range;
}

}  // namespace mortise::effects::contact
