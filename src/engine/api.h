#pragma once
// What a build of the engine offers, as a table of C functions: the same code compiled for CPU threads (linked into the program) and for CUDA (a
// module loaded at run time).
#include <memory>
#include <string>
#include <vector>

#include "engine/engine.h"
#include "model/input.h"

namespace mortise::engine {

// How fast y = A x runs and how fast the device copies; bytes are those that must be moved at least.
struct Bandwidth {
  Index rows = 0;
  long long blocks = 0;  // 3x3 blocks of all rows
  double multiply_seconds = 0, multiply_bytes = 0, copy_seconds = 0, copy_bytes = 0;
};

// What a build of the engine offers.
struct Api {
  int version;
  std::vector<device::DeviceInfo> (*devices)(std::string* why_none);
  std::vector<std::string> (*architectures)();  // that kernels were compiled for
  Outcome (*select)(int number, bool debug);    // device::select; before the first engine is created
  void (*set_threads)(int);
  Outcome (*create)(const model::ModelInput&, std::unique_ptr<Engine>& out);
  Outcome (*bandwidth)(Index edge, Bandwidth& out);  // of a cube of edge^3 nodes
};
inline constexpr int kApiVersion = 9;

const Api& cpu_api();
// The CUDA module's; nullptr where it was not built or does not load, with the reason.
const Api* cuda_api(std::string& why_not);

}  // namespace mortise::engine
