#pragma once
#include <optional>

#include "base/params.h"
#include "geometry/mesh.h"

namespace mortise::geometry {

// The `shape` block of a body (scene format: exactly one of box, sphere, cylinder, capsule, mesh, parts) as a mesh in the body's own
// frame [m]; position and rotation are the caller's. Everything returned has passed check_tets / check_closed_surface.
// Errors carry the block's place in the scene.

// How the tetrahedra of a soft body approximate: order 1 or 2. `curved` puts the middles of surface edges of a sphere, cylinder or
// capsule onto its surface; without it (and for all other shapes) edges are straight.
struct ElementOrder {
  long order = 1;
  bool curved = false;
};

// For soft bodies. mesh: tetrahedra of a .msh file as they are, with their own middle nodes if the file is of second order; any
// other file is a closed surface and is filled with tetrahedra of `edge_length` (required then), its surface remeshed with
// `surface_edge_length`.
TetMesh tet_shape(const Params& shape, const ElementOrder& element = {});

// The surface of the file that tet_shape fills with tetrahedra, by which it remeshes it; nothing of other shapes.
std::optional<TriMesh> remeshed_surface(const Params& shape);

// For stiff bodies. mesh: the surface of the file as it is; parts: the surfaces of all, each placed. single: cells along a side of a box where
// one would do.
TriMesh surface_shape(const Params& shape, Index single = 1);

}  // namespace mortise::geometry
