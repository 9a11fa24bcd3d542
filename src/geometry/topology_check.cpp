#include "geometry/topology_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "base/error.h"
#include "geometry/bounds.h"
#include "geometry/topology.h"

namespace mortise::geometry {
namespace {

// 12 -> "12 triangles", 1 -> "1 triangle"
std::string counted(std::size_t n, const std::string& noun, const std::string& plural) { return std::to_string(n) + " " + (n == 1 ? noun : plural); }
std::string counted(std::size_t n, const std::string& noun) { return counted(n, noun, noun + "s"); }

std::string position(const Vec3& p) {
  char text[96];
  std::snprintf(text, sizeof text, "(%.6g, %.6g, %.6g) m", p[0], p[1], p[2]);
  return text;
}

// What vertices that should be one are apart at most, where nothing else is known: a hundred-thousandth of the mesh.
std::string tolerance(const TriMesh& m) {
  char text[32];
  std::snprintf(text, sizeof text, "%.0e m", 1e-5 * bounds_of(m.points).size().maxCoeff());
  return text;
}

Vec3 centre(const TriMesh& m, Index t) {
  const Triangle& v = m.triangles[t];
  return (m.points[v.v[0]] + m.points[v.v[1]] + m.points[v.v[2]]) / 3;
}

struct Check {
  const TriMesh& mesh;
  const std::string& what;

  [[noreturn]] void fail(const std::string& message) const {
    throw Error(Exit::scene,
                what + ": " + message + " (" + counted(mesh.points.size(), "point") + ", " + counted(mesh.triangles.size(), "triangle") + ")");
  }
};

template <class Elements>
void check_finite(const std::vector<Vec3>& points, const Elements& elements, const std::string& what) {
  std::size_t bad = 0;
  Index first = -1;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!points[i].allFinite() && bad++ == 0) first = static_cast<Index>(i);
  if (bad > 0)
    throw Error(Exit::scene, what + ": " + counted(bad, "point has", "points have") +
                                 " a coordinate that is not a finite number, the first is point " + std::to_string(first));
  for (std::size_t e = 0; e < elements.size(); ++e)
    for (Index v : elements[e].v)
      if (v < 0 || static_cast<std::size_t>(v) >= points.size())
        throw Error(Exit::scene, what + ": element " + std::to_string(e) + " refers to point " + std::to_string(v) + ", but there are " +
                                     counted(points.size(), "point"));
}

// Height over the longest edge below 1e-9: no normal can be computed that means anything.
bool degenerate(const TriMesh& m, const Triangle& t) {
  const Vec3 a = m.points[t.v[1]] - m.points[t.v[0]], b = m.points[t.v[2]] - m.points[t.v[0]];
  const double longest = std::max({a.squaredNorm(), b.squaredNorm(), (a - b).squaredNorm()});
  return !(a.cross(b).norm() > 1e-9 * longest);
}

void check_triangles(const Check& c) {
  const TriMesh& m = c.mesh;
  std::size_t bad = 0;
  Index first = -1;
  for (std::size_t t = 0; t < m.triangles.size(); ++t)
    if (degenerate(m, m.triangles[t]) && bad++ == 0) first = static_cast<Index>(t);
  if (bad > 0)
    c.fail(counted(bad, "triangle has", "triangles have") + " no area, the first is triangle " + std::to_string(first) + " at " +
           position(centre(m, first)));

  std::vector<Index> order(m.triangles.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](Index t) {
    std::array<Index, 3> k{m.triangles[t].v[0], m.triangles[t].v[1], m.triangles[t].v[2]};
    std::sort(k.begin(), k.end());
    return k;
  };
  std::sort(order.begin(), order.end(), [&](Index a, Index b) { return key(a) != key(b) ? key(a) < key(b) : a < b; });
  std::pair<Index, Index> repeated(-1, -1);
  for (std::size_t i = 1; i < order.size(); ++i)
    if (key(order[i]) == key(order[i - 1]) && (bad++ == 0 || order[i] < repeated.second)) repeated = {order[i - 1], order[i]};
  if (bad > 0)
    c.fail(counted(bad, "triangle repeats", "triangles repeat") + " the vertices of another, the first is triangle " +
           std::to_string(repeated.second) + " (same as " + std::to_string(repeated.first) + ") at " + position(centre(m, repeated.second)));
}

struct HalfEdge {
  Index low, high, triangle;
  bool forward;  // runs from low to high
};

std::vector<HalfEdge> sorted_half_edges(const TriMesh& m) {
  std::vector<HalfEdge> h;
  h.reserve(3 * m.triangles.size());
  for (std::size_t t = 0; t < m.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const Index a = m.triangles[t].v[k], b = m.triangles[t].v[(k + 1) % 3];
      h.push_back({std::min(a, b), std::max(a, b), static_cast<Index>(t), a < b});
    }
  std::sort(h.begin(), h.end(), [](const HalfEdge& a, const HalfEdge& b) {
    return std::array{a.low, a.high, a.triangle} < std::array{b.low, b.high, b.triangle};
  });
  return h;
}

void check_edges(const Check& c) {
  struct Finding {
    std::size_t count = 0;
    HalfEdge first{};
    void add(const HalfEdge& h) {
      if (count++ == 0) first = h;
    }
  } open, fan, turned;
  const std::vector<HalfEdge> h = sorted_half_edges(c.mesh);
  for (std::size_t i = 0; i < h.size();) {
    std::size_t j = i + 1;
    while (j < h.size() && h[j].low == h[i].low && h[j].high == h[i].high) ++j;
    if (j - i == 1) open.add(h[i]);
    if (j - i > 2) fan.add(h[i]);
    if (j - i == 2 && h[i].forward == h[i + 1].forward) turned.add(h[i]);
    i = j;
  }
  const auto place = [&](const Finding& f) {
    return "the first is edge " + std::to_string(f.first.low) + "-" + std::to_string(f.first.high) + " of triangle " +
           std::to_string(f.first.triangle) + " at " + position((c.mesh.points[f.first.low] + c.mesh.points[f.first.high]) / 2);
  };
  if (fan.count > 0)
    c.fail("the surface is not manifold: " + counted(fan.count, "edge belongs", "edges belong") + " to more than two triangles, " + place(fan));
  if (open.count > 0)
    c.fail("the surface is open: " + counted(open.count, "edge belongs", "edges belong") + " to one triangle only, " + place(open) +
           "; if vertices only nearly coincide there, merge them in the scene, for example 'mesh: {file: ..., weld: " + tolerance(c.mesh) + "}'");
  if (turned.count > 0)
    c.fail("the surface is not consistently oriented: across " + counted(turned.count, "edge") + " the two triangles face opposite sides, " +
           place(turned));
}

// All edges have two triangles here, so the triangles around a vertex form one or more closed fans; one is right.
void check_vertices(const Check& c) {
  const TriMesh& m = c.mesh;
  std::vector<Index> offset(m.points.size() + 1, 0);
  for (const Triangle& t : m.triangles)
    for (Index v : t.v) ++offset[v + 1];
  std::partial_sum(offset.begin(), offset.end(), offset.begin());
  std::vector<std::pair<Index, Index>> next(3 * m.triangles.size());  // around v: the triangle (v, a, b) leads from a to b
  std::vector<Index> fill(offset.begin(), offset.end() - 1);
  for (const Triangle& t : m.triangles)
    for (int k = 0; k < 3; ++k) next[fill[t.v[k]]++] = {t.v[(k + 1) % 3], t.v[(k + 2) % 3]};

  std::size_t bad = 0;
  Index first = -1;
  for (std::size_t v = 0; v < m.points.size(); ++v) {
    const auto begin = next.begin() + offset[v], end = next.begin() + offset[v + 1];
    if (begin == end) continue;
    std::sort(begin, end);
    std::ptrdiff_t steps = 0;
    Index at = begin->first;
    do {
      at = std::lower_bound(begin, end, std::pair<Index, Index>(at, -1))->second;
      ++steps;
    } while (at != begin->first);
    if (steps != end - begin && bad++ == 0) first = static_cast<Index>(v);
  }
  if (bad > 0)
    c.fail("the surface is not manifold: at " + counted(bad, "vertex", "vertices") + " parts of it touch in a single point, the first is vertex " +
           std::to_string(first) + " at " + position(m.points[first]));
}

void check_manifold(const Check& c) {
  if (c.mesh.triangles.empty()) c.fail("there are no triangles");
  check_finite(c.mesh.points, c.mesh.triangles, c.what);
  check_triangles(c);
  check_edges(c);
  check_vertices(c);
}

}  // namespace

void check_closed_surface(const TriMesh& mesh, const std::string& what) {
  const Check c{mesh, what};
  check_manifold(c);
  if (!(mass_properties(mesh).volume > 0)) c.fail("the surface is inside out: its triangles face the enclosed volume");
  const auto pairs = self_intersections(mesh);
  if (!pairs.empty())
    c.fail("the surface intersects itself in " + counted(pairs.size(), "pair") + " of triangles, the first are triangles " +
           std::to_string(pairs[0].first) + " and " + std::to_string(pairs[0].second) + " at " +
           position((centre(mesh, pairs[0].first) + centre(mesh, pairs[0].second)) / 2));
  if (const Index t = first_wrongly_nested(mesh); t >= 0)
    c.fail(
        "a part of the surface (triangle " + std::to_string(t) + " at " + position(centre(mesh, t)) +
        ") lies inside of another part and faces outwards as well, or outside of all and faces inwards; a cavity's triangles face into the cavity");
}

void check_tets(const TetMesh& mesh, const std::string& what) {
  const auto fail = [&](const std::string& message) {
    throw Error(Exit::scene, what + ": " + message + " (" + counted(mesh.points.size(), "point") + ", " +
                                 counted(mesh.tets.size(), "tetrahedron", "tetrahedra") + ")");
  };
  if (mesh.tets.empty()) fail("there are no tetrahedra");
  check_finite(mesh.points, mesh.tets, what);

  std::size_t inverted = 0, flat = 0;
  Index first_inverted = -1, first_flat = -1;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    const Tet& tet = mesh.tets[t];
    double longest = 0;
    for (int i = 0; i < 4; ++i)
      for (int j = i + 1; j < 4; ++j) longest = std::max(longest, (mesh.points[tet.v[i]] - mesh.points[tet.v[j]]).norm());
    const double v = tet_volume(mesh.points, tet), least = 1e-9 * longest * longest * longest;
    if (!(std::abs(v) > least)) {
      if (flat++ == 0) first_flat = static_cast<Index>(t);
    } else if (v < 0) {
      if (inverted++ == 0) first_inverted = static_cast<Index>(t);
    }
  }
  const auto place = [&](Index t) {
    Vec3 p = Vec3::Zero();
    for (Index v : mesh.tets[t].v) p += mesh.points[v] / 4;
    return "the first is tetrahedron " + std::to_string(t) + " at " + position(p);
  };
  if (flat > 0) fail(counted(flat, "tetrahedron has", "tetrahedra have") + " no volume, " + place(first_flat));
  if (inverted > 0) fail(counted(inverted, "tetrahedron is", "tetrahedra are") + " inverted, " + place(first_inverted));

  const TriMesh surface{mesh.points, boundary_triangles(mesh)};  // unused points kept: messages count in the ids of the mesh
  const std::string boundary = what + ": boundary";
  check_manifold({surface, boundary});
}

}  // namespace mortise::geometry
