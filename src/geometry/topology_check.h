#pragma once
// What a mesh must satisfy before anything is simulated with it. Every check throws Error(Exit::scene) that names the first
// offending element (by index from 0 and position in metres) and says how many there are.
#include <string>
#include <utility>
#include <vector>

#include "geometry/mesh.h"

namespace mortise::geometry {

// Finite coordinates; no degenerate and no duplicate triangle; closed; no edge with more than two triangles; consistently
// oriented; no vertex where two sheets touch in a point; outside out; free of self-intersections (exact predicates); parts inside of others
// are cavities, which face inwards.
// `what` begins the message: "mesh 'gear.stl'".
void check_closed_surface(const TriMesh& mesh, const std::string& what);

// Finite coordinates; every tetrahedron positively oriented and not degenerate (volume above 1e-9 of its longest edge cubed);
// boundary closed and manifold.
void check_tets(const TetMesh& mesh, const std::string& what);

// A triangle of a part that lies inside of another one and is no cavity of it, or of a cavity outside of everything; -1: there is none. The
// surface must be closed, oriented and free of self-intersections.
Index first_wrongly_nested(const TriMesh& mesh);

// Pairs of triangles that share more than a common vertex or edge, sorted; decided with exact predicates (CGAL). The surface
// must be an oriented manifold without degenerate triangles (the checks above come first).
std::vector<std::pair<Index, Index>> self_intersections(const TriMesh& mesh);

}  // namespace mortise::geometry
