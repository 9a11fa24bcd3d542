#pragma once
// The engine as the front end sees it: the same code compiled for CPU threads (linked into the program) and for CUDA (a module
// loaded at run time). What crosses this line is plain data - numbers, strings, standard containers, and 3x3 arrays of
// doubles without alignment - and never an exception of ours (type information is private to each side).
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/archive.h"
#include "base/field_sink.h"
#include "device/device_info.h"
#include "model/input.h"
#include "solver/report.h"

namespace mortise::engine {

struct Outcome {
  int code = 0;  // Exit
  std::string message;
  bool located = false;
  std::string picture{};  // of bodies that touch at the start: a Wavefront .obj file
};

struct PlanItem {
  std::string effect;
  std::vector<std::pair<std::string, std::size_t>> buffers;  // what, bytes
  std::vector<std::string> kernels;
};

class Engine {
 public:
  virtual ~Engine() = default;
  // What the first step begins with, and no more: finds bodies that touch at the start.
  virtual Outcome begin() = 0;
  virtual Outcome step(const std::function<bool()>& stop_asked, solver::StepReport& report) = 0;
  virtual void report(FieldSink& sink) = 0;
  virtual std::vector<double> points() = 0;  // 3 per point [m], accepted state
  virtual Outcome checkpoint(Archive& archive) = 0;
  virtual double time() const = 0;
  virtual long steps_done() const = 0;
  virtual solver::Clock clock() const = 0;
  virtual std::vector<std::pair<std::string, long long>> launches() const = 0;
  virtual device::Transfers transfers() const = 0;       // of all kinds of work so far,
  virtual device::Transfers step_transfers() const = 0;  // and of step() alone
  virtual std::size_t peak_memory() const = 0;
  virtual std::vector<PlanItem> plan() = 0;       // after begin()
  virtual std::string linear_solver() const = 0;  // and why
};

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
inline constexpr int kApiVersion = 4;

const Api& cpu_api();
// The CUDA module's; nullptr where it was not built or does not load, with the reason.
const Api* cuda_api(std::string& why_not);

}  // namespace mortise::engine
