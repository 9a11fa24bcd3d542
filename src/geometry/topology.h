#pragma once
// Which triangles bound a mesh, what they enclose, and how they hang together.
#include <string>
#include <vector>

#include "geometry/mesh.h"

namespace mortise::geometry {

// Faces of tetrahedra that belong to one tetrahedron only, outward, in the order of the tetrahedra; ids of `mesh.points`.
std::vector<Triangle> boundary_triangles(const TetMesh& mesh);

// The boundary as a mesh of its own: points that no boundary triangle uses are dropped, the rest keep their order.
// `source`, if given, receives the point of `mesh` behind each point of the result.
TriMesh surface_of(const TetMesh& mesh, std::vector<Index>* source = nullptr);

// The triangles of `more` behind those of `to`.
void append(const TriMesh& more, TriMesh& to);

// Drops points that no element uses; the rest keep their order.
TriMesh without_unused_points(const TriMesh& mesh);
TetMesh without_unused_points(const TetMesh& mesh);

// Unique edges with v[0] < v[1], sorted.
std::vector<Edge> unique_edges(const std::vector<Triangle>& triangles);

// A third of the area of the triangles around each vertex / at each edge [m^2]; both sum up to the area of the surface.
std::vector<double> vertex_areas(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles);
std::vector<double> edge_areas(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles, const std::vector<Edge>& edges);

double area(const TriMesh& mesh);                                    // [m^2]
double volume(const TetMesh& mesh);                                  // [m^3], signed
double tet_volume(const std::vector<Vec3>& points, const Tet& tet);  // [m^3], signed
double min_dihedral_angle(const TetMesh& mesh);                      // [rad]

// Integrals over the inside of a closed surface, exact for the polyhedron.
struct MassProperties {
  double volume = 0;                   // int dV [m^3], negative if the surface is inside out
  Vec3 centroid = Vec3::Zero();        // int x dV / volume [m]
  Mat3 second_moment = Mat3::Zero();   // int X X^T dV with X = x - centroid [m^5]
  Mat3 inertia(double density) const;  // tensor of inertia about the centroid [kg m^2]
};
MassProperties mass_properties(const TriMesh& mesh);
// int rho X X^T dV of a body with the tensor of inertia I = int rho (X.X 1 - X X^T) dV: tr(I)/2 1 - I.
Mat3 second_moment_of(const Mat3& inertia);

// Component of each point (points joined by triangle edges), numbered by first point; -1 for unused points.
std::vector<Index> connected_components(const TriMesh& mesh);
Index component_count(const std::vector<Index>& component);

}  // namespace mortise::geometry
