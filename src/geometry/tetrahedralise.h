#pragma once
#include <string>

#include "geometry/mesh.h"

namespace mortise::geometry {

// Lengths in metres, angles in radians.
struct TetrahedraliseOptions {
  double edge_length = 0;          // aim inside the body; required
  double surface_edge_length = 0;  // aim on the surface and along sharp edges; 0: edge_length
  double facet_distance = 0;       // most distance between a facet's centre and the given surface; 0: surface_edge_length / 20
  double feature_angle = 0.7;      // edges with a larger angle between the normals of their triangles are sharp and are kept
  double facet_angle = 0.436;      // no surface triangle has a smaller angle, away from sharp edges
  double radius_edge_ratio = 2;    // most circumradius over shortest edge of a tetrahedron
};

// `what` is being filled, with about so many tetrahedra: it may take minutes, and who waits wants to know. Nobody is told at first.
using MeshingBegins = void (*)(const std::string& what, double tetrahedra);
void tell_of_meshing(MeshingBegins whom);

// Fills a closed surface with tetrahedra: Delaunay refinement, then sliver removal (CGAL Mesh_3; Jamin, Alliez, Yvinec,
// Boissonnat, "CGALmesh", ACM TOMS 41(4), 2015). The surface is remeshed. The same input gives the same mesh bit for bit.
// `surface` is checked first (check_closed_surface), the result last (check_tets, and: same number of parts, volume within 20 %).
// Results are kept on disk under a hash of everything they depend on: in $MORTISE_CACHE (set but empty: nowhere), else
// $XDG_CACHE_HOME/mortise, else ~/.cache/mortise. A damaged cache file is made anew; a folder that cannot be written is ignored.
// Errors: Exit::scene, beginning with `what`.
TetMesh tetrahedralise(const TriMesh& surface, const TetrahedraliseOptions& options, const std::string& what);

}  // namespace mortise::geometry
