#include "importers/notes.h"

#include <algorithm>

namespace mortise::importers {

void Notes::add(const SourceLoc& at, const std::string& what) {
  const auto same = std::find_if(notes_.begin(), notes_.end(), [&](const Note& n) { return n.what == what; });
  if (same == notes_.end())
    notes_.push_back({at, what});
  else
    ++same->more;
}

std::vector<std::string> Notes::lines() const {
  std::vector<Note> sorted = notes_;
  std::stable_sort(sorted.begin(), sorted.end(), [](const Note& a, const Note& b) { return a.at.line < b.at.line; });
  std::vector<std::string> out;
  for (const Note& n : sorted) out.push_back(n.at.text() + ": warning: " + n.what + (n.more > 0 ? " (and " + std::to_string(n.more) + " more)" : ""));
  return out;
}

}  // namespace mortise::importers
