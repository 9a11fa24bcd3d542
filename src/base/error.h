#pragma once
#include <stdexcept>
#include <string>

namespace mortise {

// The exit codes of the program: an interface that batch scripts rely on (README, "Exit codes").
enum class Exit {
  done = 0,
  internal = 1,
  usage = 2,
  scene = 3,    // scene or mesh invalid
  device = 4,   // device missing or out of memory
  solve = 5,    // a step failed; the last good state is on disk
  file = 6,     // cannot read or write
  checks = 7,   // the run is done, but a criterion of its `checks` failed
  stopped = 75  // stopped by a signal with a good checkpoint: run again with --resume
};

// A place in a text file; line and column count from 1, 0 means unknown.
struct SourceLoc {
  std::string file;
  int line = 0;
  int column = 0;
  std::string text() const { return line > 0 ? file + ":" + std::to_string(line) + ":" + std::to_string(column) : file; }
};

// Every failure a user can cause. what() is the whole message, without the "error: " prefix.
class Error : public std::runtime_error {
 public:
  Error(Exit code, const std::string& message) : std::runtime_error(message), code_(code) {}
  Error(Exit code, const SourceLoc& at, const std::string& message)
      : std::runtime_error(at.file.empty() ? message : at.text() + ": error: " + message), code_(code), located_(!at.file.empty()) {}
  Error(Exit code, const std::string& message, bool located) : std::runtime_error(message), code_(code), located_(located) {}
  Exit code() const { return code_; }
  bool located() const { return located_; }  // the message already carries "file:line:col: error:"

 private:
  Exit code_;
  bool located_ = false;
};

}  // namespace mortise
