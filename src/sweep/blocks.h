#pragma once
// The blocks that a table of rows is made of.
#include <string>
#include <vector>

#include "scene/diagnostics.h"
#include "scene/yaml.h"
#include "sweep/sweep.h"

namespace mortise::sweep {

std::vector<std::string> block_names();  // product, zip, random, latin_hypercube, file

// The rows of one block, e.g. {zip: {a.b: [1, 2], c.d: [3, 4]}}; `folder`: where paths in it start. What is wrong is added to the errors.
std::vector<Row> rows_of_block(const scene::Node& block, const std::string& folder, scene::Diagnostics& errors);

}  // namespace mortise::sweep
