#pragma once
#include <string>
#include <vector>

#include "cli/flags.h"

namespace mortise::cli {

// Flags of `mortise bench hard` and `mortise bench fuzz`.
struct HardFlags {
  bool wild = false, quick = false, full = false, as_is = false;
  std::vector<std::string> only;
  std::string output;
  std::string expect;  // a committed result
  double limit = 0;    // seconds per run; 0: by the length of the cases
  unsigned long seeds = 100, first_seed = 1;
};
void add_hard_flags(Command sub, HardFlags& flags);

constexpr const char* kHardHelp = "hard cases of contact, one process per run, judged by their own criteria (H01 to H77)";

constexpr const char* kFuzzHelp = "random scenes under the checks of the hard cases (--seeds N --first S)";

int bench_fuzz(const HardFlags& flags, const std::string& result, int threads, bool json);
int bench_hard(const HardFlags& flags, const std::string& scenes, const std::string& result, int threads, bool json);

}  // namespace mortise::cli
