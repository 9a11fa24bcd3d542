#pragma once
// Flat facets leave out a part of a round body: of a sphere, cylinder or capsule the share 1 - V / V_exact of its volume, so of its weight; of the
// stiffness of a bar against bending and twisting about twice that. The surface of a file that is remeshed (`edge_length` of a mesh) is cut by facets
// as well, inside and out: of it the volume between the two surfaces counts kRemeshed times, of the volume of the body. What facets a file has itself
// nobody knows.
#include "model/input.h"

namespace mortise::audit {

// The largest of all bodies whose volume bears on a result: soft ones, stiff ones that go as forces say and whose mass the scene does not state, and
// stiff ones that turn about their own axis on a hinge (by the radius, at which friction acts on them); 0 where there is no round one. Of curved
// elements nothing is left out.
double shape_defect(const model::ModelInput& input);

// Of the shape as it is meant, if it is a sphere, a cylinder or a capsule [m^3]; 0 of others.
double round_volume(const Params& shape);

}  // namespace mortise::audit
