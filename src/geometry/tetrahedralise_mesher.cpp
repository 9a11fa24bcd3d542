// CGAL, compiled once and apart (a minute): exact predicates need -frounding-math (see CMakeLists.txt).
#include "geometry/tetrahedralise_mesher.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Mesh_3/Dump_c3t3.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polyhedral_mesh_domain_with_features_3.h>
#include <CGAL/Random.h>
#include <CGAL/assertions_behaviour.h>
#include <CGAL/make_mesh_3.h>

#include <cmath>
#include <unordered_map>

namespace mortise::geometry {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Polyhedron = CGAL::Mesh_polyhedron_3<Kernel>::type;
using Domain = CGAL::Polyhedral_mesh_domain_with_features_3<Kernel>;
using Triangulation = CGAL::Mesh_triangulation_3<Domain, CGAL::Default, CGAL::Sequential_tag>::type;
using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation, Domain::Corner_index, Domain::Curve_index>;
using Criteria = CGAL::Mesh_criteria_3<Triangulation>;

}  // namespace mortise::geometry

// Where a point cannot be placed CGAL writes all that it has into the current folder, whoever that belongs to.
template <>
struct CGAL::Dump_c3t3<mortise::geometry::Complex, true> {
  void dump_c3t3(const mortise::geometry::Complex&, const std::string&) const {}
};

namespace mortise::geometry {
namespace {

// Refinement bounds the radius r of circumscribed circles and balls; most end between r/2 and r. Measured on balls, boxes and
// robot parts, mean edge length = aim with these factors (tests/geometry/mesh_tetrahedralise_test.cpp).
constexpr double kFacetRadius = 0.8, kCellRadius = 0.73;
constexpr int kInitialPoints[] = {-1, 300, 3000, 30000};  // of which refinement starts: CGAL's own, some ten; more where they find no inside
constexpr double kSliverAngle = 12;                       // [deg] smallest dihedral angle that sliver removal works for

Polyhedron polyhedron(const TriMesh& surface, double scale) {
  std::vector<Kernel::Point_3> points;
  std::vector<std::array<std::size_t, 3>> triangles;
  for (const Vec3& p : surface.points) points.emplace_back(scale * p[0], scale * p[1], scale * p[2]);
  for (const Triangle& t : surface.triangles)
    triangles.push_back({static_cast<std::size_t>(t.v[0]), static_cast<std::size_t>(t.v[1]), static_cast<std::size_t>(t.v[2])});
  Polyhedron out;
  CGAL::Polygon_mesh_processing::polygon_soup_to_polygon_mesh(points, triangles, out);
  return out;
}

}  // namespace

TetMesh mesh_domain(const TriMesh& surface, const TetrahedraliseOptions& o) {
  // Lengths near one, by a power of two: exact, and the mesher's own small constants keep their meaning for millimetre parts.
  double extent = 0;
  for (const Vec3& p : surface.points) extent = std::max(extent, p.cwiseAbs().maxCoeff());
  const double scale = std::ldexp(1.0, -std::ilogb(extent));

  // CGAL seeds its random numbers with the clock; a fixed seed makes the mesh a function of the input.
  CGAL::get_default_random() = CGAL::Random(1);
  CGAL::Random random(1);
  const Polyhedron body = polyhedron(surface, scale);
  Domain domain(body, &random);
  domain.detect_features(o.feature_angle * 180 / CGAL_PI);

  namespace param = CGAL::parameters;
  const double surface_edge = scale * o.surface_edge_length;
  const Criteria criteria(param::edge_size = surface_edge, param::facet_angle = o.facet_angle * 180 / CGAL_PI,
                          param::facet_size = kFacetRadius * surface_edge, param::facet_distance = scale * o.facet_distance,
                          param::cell_radius_edge_ratio = o.radius_edge_ratio, param::cell_size = kCellRadius * scale * o.edge_length);
  // A ring that is thin all around shows its inside to points only that are as close to each other as it is thick. And moving points away from
  // slivers ends in a failed assertion of CGAL's on some domes, which other points at the start help as well.
  Complex complex;
  const CGAL::Failure_function told = CGAL::set_warning_handler([](const char*, const char*, const char*, int, const char*) {});
  for (const int points : kInitialPoints) {
    if (complex.number_of_cells_in_complex() > 0) break;
    // Without a limit of their own both sliver removals stop after the time that refinement took: a mesh that depends on the
    // clock. 0 means no limit; they end by themselves when no tetrahedron below the bound can be improved.
    try {
      complex = CGAL::make_mesh_3<Complex>(
          domain, criteria, param::manifold(), param::perturb(param::time_limit = 0, param::sliver_bound = kSliverAngle),
          param::exude(param::time_limit = 0, param::sliver_bound = kSliverAngle), param::mesh_3_options(param::number_of_initial_points = points));
    } catch (const CGAL::Failure_exception&) {
      complex = Complex();
    }
  }
  CGAL::set_warning_handler(told);

  TetMesh out;
  std::unordered_map<Triangulation::Vertex_handle, Index> number;
  for (auto cell = complex.cells_in_complex_begin(); cell != complex.cells_in_complex_end(); ++cell) {
    Tet tet;
    for (int k = 0; k < 4; ++k) {
      const auto vertex = cell->vertex(k);
      const auto [at, fresh] = number.try_emplace(vertex, static_cast<Index>(out.points.size()));
      if (fresh) {
        const auto& p = vertex->point().point();
        out.points.push_back(Vec3(p.x(), p.y(), p.z()) / scale);
      }
      tet.v[k] = at->second;
    }
    out.tets.push_back(tet);
  }
  return out;
}

}  // namespace mortise::geometry
