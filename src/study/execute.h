#pragma once
// Runs scenes of a study, each as `mortise run` in a process and a folder of its own, so that none can harm another or the study.
#include "study/limited_process.h"
#include "study/plan.h"
#include "study/results.h"

namespace mortise::study {

struct Place {
  std::string folder;  // of the study; runs go to FOLDER/runs/<id>
  std::string device;
  int threads = 1;
};

// Runs it, unless FOLDER/runs/<id>.json says that this program has. Throws Error(Exit::stopped) after a signal, Error(Exit::file).
RunResult execute(const Planned& run, const Place& place, int repeats, const Most& most);

// The quantities of a run that did not fail; throws Error(Exit::usage) where its results know no such quantity, unless it may be gone.
void measure_all(const Study& study, const Place& place, RunResult& result, bool may_be_gone = false);

double load_average();  // of the machine over the last minute

}  // namespace mortise::study
