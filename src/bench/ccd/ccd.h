#pragma once
// Continuous collision detection against queries with known answers, in the format of Wang et al. 2021 ("A large-scale benchmark
// and an inclusion-based algorithm for CCD"): CSV files of 8 rows per query (four vertices at t = 0, then at t = 1), each row
// three fractions "numerator,denominator" and the truth, 0 or 1. File names contain "edge-edge" or "vertex-face"; the first
// vertex of the latter is the point.
#include <filesystem>
#include <string>
#include <vector>

#include "base/types.h"

namespace mortise::bench {

struct CcdQuery {
  Vec3 x0[4], x1[4];  // vertices at t = 0 and 1
  bool impact = false;
};

// Throws Error(Exit::file) with the line of what cannot be read.
std::vector<CcdQuery> read_ccd_queries(const std::filesystem::path& file);

struct CcdScore {
  long long queries = 0;
  long long impacts = 0;          // by the truth
  long long false_negatives = 0;  // missed impacts
  long long false_positives = 0;
  double seconds = 0;  // on one thread, reading not counted
  double microseconds_per_query() const { return queries ? seconds * 1e6 / static_cast<double>(queries) : 0; }
};
struct CcdBench {
  CcdScore point_triangle, edge_edge;
  std::string text() const;  // a table of both for people
};

// Runs all query files of a folder with minimum separation 0. Throws Error(Exit::file) if there are none.
CcdBench ccd_bench(const std::filesystem::path& folder);

}  // namespace mortise::bench
