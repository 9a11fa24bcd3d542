#include "scene/diagnostics.h"

#include <algorithm>
#include <span>

#include "base/printable.h"

namespace mortise::scene {
namespace {

// Bytes of the word, quoted text or bracket that starts at `from`: what the caret line underlines.
std::size_t token_length(const std::string& line, std::size_t from) {
  const std::size_t n = line.size();
  if (from >= n) return 1;
  const char first = line[from];
  std::size_t end = from + 1;
  if (first == '"' || first == '\'') {
    while (end < n && line[end] != first) ++end;
    return std::min(end + 1, n) - from;
  }
  if (first == '[' || first == '{') {
    int depth = 1;
    while (end < n && depth > 0) {
      if (line[end] == '[' || line[end] == '{') ++depth;
      if (line[end] == ']' || line[end] == '}') --depth;
      ++end;
    }
    return depth == 0 ? end - from : 1;
  }
  while (end < n) {
    const char c = line[end];
    if (c == ',' || c == ']' || c == '}' || c == '{') break;
    if (c == ':' && (end + 1 == n || line[end + 1] == ' ')) break;
    if (c == '#' && line[end - 1] == ' ') break;
    ++end;
  }
  while (end > from + 1 && line[end - 1] == ' ') --end;
  return end - from;
}

// Columns are bytes; a continuation byte of UTF-8 takes no place on the screen.
bool takes_place(char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }

}  // namespace

Diagnostics::Diagnostics(const std::string& text) {
  std::string line;
  for (char c : text) {
    if (c == '\n') {
      lines_.push_back(std::move(line));
      line.clear();
    } else if (c != '\r') {
      line += (static_cast<unsigned char>(c) < 0x20 && c != '\t') || c == 0x7F ? '?' : c;  // as printable(), but every byte keeps its column
    }
  }
  lines_.push_back(std::move(line));
}

void Diagnostics::add(SourceLoc at, std::string message, std::string hint, std::vector<Note> notes) {
  message = printable(message), hint = printable(hint);
  if (!seen_.insert(at.text() + '\n' + message).second) return;  // an alias that is used twice is wrong once
  errors_.push_back({std::move(at), std::move(message), std::move(hint), std::move(notes)});
}

// "   23 |   mu: -1\n      |       ^~ hint\n"
std::string Diagnostics::source(const SourceLoc& at, const std::string& hint) const {
  if (at.line < 1 || at.line > static_cast<int>(lines_.size()) || lines_[at.line - 1].empty()) return hint.empty() ? "" : "      | " + hint + "\n";
  const std::string& line = lines_[at.line - 1];
  const std::size_t column = std::min<std::size_t>(std::max(at.column, 1) - 1, line.size());
  const std::size_t length = token_length(line, column);

  // A very long line is shown in part.
  constexpr std::size_t kWidth = 110;
  std::size_t begin = 0;
  if (column > kWidth - 30) begin = column - 40;
  while (begin > 0 && !takes_place(line[begin])) --begin;
  std::string shown = line.substr(begin), before = line.substr(begin, column - begin);
  if (begin > 0) shown = "..." + shown, before = "..." + before;
  if (shown.size() > kWidth) {
    std::size_t cut = kWidth;
    while (cut > 0 && !takes_place(shown[cut])) --cut;
    shown = shown.substr(0, cut) + "...";
  }

  std::string number = std::to_string(at.line);
  number.insert(0, number.size() < 5 ? 5 - number.size() : 0, ' ');
  std::string caret;
  for (char c : before)
    if (takes_place(c)) caret += c == '\t' ? '\t' : ' ';
  caret += '^';
  for (std::size_t i = column + 1; i < std::min(column + length, line.size()) && caret.size() < kWidth; ++i)
    if (takes_place(line[i])) caret += '~';
  return number + " | " + shown + "\n" + std::string(number.size(), ' ') + " | " + caret + (hint.empty() ? "" : " " + hint) + "\n";
}

void Diagnostics::raise() {
  std::stable_sort(errors_.begin(), errors_.end(),
                   [](const Diagnostic& a, const Diagnostic& b) { return std::pair(a.at.line, a.at.column) < std::pair(b.at.line, b.at.column); });
  std::string out;
  constexpr std::size_t kShown = 100;
  const std::size_t shown = std::min(errors_.size(), kShown);
  for (const Diagnostic& d : std::span(errors_).first(shown)) {
    // Error prepends "file:line:col: error: " to the first one.
    if (&d != &errors_.front()) out += d.at.text() + ": error: ";
    out += d.message + "\n" + source(d.at, d.hint);
    if (const auto old = replaced_.find(d.at.file); old != replaced_.end())
      out += old->second.text() + ": note: the value it replaces\n" + source(old->second, "");
    for (const Note& n : d.notes) out += n.at.text() + ": note: " + n.message + "\n" + source(n.at, "");
  }
  if (shown < errors_.size()) out += "and " + std::to_string(errors_.size() - shown) + " more errors\n";
  out.pop_back();  // what() ends without a newline, like every message
  const SourceLoc first = errors_.front().at;
  throw SceneErrors(std::move(errors_), first, out);
}

}  // namespace mortise::scene
