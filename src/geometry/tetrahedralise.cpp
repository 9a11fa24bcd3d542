#include "geometry/tetrahedralise.h"

#include <cmath>
#include <sstream>

#include "base/error.h"
#include "geometry/bounds.h"
#include "geometry/tetrahedralise_cache.h"
#include "geometry/tetrahedralise_mesher.h"
#include "geometry/topology.h"
#include "geometry/topology_check.h"

namespace mortise::geometry {
namespace {

void check_result(const TriMesh& given, const TetMesh& mesh, const std::string& what) {
  const std::string filled = what + ", filled with tetrahedra";
  if (mesh.tets.empty()) throw Error(Exit::scene, what + ": could not be filled with tetrahedra: no inside was found; try another edge_length");
  check_tets(mesh, filled);
  const TriMesh surface = surface_of(mesh);
  const Index parts = component_count(connected_components(surface)), parts_given = component_count(connected_components(given));
  if (parts != parts_given)
    throw Error(Exit::scene,
                filled + ": " + std::to_string(parts) + " closed surfaces instead of " + std::to_string(parts_given) + "; use a smaller edge_length");
  const double v = volume(mesh), v_given = mass_properties(given).volume;
  if (!(std::abs(v - v_given) <= 0.2 * v_given))
    throw Error(Exit::scene, filled + ": volume " + std::to_string(100 * v / v_given) + " % of the given surface's; use a smaller edge_length");
}

// Often a mesh drawn in millimetres and taken for metres.
std::string too_fine(const TriMesh& surface, double edge_length) {
  const Vec3 size = bounds_of(surface.points).size();
  std::ostringstream text;
  text.precision(3);
  text << "it is " << size[0] << " m x " << size[1] << " m x " << size[2] << " m, far too large to be filled at an edge_length of " << edge_length
       << " m";
  if (size.maxCoeff() > 0.5) text << "; if the file is in millimetres, add 'scale: 0.001'";
  return text.str();
}

MeshingBegins begins = nullptr;

}  // namespace

void tell_of_meshing(MeshingBegins whom) { begins = whom; }

TetMesh tetrahedralise(const TriMesh& surface, const TetrahedraliseOptions& given, const std::string& what) {
  TetrahedraliseOptions options = given;
  if (options.surface_edge_length == 0) options.surface_edge_length = options.edge_length;
  if (options.facet_distance == 0) options.facet_distance = options.surface_edge_length / 20;
  for (double x : {options.edge_length, options.surface_edge_length, options.facet_distance, options.feature_angle, options.facet_angle,
                   options.radius_edge_ratio})
    if (!(x > 0) || !std::isfinite(x)) throw Error(Exit::scene, what + ": edge lengths and the other options of tetrahedralisation must be positive");

  const TetCache cache(surface, options);
  if (std::optional<TetMesh> known = cache.load()) return *std::move(known);
  check_closed_surface(surface, what);
  const double estimate = 9 * mass_properties(surface).volume / std::pow(options.edge_length, 3);
  if (estimate > 1e8) throw Error(Exit::scene, what + ": " + too_fine(surface, options.edge_length));
  if (begins) begins(what, estimate);
  TetMesh mesh = mesh_domain(surface, options);
  check_result(surface, mesh, what);
  cache.store(mesh);
  return mesh;
}

}  // namespace mortise::geometry
