#pragma once
#include "importers/robot/robot.h"

namespace mortise::importers {

// Gives links without mass of their own that of their shapes, where these have any (MJCF: inertiafromgeom). Those that say so (`weighed`) also where
// they have one.
void weigh(Robot& robot);

// Of a solid of this mass: mass, centre and tensor in the frame that shapes stand in. Exact for all but meshes, whose polyhedron it is of; of one
// that encloses no volume the convex hull counts.
Inertial inertial_of(const Shape& shape, double mass);

double volume(const Shape& shape);  // [m^3]

}  // namespace mortise::importers
