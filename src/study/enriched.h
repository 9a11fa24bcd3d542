#pragma once
// Scenes beside a scene, for estimates of what it leaves out: the same bodies and parameters on richer meshes, or with a thinner layer of contact.
#include "model/input.h"

namespace mortise::study {

// Soft bodies have quadratic tetrahedra on the same corners, with straight edges. What parameters of contact were left to follow the mesh are what they
// are on the meshes of `input`. `why_not`, where there is nothing to enrich.
model::ModelInput enriched(const model::ModelInput& input, std::string& why_not);

// Contact presses as if all gaps were larger by this share (first order), which is what support radii shorter by it do.
model::ModelInput thinner(const model::ModelInput& input, double share);

}  // namespace mortise::study
