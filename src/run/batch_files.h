#pragma once
#include <string>
#include <vector>

#include "base/params.h"
#include "run/environment_end.h"

namespace mortise::run {

// What sums up the environments of a scene from the folders that they left: fields.vtkhdf, episodes.csv where there are resets, and, `drawn`,
// pictures side by side where the scene asks for them.
void write_batch_files(const Params& scene, const std::string& folder, const std::vector<EnvironmentEnd>& ends, bool drawn);

}  // namespace mortise::run
