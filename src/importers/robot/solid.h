#pragma once
#include "geometry/mesh.h"
#include "importers/robot/robot.h"

namespace mortise::importers {

// Cells of a shape's mesh in the scene [m]: flat sides are single cells, round ones have eight corners or more.
double edge_length(const Shape& shape);

// The surface that the scene will have, in the frame that `at` leads into.
geometry::TriMesh surface(const Shape& shape, const Pose& at);

// Corners of the box around a shape in its own frame, turned and moved by `at`; enough to find what lies lowest, and where cameras stand.
std::pair<Vec3, Vec3> bounds(const Shape& shape, const Pose& at);

// Do they come nearer to each other than `distance` [m], or lie in each other?
bool meet(const geometry::TriMesh& a, const geometry::TriMesh& b, double distance);

}  // namespace mortise::importers
