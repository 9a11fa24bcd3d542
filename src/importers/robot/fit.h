#pragma once
// Primitives that stand for meshes: as large as the box whose moments of inertia the mesh has, or as the box around it, both along its principal
// axes, the longest along z.
#include "importers/robot/robot.h"

namespace mortise::importers {

// Of all shapes that ask for it (Shape::fit), once their meshes are found. Throws Error with the shape's place.
void fit_primitives(Robot& robot);

}  // namespace mortise::importers
