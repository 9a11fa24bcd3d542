#include "cli/frame_range.h"

#include "base/error.h"

namespace mortise::cli {

FrameRange frame_range(const std::string& text) {
  FrameRange r;
  if (text.empty()) return r;
  const auto number = [&](const std::string& digits) {
    if (digits.empty() || digits.size() > 9 || digits.find_first_not_of("0123456789") != std::string::npos)
      throw Error(Exit::usage, "--frames is '" + text + "'; must be A:B, A: or A, with whole numbers from 0");
    return std::stol(digits);
  };
  const std::size_t colon = text.find(':');
  r.first = number(text.substr(0, colon));
  if (colon == std::string::npos)
    r.last = r.first;
  else if (colon + 1 < text.size())
    r.last = number(text.substr(colon + 1));
  if (r.last >= 0 && r.last < r.first) throw Error(Exit::usage, "--frames is '" + text + "', which ends before it begins");
  return r;
}

}  // namespace mortise::cli
