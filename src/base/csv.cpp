#include "base/csv.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/read_file.h"

namespace mortise {
namespace {

struct Field {
  std::string text;
  int place;  // of its first character in the line, from 1
};

std::vector<Field> split(const std::string& line) {
  std::vector<Field> out;
  for (std::size_t begin = 0;;) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    const std::size_t first = std::min(line.find_first_not_of(" \t", begin), end), last = line.find_last_not_of(" \t", end - 1);
    const bool none = first >= end || end == begin;
    std::string text = none ? "" : line.substr(first, last + 1 - first);
    if (text.size() > 1 && text.front() == '"' && text.back() == '"') text = text.substr(1, text.size() - 2);  // as spreadsheets write it
    out.push_back({std::move(text), static_cast<int>(none ? begin : first) + 1});
    if (end == line.size()) return out;
    begin = end + 1;
  }
}

double number(const Field& f, const SourceLoc& at) {
  double v = 0;
  const char *begin = f.text.c_str() + (f.text.rfind('+', 0) == 0), *stop = f.text.c_str() + f.text.size();
  const auto [end, code] = std::from_chars(begin, stop, v);
  if (f.text.empty()) throw Error(Exit::scene, at, "a number is missing");
  if (code != std::errc{} || end != stop || !std::isfinite(v)) throw Error(Exit::scene, at, "'" + f.text + "' is not a number");
  return v;
}

}  // namespace

const Csv::Column& Csv::column(const std::string& name) const {
  for (const Column& c : columns)
    if (c.name == name || c.name + " [" + c.unit + "]" == name) return c;
  std::string known;
  for (const Column& c : columns) known += (known.empty() ? "'" : ", '") + c.name + "'";
  throw Error(Exit::scene, SourceLoc{path, header, 1}, "has no column '" + name + "'; there are: " + known);
}

Csv read_csv(const std::string& path) {
  const std::string text = read_regular_file(path, max_bytes::scene);
  Csv out{path, 0, {}, {}};
  int n = 0;
  for (std::size_t begin = after_mark(text); begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string line = text.substr(begin, end - begin);
    begin = end + 1, ++n;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    const std::size_t first = line.find_first_not_of(" \t");
    if (first == std::string::npos || line[first] == '#') continue;
    const std::vector<Field> fields = split(line);
    if (out.header == 0) {
      out.header = n;
      for (const Field& f : fields) {
        const SourceLoc at{path, n, f.place};
        const std::size_t open = f.text.find('['), close = f.text.find(']');
        if ((open == std::string::npos) != (close == std::string::npos) ||
            (close != std::string::npos && (close < open || close + 1 != f.text.size())))
          throw Error(Exit::scene, at, "'" + f.text + "' is not a name with a unit in brackets, as in 'elbow [deg]'");
        Csv::Column c{f.text.substr(0, open), open == std::string::npos ? "" : f.text.substr(open + 1, close - open - 1), f.place, {}};
        c.name.erase(c.name.find_last_not_of(" \t") + 1);
        if (c.name.empty()) throw Error(Exit::scene, at, "a column has no name");
        for (const Csv::Column& other : out.columns)
          if (other.name == c.name) throw Error(Exit::scene, at, "two columns are called '" + c.name + "'");
        out.columns.push_back(std::move(c));
      }
      continue;
    }
    if (fields.size() != out.columns.size())
      throw Error(Exit::scene, SourceLoc{path, n, 1},
                  "has " + std::to_string(fields.size()) + " entries where line " + std::to_string(out.header) + " names " +
                      std::to_string(out.columns.size()) + " columns");
    for (std::size_t c = 0; c < fields.size(); ++c) out.columns[c].values.push_back(number(fields[c], SourceLoc{path, n, fields[c].place}));
    out.lines.push_back(n);
  }
  if (out.header == 0) throw Error(Exit::scene, SourceLoc{path, 1, 1}, "is empty; its first line should name the columns");
  if (out.lines.empty()) throw Error(Exit::scene, SourceLoc{path, out.header, 1}, "has no line of numbers");
  return out;
}

}  // namespace mortise
