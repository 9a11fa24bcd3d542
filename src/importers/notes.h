#pragma once
#include <string>
#include <vector>

#include "base/error.h"

namespace mortise::importers {

// What an import left out, changed or assumed. Told once, with the first place and how often it came.
class Notes {
 public:
  void add(const SourceLoc& at, const std::string& what);
  // "robot.urdf:12:5: warning: <transmission> is not imported (and 11 more)"
  std::vector<std::string> lines() const;

 private:
  struct Note {
    SourceLoc at;
    std::string what;
    int more = 0;
  };
  std::vector<Note> notes_;
};

}  // namespace mortise::importers
