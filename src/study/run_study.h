#pragma once
#include <functional>

#include "study/execute.h"
#include "study/plan.h"
#include "study/results.h"

namespace mortise::study {

struct Told {
  std::function<void(std::size_t done, std::size_t all, const RunResult&)> run = [](std::size_t, std::size_t, const RunResult&) {};
};

// Runs all that is planned and was not run before, and compares. A run that fails is told and the study goes on; Error(Exit::solve) where none is
// left to compare with, Error(Exit::stopped) after a signal.
Results run_study(const Study& study, const Place& place, const Told& told);

// The folder of the study with its runs; nobody else writes there while this lives. Throws Error(Exit::file).
class StudyFolder {
 public:
  explicit StudyFolder(const std::string& path);
  ~StudyFolder();
  StudyFolder(const StudyFolder&) = delete;
  StudyFolder& operator=(const StudyFolder&) = delete;

 private:
  std::string lock_;
  int descriptor_ = -1;
};

// What is known of the machine, for the results.
void describe_machine(const Place& place, Results& results);

// Of benchmarks, which run in this process.
Results run_benchmark_study(const Study& study, const Place& place, const Told& told);

}  // namespace mortise::study
