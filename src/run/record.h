#pragma once
#include <map>
#include <string>
#include <vector>

#include "engine/engine.h"
#include "run/options.h"
#include "solver/report.h"

namespace mortise::run {

// What run.json says, gathered while the run goes.
struct Record {
  struct End {
    const Options& options;
    std::string scene_path, scene_sha256;
    Exit status;
    std::string message;
    double wall;  // [s]
  };
  std::string device;
  std::vector<solver::StepReport> steps;
  std::map<std::string, double> seconds;  // output, pictures

  void write(const std::string& path, const End& end, const engine::Engine& engine) const;
};

}  // namespace mortise::run
