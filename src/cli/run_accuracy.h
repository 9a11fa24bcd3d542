#pragma once
#include <string>
#include <vector>

#include "run/options.h"

namespace mortise::cli {

// `mortise run --accuracy`: refined until the numbers are good enough; the results of the best run end up in the output folder. most: CPU time of all
// runs [s]. Returns the exit code: 7 where it could not be reached.
int run_to_accuracy(const run::Options& options, const std::vector<std::string>& goals, double most);

}  // namespace mortise::cli
