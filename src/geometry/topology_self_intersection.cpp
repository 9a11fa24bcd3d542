// CGAL, compiled once and apart: exact predicates need -frounding-math (see CMakeLists.txt).
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>

#include "geometry/topology_check.h"

namespace mortise::geometry {

std::vector<std::pair<Index, Index>> self_intersections(const TriMesh& mesh) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
  Surface surface;
  for (const Vec3& p : mesh.points) surface.add_vertex({p[0], p[1], p[2]});
  for (const Triangle& t : mesh.triangles)
    surface.add_face(Surface::Vertex_index(t.v[0]), Surface::Vertex_index(t.v[1]), Surface::Vertex_index(t.v[2]));

  std::vector<std::pair<Surface::Face_index, Surface::Face_index>> found;
  CGAL::Polygon_mesh_processing::self_intersections<CGAL::Sequential_tag>(surface, std::back_inserter(found));
  std::vector<std::pair<Index, Index>> pairs;
  for (const auto& [a, b] : found) pairs.push_back(std::minmax(static_cast<Index>(a.idx()), static_cast<Index>(b.idx())));
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace mortise::geometry
