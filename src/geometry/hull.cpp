#include "geometry/hull.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>

#include "base/error.h"
#include "geometry/bounds.h"
#include "geometry/topology.h"

namespace mortise::geometry {

namespace {

constexpr double kFlat = 1e-6;  // least height of a triangle over the size of the hull

TriMesh exact_hull(const std::vector<Vec3>& points) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
  std::vector<Kernel::Point_3> given;
  for (const Vec3& x : points) given.emplace_back(x[0], x[1], x[2]);
  Surface hull;
  if (given.size() >= 4) CGAL::convex_hull_3(given.begin(), given.end(), hull);
  TriMesh out;
  for (const auto v : hull.vertices()) out.points.emplace_back(hull.point(v).x(), hull.point(v).y(), hull.point(v).z());
  for (const auto f : hull.faces()) {  // convex: a fan of triangles
    std::vector<Index> ring;
    for (const auto v : CGAL::vertices_around_face(hull.halfedge(f), hull)) ring.push_back(static_cast<Index>(v.idx()));
    for (std::size_t k = 2; k < ring.size(); ++k) out.triangles.push_back({ring[0], ring[k - 1], ring[k]});
  }
  return out;
}

// The corner of a triangle without height that lies between the two others; -1 of a sound one.
Index between(const TriMesh& m, const Triangle& t, double least) {
  int longest = 0;
  Vec3 edge[3];
  for (int k = 0; k < 3; ++k) {
    edge[k] = m.points[t.v[(k + 1) % 3]] - m.points[t.v[k]];
    if (edge[k].squaredNorm() > edge[longest].squaredNorm()) longest = k;
  }
  const double height = edge[0].cross(edge[1]).norm() / edge[longest].norm();
  return height > least ? -1 : t.v[(longest + 2) % 3];
}

}  // namespace

TriMesh convex_hull(const std::vector<Vec3>& points) {
  TriMesh out = exact_hull(points);
  const double least = points.empty() ? 0 : kFlat * bounds_of(points).size().norm();
  for (bool again = out.triangles.size() >= 4; again;) {
    std::vector<std::uint8_t> keep(out.points.size(), 1);
    again = false;
    for (const Triangle& t : out.triangles) {
      if (keep[t.v[0]] == 0 || keep[t.v[1]] == 0 || keep[t.v[2]] == 0) continue;  // of two points that are nearly one only one goes
      if (const Index v = between(out, t, least); v >= 0) keep[v] = 0, again = true;
    }
    if (!again) break;
    std::vector<Vec3> kept;
    for (std::size_t i = 0; i < keep.size(); ++i)
      if (keep[i] != 0) kept.push_back(out.points[i]);
    out = exact_hull(kept);
    again = out.triangles.size() >= 4;
  }
  if (out.triangles.size() < 4 || !(mass_properties(out).volume > 0)) throw Error(Exit::scene, "the points lie in a plane and have no hull");
  return out;
}

}  // namespace mortise::geometry
