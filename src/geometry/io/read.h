#pragma once
// Mesh files by extension. Coordinates are taken as the file writes them: no axis is exchanged (a glTF file stays y up, a
// DAE file keeps its up_axis), units stated in DAE files are converted to metres, node transforms are applied.
// Errors: unreadable file Exit::file, broken content Exit::scene with file and line where the format has lines.
#include <string>

#include "geometry/mesh.h"

namespace mortise::geometry {

// .obj .stl .ply .glb .gltf .dae .msh -> one surface, all objects of the file together. Points closer than `weld_tolerance` [m]
// become one (0: only equal positions: formats repeat points for normals and texture seams); triangles that collapse in
// this are dropped. A .msh file with tetrahedra gives their boundary. Not checked: see check_closed_surface.
TriMesh read_surface(const std::string& path, double weld_tolerance = 0);

// Same formats without .msh, with normals, texture coordinates and materials.
VisualMesh read_visual(const std::string& path);

// .msh with tetrahedra, of first or second order. If all tetrahedra are negatively oriented the file uses the other vertex order and all are turned;
// single inverted ones stay as they are: see check_tets.
TetMesh read_tets(const std::string& path);

// Merges points closer than `tolerance` [m] into the one that comes first (0: equal positions), drops triangles that
// collapse and points no longer used.
TriMesh weld(const TriMesh& mesh, double tolerance);

}  // namespace mortise::geometry
