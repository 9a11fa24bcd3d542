#pragma once
#include <string>
#include <string_view>

namespace mortise {

// Text from outside for a terminal: control characters, which could move the cursor or forge lines, as \n or \x1b. With `lines` line feeds
// and tabs stay.
inline std::string printable(std::string_view text, bool lines = false) {
  constexpr const char* kDigits = "0123456789abcdef";
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    // U+0080 to U+009F are control characters too: C2 80 to C2 9F in UTF-8.
    const bool wide = c == 0xC2 && i + 1 < text.size() && (static_cast<unsigned char>(text[i + 1]) & 0xE0) == 0x80;
    if ((c >= 0x20 && c != 0x7F && !wide) || (lines && (c == '\n' || c == '\t'))) {
      out += text[i];
    } else if (c == '\n') {
      out += "\\n";
    } else {
      out += "\\x", out += kDigits[c >> 4], out += kDigits[c & 15];
    }
  }
  return out;
}

}  // namespace mortise
