#include "bench/ccd/ccd.h"

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string_view>

#include "base/error.h"
#include "geometry/collide/ccd.h"

namespace mortise::bench {
namespace {

namespace fs = std::filesystem;

bool is_integer(std::string_view s) {
  if (!s.empty() && s[0] == '-') s.remove_prefix(1);
  return !s.empty() && std::all_of(s.begin(), s.end(), [](char c) { return c >= '0' && c <= '9'; });
}

// The double of a fraction. In the data these are exact; anything else is rounded to the nearest.
double fraction(const std::string& numerator, const std::string& denominator, const SourceLoc& at) {
  if (!is_integer(numerator) || !is_integer(denominator)) throw Error(Exit::file, at, "expected integers \"numerator,denominator\"");
  constexpr std::size_t kExact = 15;  // decimal digits that surely fit a double
  if (numerator.size() <= kExact && denominator.size() <= kExact) {
    const double d = std::strtod(denominator.c_str(), nullptr);
    if (d != 0) return std::strtod(numerator.c_str(), nullptr) / d;
  }
  // Leading zeros would read as octal.
  const auto integer = [](const std::string& s) {
    const bool negative = s[0] == '-';
    const std::size_t digits = std::min(s.find_first_not_of('0', negative ? 1 : 0), s.size() - 1);
    const boost::multiprecision::cpp_int n(s.substr(digits));
    return negative ? boost::multiprecision::cpp_int(-n) : n;
  };
  const boost::multiprecision::cpp_int d = integer(denominator);
  if (d == 0) throw Error(Exit::file, at, "a denominator is 0");
  return boost::multiprecision::cpp_rational(integer(numerator), d).convert_to<double>();
}

void run(const std::vector<CcdQuery>& queries, bool edges, CcdScore& score) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> impact(queries.size());
  const auto start = Clock::now();
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const CcdQuery& q = queries[i];
    impact[i] = edges ? geometry::ccd_edge_edge(q.x0, q.x1, 0, 1) : geometry::ccd_point_triangle(q.x0, q.x1, 0, 1);
  }
  score.seconds += std::chrono::duration<double>(Clock::now() - start).count();
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const bool found = impact[i] <= 1;
    ++score.queries;
    score.impacts += queries[i].impact;
    score.false_negatives += queries[i].impact && !found;
    score.false_positives += !queries[i].impact && found;
  }
}

}  // namespace

std::vector<CcdQuery> read_ccd_queries(const fs::path& file) {
  std::ifstream in(file);
  if (!in) throw Error(Exit::file, "cannot read " + file.string());
  std::vector<CcdQuery> queries;
  SourceLoc at{file.string(), 0, 0};
  int row = 0;
  for (std::string line; std::getline(in, line);) {
    ++at.line;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty()) continue;
    std::string field[7];
    std::size_t begin = 0;
    for (int k = 0; k < 7; ++k) {
      const std::size_t comma = line.find(',', begin);
      if ((comma == std::string::npos) != (k == 6)) throw Error(Exit::file, at, "expected 7 columns");
      field[k] = line.substr(begin, comma - begin);
      begin = comma + 1;
    }
    if (row == 0) queries.emplace_back();
    CcdQuery& q = queries.back();
    Vec3& x = row < 4 ? q.x0[row] : q.x1[row - 4];
    for (int d = 0; d < 3; ++d) x[d] = fraction(field[2 * d], field[2 * d + 1], at);
    if (field[6] != "0" && field[6] != "1") throw Error(Exit::file, at, "the truth must be 0 or 1");
    q.impact = field[6] == "1";
    row = (row + 1) % 8;
  }
  if (row != 0) throw Error(Exit::file, at, "the last query has fewer than 8 rows");
  return queries;
}

CcdBench ccd_bench(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code failed;
  for (const auto& entry : fs::directory_iterator(folder, failed))
    if (entry.path().extension() == ".csv") files.push_back(entry.path());
  if (failed) throw Error(Exit::file, "cannot read folder " + folder.string() + ": " + failed.message());
  std::sort(files.begin(), files.end());
  CcdBench bench;
  for (const fs::path& file : files) {
    const std::string name = file.filename().string();
    const bool edges = name.find("edge-edge") != std::string::npos;
    if (!edges && name.find("vertex-face") == std::string::npos) continue;
    run(read_ccd_queries(file), edges, edges ? bench.edge_edge : bench.point_triangle);
  }
  if (bench.point_triangle.queries + bench.edge_edge.queries == 0)
    throw Error(Exit::file, "no query files (*edge-edge*.csv, *vertex-face*.csv) in " + folder.string());
  return bench;
}

std::string CcdBench::text() const {
  std::string out = "kind             queries   impacts  false negatives  false positives  us/query\n";
  for (const auto& [name, s] : {std::pair{"point-triangle", &point_triangle}, std::pair{"edge-edge", &edge_edge}}) {
    char line[160];
    std::snprintf(line, sizeof line, "%-14s %9lld %9lld %16lld %16lld %9.3f\n", name, s->queries, s->impacts, s->false_negatives, s->false_positives,
                  s->microseconds_per_query());
    out += line;
  }
  return out;
}

}  // namespace mortise::bench
