#pragma once
#include <map>
#include <set>
#include <string>
#include <vector>

#include "base/error.h"

namespace mortise::scene {

struct Note {
  SourceLoc at;
  std::string message;
};

// One thing that is wrong in a scene. `at.file` is the scene file, or the whole "--set path=value" with line 0.
struct Diagnostic {
  SourceLoc at;
  std::string message;
  std::string hint;  // printed behind the caret line
  std::vector<Note> notes;
};

// All errors of one scene; what() shows them one below the other with their source lines.
class SceneErrors : public Error {
 public:
  SceneErrors(std::vector<Diagnostic> errors, const SourceLoc& first, const std::string& rest)
      : Error(Exit::scene, first, rest), errors_(std::move(errors)) {}
  const std::vector<Diagnostic>& errors() const { return errors_; }

 private:
  std::vector<Diagnostic> errors_;
};

// Collects errors, so that a user sees all of them at once.
class Diagnostics {
 public:
  explicit Diagnostics(const std::string& text);

  void add(SourceLoc at, std::string message, std::string hint = "", std::vector<Note> notes = {});
  // The override `set` ("--set a=b") took the place of the value at `old`; errors about it cite both.
  void replaces(const std::string& set, const SourceLoc& old) { replaced_.try_emplace(set, old); }
  bool empty() const { return errors_.empty(); }
  [[noreturn]] void raise();  // throws SceneErrors

 private:
  std::string source(const SourceLoc& at, const std::string& hint) const;

  std::vector<std::string> lines_;
  std::vector<Diagnostic> errors_;
  std::set<std::string> seen_;  // place and message of each
  std::map<std::string, SourceLoc> replaced_;
};

}  // namespace mortise::scene
