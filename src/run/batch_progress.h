#pragma once
#include <chrono>
#include <string>

#include "run/environment_end.h"

namespace mortise::run {

// Tells the user how a batch goes: one line that rewrites itself on a terminal, one line per environment otherwise (both on stderr), or the events of
// all environments with their number, as JSON lines on stdout.
class BatchProgress {
 public:
  BatchProgress(bool json, bool quiet);
  void start(const std::string& scene, const std::string& summary, long environments, long steps);
  // An event of an environment's own progress, as JSON.
  void event(long environment, const std::string& line);
  void note(const std::string& text);
  void ended(long environment, const EnvironmentEnd& end);
  void end(const std::string& status, double seconds);
  bool lost() const { return lost_; }

 private:
  void line(const std::string& text);
  void put(const std::string& json);
  void draw();
  void clear();

  bool json_, quiet_, terminal_, open_ = false, lost_ = false;
  long environments_ = 0, steps_ = 0, ended_ = 0, failed_ = 0, steps_done_ = 0;
  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now(), drawn_{};
};

}  // namespace mortise::run
