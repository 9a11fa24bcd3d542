#pragma once
// Scenes beside a scene, for estimates of what it leaves out: the same bodies and parameters, but for one thing. What parameters of contact were left to
// follow the mesh are what they are on the meshes of the scene. `why_not`: where there is no such scene.
#include <string>

#include "model/input.h"

namespace mortise::study {

// Linear tetrahedra become quadratic ones on the same corners, with straight edges, quadratic ones are cut into eight. Bodies of both kinds: the linear.
model::ModelInput richer(const model::ModelInput& input, std::string& why_not);

// Contact presses as if all gaps were larger by this share (first order), which is what support radii shorter by it do.
model::ModelInput thinner(const model::ModelInput& input, double share);

// Middles of the edges on spheres, cylinders and capsules go by this share of the way to the surface that the mesh stands for. Of quadratic meshes.
model::ModelInput rounder(const model::ModelInput& input, double share, std::string& why_not);

// Stiff spheres, cylinders and capsules have edges of half the length.
model::ModelInput finer_facets(const model::ModelInput& input, std::string& why_not);

// Mortar contact with more points of integration.
model::ModelInput better_integrated(const model::ModelInput& input, std::string& why_not);

}  // namespace mortise::study
