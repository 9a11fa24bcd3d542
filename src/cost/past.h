#pragma once
// What finished runs took on this machine: a line of JSON each in times.jsonl of the cache folder (geometry/cache_folder.h).
#include <string>
#include <vector>

namespace mortise::cost {

struct Past {
  std::string physics, kind;  // same_physics, same_kind
  std::string version, cpu, date;
  int threads = 1;
  long steps = 0, iterations = 0;  // that it took, and of Newton's method in them
  double seconds = 0;              // CPU time of the steps [s]
  double model = 0;                // what the model of sizes says of an iteration, on the machine it was made on [s]
};

// Adds it; what cannot be written is not kept. A file that has grown long loses its older half.
void keep(const Past& run);

// Oldest first; of this machine's processor alone. Lines that are damaged are left out.
std::vector<Past> kept_runs();

}  // namespace mortise::cost
