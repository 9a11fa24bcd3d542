#pragma once
// A model under simulation as the front end sees it, whichever build of the engine holds it (api.h). What crosses this line is plain data -
// numbers, strings, standard containers, and 3x3 arrays of doubles without alignment - and never an exception of ours (type information is
// private to each side).
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/archive.h"
#include "base/field_sinks.h"
#include "device/device_info.h"
#include "effects/fault.h"
#include "model/command.h"
#include "solver/adjoint.h"
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
  // What drives aim at from the next step on, in place of what the scene says; they are no part of a checkpoint.
  virtual void command(const std::vector<model::Command>& commands) = 0;
  // One step of every environment that goes on. Of several, one that fails is lost() and stands where the step began; the outcome is a failure when
  // none is left.
  virtual Outcome step(const std::function<bool()>& stop_asked, const solver::StepReports& report) = 0;
  virtual void rest(Index env) = 0;  // it takes no further step
  // `others` are engines of the same build for the same meshes, with parameters that differ by a hair, and begun like this one: from now on each
  // step of this one takes them along, to first order in the difference (solver/follow.cpp). Theirs are derivatives then: they are never stepped.
  virtual Outcome lead(const std::vector<Engine*>& others) = 0;
  // Of one of those others that is else the same, before it begins: by that share it is right in what the leader is wrong by.
  virtual Outcome mend(effects::Fault fault, double share) = 0;
  // Why this one could not be taken along any farther, or an environment of several could not take a step; empty where it was.
  virtual std::string lost(Index env = 0) const = 0;
  // After a step, with what acted in it: what a number of the state would change by if forces were a little different (solver/adjoint.h).
  virtual Outcome adjoint(const solver::Functional& of, solver::Adjoint& out) = 0;
  virtual void report(const FieldSinks& sinks) = 0;
  virtual std::vector<double> points() = 0;                         // 3 per point [m], accepted state; environment after environment
  virtual Outcome checkpoint(const std::vector<Archive*>& of) = 0;  // of every environment; null: of this one nothing
  Outcome checkpoint(Archive& archive) { return checkpoint(std::vector<Archive*>{&archive}); }
  virtual double time(Index env = 0) const = 0;
  virtual long steps_done(Index env = 0) const = 0;
  virtual solver::Clock clock() const = 0;
  virtual std::vector<std::pair<std::string, long long>> launches() const = 0;
  virtual device::Transfers transfers() const = 0;                                // of all kinds of work so far,
  virtual device::Transfers step_transfers() const = 0;                           // and of step() alone
  virtual std::vector<std::pair<std::string, long long>> step_waits() const = 0;  // its copies to the host, by who waited for them
  virtual std::size_t peak_memory() const = 0;
  virtual std::vector<PlanItem> plan() = 0;       // after begin()
  virtual std::string linear_solver() const = 0;  // and why
};

}  // namespace mortise::engine
