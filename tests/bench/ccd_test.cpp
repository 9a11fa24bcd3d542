#include "bench/ccd/ccd.h"

#include <gtest/gtest.h>

#include <fstream>

#include "base/error.h"

namespace mortise::bench {
namespace {

namespace fs = std::filesystem;

fs::path scratch(const std::string& name) {
  const fs::path folder = fs::path(testing::TempDir()) / ("mortise_ccd_bench_" + name);
  fs::remove_all(folder);
  fs::create_directories(folder);
  return folder;
}

TEST(CcdBench, NeverMissesAnImpactOfTheDataset) {
  const fs::path folder = fs::path(MORTISE_SHARED_DATA) / "ccd";
  if (!fs::exists(folder)) GTEST_SKIP() << "no data in " << folder;
  const CcdBench bench = ccd_bench(folder);
  for (const CcdScore* s : {&bench.point_triangle, &bench.edge_edge}) {
    EXPECT_GT(s->queries, 1000);
    EXPECT_GT(s->impacts, 50);
    EXPECT_EQ(s->false_negatives, 0);
    // What is left are contacts that miss each other by less than the rounding of doubles.
    EXPECT_LT(s->false_positives, s->queries / 20);
  }
  EXPECT_NE(bench.text().find("point-triangle"), std::string::npos);
}

// Fractions of any size: 1/3, a ratio of 40-digit numbers (= 0.25), and numbers with leading zeros.
TEST(CcdBench, ReadsFractionsOfAnySize) {
  const fs::path file = scratch("fractions") / "a-vertex-face-data.csv";
  std::ofstream out(file);
  out << "1,3,-1000000000000000000000000000000000000000,4000000000000000000000000000000000000000,0010,2,1\n";
  for (int i = 1; i < 8; ++i) out << "-0,1," << i << ",1,-6004799503761141,18014398509481984,1\n";
  out.close();
  const auto queries = read_ccd_queries(file);
  ASSERT_EQ(queries.size(), 1u);
  EXPECT_EQ(queries[0].x0[0], Vec3(1.0 / 3, -0.25, 5));
  EXPECT_EQ(queries[0].x1[2], Vec3(0, 6, -6004799503761141.0 / 18014398509481984.0));
  EXPECT_TRUE(queries[0].impact);
}

TEST(CcdBench, SaysWhatIsWrongWithAFile) {
  const fs::path folder = scratch("broken");
  EXPECT_THROW(ccd_bench(folder), Error);
  EXPECT_THROW(ccd_bench(folder / "absent"), Error);
  for (const char* bad : {"1,1,1,1,1,1\n", "1,1,1,1,1,1,2\n", "1,0,1,1,1,1,0\n", "1,x,1,1,1,1,0\n", "1,1,1,1,1,1,0\n"}) {
    const fs::path file = folder / "a-edge-edge.csv";
    std::ofstream(file) << bad;
    EXPECT_THROW(read_ccd_queries(file), Error) << bad;
  }
}

}  // namespace
}  // namespace mortise::bench
