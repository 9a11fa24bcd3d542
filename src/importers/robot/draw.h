#pragma once
#include "importers/robot/machine.h"

namespace mortise::importers {

// Says with which mesh pictures show each body: a single visual mesh as it is; several, or meshes beside primitives, or one that is scaled along
// single axes, as one file with all of them and their colours, written into `folder`. A body without visual meshes is drawn as what touches.
void draw_bodies(Machine& machine, const std::string& folder);

}  // namespace mortise::importers
