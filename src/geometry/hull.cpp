#include "geometry/hull.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/triangulate_faces.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>

#include "base/error.h"
#include "geometry/topology.h"

namespace mortise::geometry {

TriMesh convex_hull(const std::vector<Vec3>& points) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
  std::vector<Kernel::Point_3> given;
  for (const Vec3& x : points) given.emplace_back(x[0], x[1], x[2]);
  Surface hull;
  if (given.size() >= 4) CGAL::convex_hull_3(given.begin(), given.end(), hull);
  CGAL::Polygon_mesh_processing::triangulate_faces(hull);
  TriMesh out;
  for (const auto v : hull.vertices()) out.points.emplace_back(hull.point(v).x(), hull.point(v).y(), hull.point(v).z());
  for (const auto f : hull.faces()) {
    Triangle t{};
    int k = 0;
    for (const auto v : CGAL::vertices_around_face(hull.halfedge(f), hull)) t.v[k++] = static_cast<Index>(v.idx());
    out.triangles.push_back(t);
  }
  if (out.triangles.size() < 4 || !(mass_properties(out).volume > 0)) throw Error(Exit::scene, "the points lie in a plane and have no hull");
  return out;
}

}  // namespace mortise::geometry
