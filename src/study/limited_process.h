#pragma once
// A run of `mortise` in a process that may take so much CPU time.
#include <string>
#include <vector>

namespace mortise::study {

// What a run may take; 0: whatever it takes [s].
struct Most {
  double steps = 0;    // as RunResult::seconds: one that takes longer counts as failed
  double process = 0;  // CPU time of all of it
};

enum class Over { none, steps, process };

struct Ended {
  int code;
  double cpu;  // of the process [s]
  Over over;   // for which it was ended
};

// Starts it and waits for its end. fields: the file that it writes its steps to, which is not there yet.
Ended run_limited(const std::vector<std::string>& command, const std::string& log, const Most& most, const std::string& fields);

}  // namespace mortise::study
