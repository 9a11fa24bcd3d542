#include "effects/contact/start_check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "device/one_of.h"
#include "geometry/collide/bvh.h"
#include "geometry/solid_angle.h"

namespace mortise::effects::contact {
namespace {

// Six times the signed volume of a tetrahedron.
MORTISE_HD inline double volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) { return (b - a).cross(c - a).dot(d - a); }

// Does the segment p q pass through the triangle? (Rounding decides cases within it; those have a distance near 0 anyway.)
MORTISE_HD inline bool crosses(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  const double vp = volume(a, b, c, p), vq = volume(a, b, c, q);
  // Of an edge in the plane of the triangle (both on a flat side of one body) rounding alone says which side its ends are on.
  const double largest = std::fmax(a.cwiseAbs().maxCoeff(), std::fmax(p.cwiseAbs().maxCoeff(), q.cwiseAbs().maxCoeff()));
  const double rounding = 1e-14 * largest * ((b - a).cross(c - a).norm() + (q - p).norm() * ((b - a).norm() + (c - a).norm()));
  if (vp * vq > 0 || std::fmax(std::fabs(vp), std::fabs(vq)) <= rounding) return false;
  const double s0 = volume(p, q, a, b), s1 = volume(p, q, b, c), s2 = volume(p, q, c, a);
  return (s0 >= 0 && s1 >= 0 && s2 >= 0) || (s0 <= 0 && s1 <= 0 && s2 <= 0);
}

// For every edge the first triangle that it passes through, or -1.
std::vector<Index> crossed_triangles(const BarrierView& s, Index envs, View<const Vec3> y) {
  geometry::Bvh tree;
  tree.update({s.surface.triangles.n ? s.surface.triangles.p->v : nullptr, s.surface.triangles.n, 3}, s.surface, envs, y, {});
  const geometry::BvhView view = tree.view();
  Buffer<Index> hit(s.surface.edges.n);
  const View<Index> out = hit.view();
  device::parallel_for("contact.start", s.surface.edges.n, [=] MORTISE_HD(Index e) {
    const Edge edge = s.surface.edges[e];
    geometry::BvhNode box = geometry::swept_box(edge.v, 2, -1, s.surface, y, View<const Vec3>{}, 0);
    geometry::BvhCursor cursor;
    out[e] = -1;
    for (Index t = cursor.next(view, box, s.surface); t >= 0; t = cursor.next(view, box, s.surface)) {
      const Triangle tri = s.surface.triangles[t];
      if (has(tri, edge.v[0]) || has(tri, edge.v[1]) || !s.sees(edge.v[0], tri.v[0])) continue;
      if (crosses(y[edge.v[0]], y[edge.v[1]], y[tri.v[0]], y[tri.v[1]], y[tri.v[2]]) && (out[e] < 0 || t < out[e])) out[e] = t;
    }
  });
  return hit.download();
}

// The first i < n with wrong(i), or -1.
template <class F>
Index first_where(const char* name, Index n, F wrong) {
  const double found = device::max(name, n, 0.0, [=] MORTISE_HD(Index i) { return wrong(i) ? static_cast<double>(n - i) : 0.0; });
  return found > 0 ? n - static_cast<Index>(found) : -1;
}

Index touching(const BarrierView& s, View<const PointTriangle> pairs, View<const Vec3> y) {
  return first_where("contact.touching_points", pairs.n, [=] MORTISE_HD(Index i) {
    if (!s.sees(pairs[i].v[0], pairs[i].v[1])) return false;
    Vec3 x[4];
    gather(y, pairs[i].v, x);
    return !(geometry::closest_point_triangle(x).squared > 0);
  });
}
Index touching(const BarrierView& s, View<const EdgeEdge> pairs, View<const Vec3> y) {
  return first_where("contact.touching_edges", pairs.n, [=] MORTISE_HD(Index i) {
    if (!s.sees(pairs[i].v[0], pairs[i].v[2])) return false;
    Vec3 x[4];
    gather(y, pairs[i].v, x);
    return !(geometry::closest_edge_edge(x).squared > 0);
  });
}
Index below(const BarrierView& s, View<const Vec3> y) {
  return first_where("contact.below_planes", s.planes.n * s.surface.vertices.n, [=] MORTISE_HD(Index i) {
    Index plane, point;
    double gap = 1;
    return plane_pair(s, i, y, plane, point, gap) && !(gap > 0);
  });
}

// Names primitives by the numbers that they have in their body's mesh.
struct Names {
  const model::Model& model;
  const BarrierView& s;
  const model::Body& body_of(Index point) const {
    std::size_t b = 0;
    while (point >= model.bodies[b].point_end) ++b;
    return model.bodies[b];
  }
  std::string point(Index p) const { return std::to_string(p - body_of(p).point_begin); }
  std::string vertex(Index p) const { return "vertex " + point(p) + " of '" + body_of(p).name + "'"; }
  std::string edge(Index a, Index b) const { return "edge " + point(a) + "-" + point(b) + " of '" + body_of(a).name + "'"; }
  std::string triangle(Index t) const {
    const model::Body& body = body_of(device::one_of(s.surface.triangles, t).v[0]);
    return "triangle " + std::to_string(t - body.triangle_begin) + " of '" + body.name + "'";
  }
};

// Triangles of a pair of primitives: those that hold all of `first` (a vertex, or the two ends of an edge), and likewise of `second`; a
// half-space has none.
struct Pair {
  std::vector<Index> first, second;
};

std::string obj_of(const Names& names, const std::vector<Index>& points, const std::vector<Vec3>& y, std::size_t& written) {
  if (points.empty()) return "";
  const model::Body& body = names.body_of(points[0]);
  std::string vertices, faces;
  for (Index t = body.triangle_begin; t < body.triangle_end; ++t) {
    const Triangle tri = device::one_of(names.s.surface.triangles, t);
    const bool holds = std::all_of(points.begin(), points.end(), [&](Index p) { return has(tri, p); });
    if (!holds) continue;
    faces += "f";
    for (Index v : tri.v) {
      char line[100];
      std::snprintf(line, sizeof line, "v %.17g %.17g %.17g\n", y[v][0], y[v][1], y[v][2]);
      vertices += line, faces += ' ', faces += std::to_string(++written);
    }
    faces += "\n";
  }
  return "o " + body.name + "\n" + vertices + faces;
}

[[noreturn]] void fail(const Names& names, View<const Vec3> y, const Pair& pair, const std::string& what) {
  std::vector<Vec3> points(y.n);
  device::copy_out(points.data(), y.p, y.n * sizeof(Vec3));
  std::size_t written = 0;
  std::string obj = "# " + what + "\n" + obj_of(names, pair.first, points, written);
  obj += obj_of(names, pair.second, points, written);
  throw StartError(names.body_of(pair.first[0]).where,
                   "bodies must start apart: " + what +
                       " (leave a gap, contact begins at d_hat; or let them pass through each other: pairs: [{bodies: [...], collide: false}])",
                   obj);
}

// How often the closed surface of a body winds around x.
double winding(const std::vector<Triangle>& triangles, const model::Body& body, const std::vector<Vec3>& y, const Vec3& x) {
  double angle = 0;
  for (Index t = body.triangle_begin; t < body.triangle_end; ++t) {
    const Index* v = triangles[t].v;
    angle += geometry::solid_angle(y[v[0]], y[v[1]], y[v[2]], x);
  }
  return angle / (4 * std::numbers::pi);
}

// Bodies whose surfaces are apart may still lie one in the other. (In a cavity the surface winds around nothing.)
void check_nested(const model::Model& model, const BarrierView& s, View<const Vec3> view) {
  std::vector<Vec3> y(view.n);
  device::copy_out(y.data(), view.p, y.size() * sizeof(Vec3));
  const std::vector<Triangle> triangles = model.surface.triangles.download();
  std::vector<std::uint8_t> seen(s.watched.n);
  device::copy_out(seen.data(), s.watched.p, seen.size());
  const std::size_t n = model.bodies.size();
  std::vector<Vec3> lo(n, Vec3::Constant(INFINITY)), hi(n, Vec3::Constant(-INFINITY));
  for (std::size_t b = 0; b < n; ++b)
    for (Index t = model.bodies[b].triangle_begin; t < model.bodies[b].triangle_end; ++t)
      for (Index v : triangles[t].v) lo[b] = lo[b].cwiseMin(y[v]), hi[b] = hi[b].cwiseMax(y[v]);
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = 0; b < n; ++b) {
      const model::Body &inner = model.bodies[a], &outer = model.bodies[b];
      if (a == b || inner.env != outer.env || !seen[model.surface.pairs.of(static_cast<Index>(a), static_cast<Index>(b))] ||
          inner.triangle_begin == inner.triangle_end)
        continue;
      if ((lo[a].array() < lo[b].array()).any() || (hi[a].array() > hi[b].array()).any()) continue;
      if (std::abs(winding(triangles, outer, y, y[triangles[inner.triangle_begin].v[0]])) > 0.5)
        throw Error(Exit::scene, inner.where, "bodies must start apart: '" + inner.name + "' lies inside '" + outer.name + "'");
    }
}

}  // namespace

void check_start(const model::Model& model, const BarrierView& s, const Candidates& c, View<const Vec3> y) {
  const Names names{model, s};
  if (const Index i = below(s, y); i >= 0) {
    const Index point = device::one_of(s.surface.vertices, i % s.surface.vertices.n);
    fail(names, y, {{point}, {}}, names.vertex(point) + " is on or below half-space '" + model.half_spaces[i / s.surface.vertices.n].name + "'");
  }
  if (const Index i = touching(s, c.point_triangles(), y); i >= 0) {
    const PointTriangle p = device::one_of(c.point_triangles(), i);
    const Triangle t = device::one_of(s.surface.triangles, p.triangle);
    fail(names, y, {{p.point}, {t.v[0], t.v[1], t.v[2]}}, names.vertex(p.point) + " touches " + names.triangle(p.triangle));
  }
  if (const Index i = touching(s, c.edge_edges(), y); i >= 0) {
    const EdgeEdge p = device::one_of(c.edge_edges(), i);
    fail(names, y, {{p.v[0], p.v[1]}, {p.v[2], p.v[3]}}, names.edge(p.v[0], p.v[1]) + " touches " + names.edge(p.v[2], p.v[3]));
  }
  const std::vector<Index> hit = crossed_triangles(s, model.envs, y);
  for (std::size_t e = 0; e < hit.size(); ++e) {
    if (hit[e] < 0) continue;
    const Edge edge = device::one_of(s.surface.edges, static_cast<Index>(e));
    const Triangle t = device::one_of(s.surface.triangles, hit[e]);
    fail(names, y, {{edge.v[0], edge.v[1]}, {t.v[0], t.v[1], t.v[2]}},
         names.edge(edge.v[0], edge.v[1]) + " passes through " + names.triangle(hit[e]));
  }
  check_nested(model, s, y);
}

}  // namespace mortise::effects::contact
