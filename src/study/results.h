#pragma once
// What a study found.
#include <string>
#include <vector>

#include "study/limit.h"
#include "study/study.h"

namespace mortise::study {

// How a run ended and what it cost. Cost is CPU time, user and system, of all threads; on a GPU wall time.
struct RunResult {
  std::string id, label;
  int code = 0;          // exit code
  std::string message;   // of the error
  double seconds = NAN;  // of the steps, without setup and output; of the fastest repeat
  double slowest = NAN;  // of the slowest repeat
  double process = 0;    // of whole processes, all repeats
  double load = 0;       // of the machine: largest average over a minute, before and after
  long newton = 0, dofs = 0;
  std::string grade;           // of its certificate
  bool before = false;         // it was there already
  std::vector<double> values;  // of the quantities; NaN where it failed
  bool failed() const { return code != static_cast<int>(Exit::done) && code != static_cast<int>(Exit::checks); }
};

// What a quantity is compared with.
struct Reference {
  double value = NAN, uncertainty = NAN;  // NaN: not known
  double scale = 1;                       // errors are shares of this; 1 where they are not relative
  bool relative = true;
  std::string how{};
};

// One quantity of one run, on one curve.
struct Point {
  std::string curve, label, run;
  Settings settings;
  std::size_t quantity = 0, method = 0, step = 0;  // step: of the ladder; SIZE_MAX: the scene as it is
  double value = NAN, error = NAN, seconds = NAN, slowest = NAN;
  long newton = 0, dofs = 0;
  bool failed = false;
  std::string why;         // it failed
  std::string cancel;      // errors of knobs that cancel: "mesh +39 % and d_hat -44 %"
  bool reference = false;  // the others are compared with it
  bool hollow = false;     // its error is below the uncertainty of the reference
  bool best = false;       // on the Pareto front: nothing faster is as accurate
  bool knee = false;       // where the front bends
  bool refines = true;     // along a ladder that converges; false: alternatives
};

// How much of the error of the scene as it is a ladder accounts for.
struct Share {
  std::string method, ladder;
  std::size_t quantity = 0;
  double error = NAN;  // of this knob alone, as a share of the scale
  Limit limit;
};

struct Results {
  Study study;
  std::vector<RunResult> runs;
  std::vector<Reference> references;  // one per quantity
  std::vector<Point> points;
  std::vector<Share> shares;  // one knob at a time only
  std::string cpu, version, device;
  int cores = 0, threads = 0;
  double load = 0;  // the largest of all runs
  std::vector<std::string> notes;
};

}  // namespace mortise::study
