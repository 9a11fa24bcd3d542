#pragma once
#include <string>

namespace mortise::cli {

// Frames of a run that a flag names.
struct FrameRange {
  long first = 0, last = -1;  // -1: the last one there is
};
// "A:B", "A:" or "A"; all frames where it is empty. Throws Error(Exit::usage) for anything else.
FrameRange frame_range(const std::string& text);

}  // namespace mortise::cli
