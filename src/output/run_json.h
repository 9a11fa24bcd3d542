#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "output/hardware.h"
#include "output/step_row.h"

namespace mortise::output {

// What a run tells about itself in run.json (schemas/run.schema.json).
struct RunRecord {
  struct Device {
    std::string kind;  // "cpu", "debug" or "cuda"
    std::string name;
    int threads = 0;  // CPU threads, or multiprocessors
    std::int64_t memory_bytes = 0;
    std::string driver, runtime, architecture;  // of a GPU
  };
  // Copies between host and device, of the whole run ("all") or of its steps without setup and output ("steps").
  struct Transfers {
    std::string of;
    std::int64_t to_device = 0, bytes_to_device = 0, to_host = 0, bytes_to_host = 0;
  };
  struct Phase {
    std::string effect, phase;  // "elasticity", "assemble"; the solver's own under "solver"
    double seconds = 0;
    std::int64_t calls = 0;
  };
  Exit exit_code = Exit::done;
  std::string message;  // of the error, empty without one
  std::string mortise_version, git_sha1;
  std::map<std::string, std::string> libraries;  // name, version
  Hardware hardware;
  Device device;
  std::string linear_solver;
  std::string scene_name, scene_path, scene_sha256;  // hash of the resolved scene
  std::string command_line;
  double wall_seconds = 0;                    // whole run
  std::map<std::string, double> seconds;      // parts of it: setup, solve, output, pictures ...
  std::map<std::string, double> cpu_seconds;  // the same, user and system time of all threads
  std::vector<Phase> phases;
  std::vector<std::pair<std::string, std::int64_t>> launches;  // per kernel
  std::vector<Transfers> transfers;
  std::vector<std::pair<std::string, std::int64_t>> waits;  // of steps, by who waited
  std::int64_t host_memory_peak_bytes = 0, device_memory_peak_bytes = 0;
  std::int64_t frames = 0;
  std::vector<StepRow> steps;
};

// The JSON text; numbers that are not finite become null.
std::string run_json(const RunRecord& record);

// The exit code in run.json at `path`, if it is of a run of this scene that went to its end; nothing otherwise.
std::optional<Exit> code_of_finished_run(const std::string& path, const std::string& scene_sha256);
// Identity of the scene of that run, ended or not; "": no such file.
std::string scene_of_run(const std::string& path);

// Writes it to `path` (temporary, fsync, rename). To be called last: a run whose run.json exists has ended, and its status says
// how. Throws Error(Exit::file).
void write_run_json(const std::string& path, const RunRecord& record);

}  // namespace mortise::output
