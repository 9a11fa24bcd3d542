#pragma once
#include <string>
#include <vector>

#include "CLI/CLI.hpp"

namespace mortise::cli {

// Flags of `mortise bench hard` and `mortise bench fuzz`.
struct HardFlags {
  bool quick = false, full = false;
  std::vector<std::string> only;
  std::string output = "out/hard";
};
void add_hard_flags(CLI::App& sub, HardFlags& flags);

constexpr const char* kHardHelp = "hard cases of contact, one process per run, judged by their own criteria (H01-H73)";

int bench_hard(const HardFlags& flags, const std::string& scenes, const std::string& result, int threads, bool json);

}  // namespace mortise::cli
