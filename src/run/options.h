#pragma once
#include <functional>
#include <string>
#include <vector>

#include "base/params.h"
#include "engine/engine.h"
#include "model/input.h"

namespace mortise::run {

// How wrong the scene's `quantities` are, for the certificate of a run that has taken all of its steps.
struct Estimated {
  std::string json;
  double worst = NAN;                 // of the estimated errors, as a share of the quantity; NaN: none is estimated
  std::vector<std::string> warnings;  // what the user should know
};
// engine: none where no step led to the state, and only values are to be had. fields: path of the run's field file.
using Estimate = std::function<Estimated(engine::Engine* engine, const model::ModelInput& input, const std::string& fields)>;

// The command line of `mortise run`.
struct Options {
  std::string scene;                   // path, "-" = standard input
  std::vector<std::string> overrides;  // --set a.b=c
  std::string output;                  // folder; empty: out/<scene name>, of one environment its folder in there
  long environment = -1;               // of a scene with `environments`: this one alone, as a scene of its own
  long episode = -1;                   // and of its episodes this one; -1: all that its resets make
  std::vector<Params> resets{};        // conditions that end the run: entries of environments.reset
  long most_steps = -1;                // stop after so many steps
  bool overwrite = false;
  std::string resume;           // "": no; "yes": needs a checkpoint; "auto": a checkpoint if there is one
  double walltime = 0;          // stop in good time before so many seconds are over; 0: no limit
  double grace = 60;            // how long before [s]
  double checkpoint_every = 0;  // [s] in the place of what the scene says; 0 and below: that
  long frames = -1;             // stop after so many frames (the state at the start does not count)
  std::string bridge;           // command of the partner that drives, "-" = the standard streams (src/bridge)
  long bridge_every = 1;        // steps between its messages
  double bridge_timeout = -1;   // [s] for its answer; 0: none, below: the usual
  std::string replay;           // recording of a partner, or the output folder that holds it
  std::string together;         // environments of a scene in a model: a number, "all" or "auto"; empty: none (on a GPU all, where they can)
  long in_turn = 1;             // runs of this process, this one among them, which take their turns
  bool no_render = false;
  bool json = false;  // events as JSON lines on stdout
  bool quiet = false;
  std::string device = "auto";  // as engine::choose takes it
  int threads = 0;              // 0: what the machine grants
  Estimate estimate{};          // none: certificates are without
};

}  // namespace mortise::run
