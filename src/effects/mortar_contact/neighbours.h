#pragma once
// What a sample hangs on beyond its own two triangles: the triangles over the slave's sides, against which it is bent, those around a master's edge
// or vertex, which say what it weighs, and masters whose rims lie over it, which hide a part of it.
#include "effects/mortar_contact/stage.h"

namespace mortise::effects::mortar {

// Sides e_1, e_2 of a triangle, its normal, area, and g_i with g_i . e_j = delta_ij, g_i . n = 0.
struct Frame {
  Vec3 n, g[2];
  double area;
  MORTISE_HD Frame(const Vec3& e1, const Vec3& e2) {
    const Vec3 twice = e1.cross(e2);
    const double length = twice.norm();
    n = twice / length, area = length / 2;
    g[0] = e2.cross(n) / length, g[1] = n.cross(e1) / length;
  }
};
MORTISE_HD inline Frame frame_of(const FaceNodes& on, View<const Vec3> y) {
  const Vec3 a = y[on.point[on.vertex(0)]];
  return {y[on.point[on.vertex(1)]] - a, y[on.point[on.vertex(2)]] - a};
}

// Around the edge or vertex of the master that a sample sits on.
MORTISE_HD inline Ring around(const MortarView& s, Index master, const Sample& sample) {
  for (int k = 0; k < 3; ++k) {
    if (sample.kind == SampleKind::edge && sample.M[k] == 0) return over_side(s, master, k);
    if (sample.kind == SampleKind::point && sample.M[k] == 1) {
      const Index v = s.surface.triangles[master].v[k];
      return {s.topology.point_triangle, s.topology.point_offset[v], s.topology.point_offset[v + 1]};
    }
  }
  return {};
}

// The slave and the place among its masters of a pair that others may hide a part of.
struct Under {
  const Patch& patch;
  Index place;
};
MORTISE_HD inline Under under_others(const Stage& s, const Pair& p) {
  Index lo = 0, hi = s.s.slaves.n - 1;  // in ascending order
  while (lo < hi) {
    const Index mid = (lo + hi) / 2;
    if (s.s.slaves[mid] < p.slave)
      lo = mid + 1;
    else
      hi = mid;
  }
  const Patch& patch = s.patches[lo];
  Index place = 0;
  while (place + 1 < patch.masters && patch.master[place] != p.master) ++place;
  return {patch, place};
}
// Of every master whose rim lies over a sample of plane faces: with(master).
template <class With>
MORTISE_HD inline void each_rim(const Stage& s, const Under& u, const Sample& sample, const With& with) {
  for (Index j = 0; j < u.patch.masters; ++j) {
    if (!may_cover(s.s, u.patch, u.place, j)) continue;
    const double share = covers(u.patch.facing[j], s.s.surface.triangles[u.patch.master[j]], s.y, sample.N, sample.gap);
    if (share > 0 && share < 1) with(u.patch.master[j]);
  }
}

// The nodes of a sample: its pair's, then those of neighbours.
struct NodeList {
  Index id[model::kChangePoints];
  int n = 0;
  bool all = true;  // there was room
  MORTISE_HD void add(Index node) {
    for (int k = 0; k < n; ++k)
      if (id[k] == node) return;
    if (n < model::kChangePoints)
      id[n++] = node;
    else
      all = false;
  }
  MORTISE_HD void add(const MortarView& s, const Ring& ring) {
    for (Index j = ring.begin; j < ring.end; ++j)
      for (int k = 0; k < 3; ++k) add(s.surface.triangles[ring.list[j]].v[k]);
  }
};
// Where its motion is not wanted they are those alone: sums of forces then have the terms, and the bits, that they have without.
MORTISE_HD inline NodeList nodes_of(const Stage& stage, const Pair& p, const Sample& sample, bool moving) {
  const MortarView& s = stage.s;
  NodeList out;
  for (int k = 0; k < points_of(p); ++k) out.id[out.n++] = point_of(p, k);
  if (!moving) return out;
  if (p.layered && !s.bent(p.slave) && !s.bent(p.master))
    each_rim(stage, under_others(stage, p), sample, [&](Index master) {
      for (int k = 0; k < 3; ++k) out.add(s.surface.triangles[master].v[k]);
    });
  if (sample.kind == SampleKind::face) return out;
  for (int k = 0; k < 3; ++k) out.add(s, over_side(s, p.slave, k));
  out.add(s, around(s, p.master, sample));
  return out;
}

// Adds up a derivative by the nodes of a sample.
struct ByNodes {
  const MortarView& s;
  View<const Vec3> y;
  const Index* node;
  int count;
  Vec3* to;
  MORTISE_HD void add(Index id, const Vec3& v) const {
    for (int k = 0; k < count; ++k)
      if (node[k] == id) {
        to[k] += v;
        return;
      }
  }
  // normal . dn + area dA of a triangle:  dn = -g_i (n . de_i),  dA = A g_i . de_i.
  MORTISE_HD void of_triangle(Index t, const Vec3& normal, double area) const {
    const Index* v = s.surface.triangles[t].v;
    const Frame f(y[v[1]] - y[v[0]], y[v[2]] - y[v[0]]);
    for (int i = 0; i < 2; ++i) {
      const Vec3 side = -normal.dot(f.g[i]) * f.n + area * f.area * f.g[i];
      add(v[i + 1], side), add(v[0], -side);
    }
  }
};

// Adds x d(bend over side k).
MORTISE_HD inline void of_bend(const MortarView& s, Index slave, int k, const Vec3& n, double x, const ByNodes& out) {
  const Ring ring = over_side(s, slave, k);
  double largest = 0;
  Index against = -1;
  for (Index j = ring.begin; j < ring.end; ++j) {
    const double angle = 1 - n.dot(s.normal[ring.list[j]]);
    if (angle > largest) largest = angle, against = ring.list[j];
  }
  const double slope = hermite_slope(largest / tuning::kBent) / tuning::kBent;
  if (against < 0 || slope == 0) return;
  out.of_triangle(slave, -x * slope * s.normal[against], 0);
  out.of_triangle(against, -x * slope * n, 0);
}

}  // namespace mortise::effects::mortar
