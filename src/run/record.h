#pragma once
#include <map>
#include <string>
#include <vector>

#include "base/error.h"
#include "engine/engine.h"
#include "output/step_row.h"
#include "run/options.h"
#include "run/stopwatch.h"

namespace mortise::run {

// What run.json says, gathered while the run goes.
struct Record {
  struct End {
    const Options& options;
    std::string scene_name, scene_sha256;
    Exit status;
    std::string message;
    double wall;  // [s]
  };
  device::DeviceInfo device;
  std::vector<output::StepRow> steps;
  std::map<std::string, double> seconds, cpu_seconds;  // setup, solve, estimate, output, pictures, checkpoint
  long frames = 0;

  void spent(const char* part, const Stopwatch& since) { spent(part, since.wall(), since.cpu()); }
  void spent(const char* part, double wall, double cpu) { seconds[part] += wall, cpu_seconds[part] += cpu; }
  // `engine` may be null when the run ended before there was one.
  void write(const std::string& path, const End& end, const engine::Engine* engine) const;
};

}  // namespace mortise::run
