// Tables of rows: generator, distributions, blocks, what is wrong in a file.
#include "sweep/sweep.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>

#include "base/error.h"
#include "base/philox.h"
#include "base/read_file.h"
#include "place.h"

using namespace mortise;
using namespace mortise::sweep;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

namespace {

class SweepFile : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ + "/" + name) << text;
    return folder_ + "/" + name;
  }
  Sweep read(const std::string& rows) const {
    return read_sweep(write("s.yaml", "mortise_sweep: 1\nscene: " + test_place::kSourceFolder + "/scenes/first/01_free_fall.yaml\nrows:\n" + rows));
  }
  std::string error(const std::string& rows) const {
    try {
      read(rows);
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  }
  std::string folder_ = (fs::temp_directory_path() / ("mortise_sweep_" + std::to_string(getpid()))).string();
};

std::vector<std::string> column(const Sweep& s, const std::string& path) {
  std::vector<std::string> out;
  for (const Row& row : s.rows)
    for (const auto& [p, value] : row.values)
      if (p == path) out.push_back(value);
  return out;
}

}  // namespace

// Known answers of the Random123 library (kat_vectors).
TEST(PhiloxTest, KnownAnswers) {
  EXPECT_EQ(philox({0, 0, 0, 0}, {0, 0}), (Philox{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(philox({0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}, {0xffffffff, 0xffffffff}),
            (Philox{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (Philox{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(PhiloxTest, StreamsAreOfTheirSeedAndName) {
  double mean = 0;
  for (std::uint64_t i = 0; i < 10000; ++i) mean += Stream(1, "a").at(i)[0] / 10000;
  EXPECT_NEAR(mean, 0.5, 0.015);  // five standard deviations
  EXPECT_EQ(Stream(1, "a").at(7), Stream(1, "a").at(7));
  EXPECT_NE(Stream(1, "a").at(7), Stream(1, "b").at(7));
  EXPECT_NE(Stream(1, "a").at(7), Stream(2, "a").at(7));
  EXPECT_NE(Stream(1, "a").at(7), Stream(1, "a").at(8));
}

TEST_F(SweepFile, BlocksMultiplyAndTheLastIsFastest) {
  const Sweep s = read("  - product: {a: [1, 2], b: [x, y, z]}\n  - zip: {c: [0.1, 0.2], d: [[1, 2], {e: \"f\"}]}\n");
  ASSERT_EQ(s.rows.size(), 12u);
  EXPECT_EQ(s.rows[0].overrides({"g=1"}), (std::vector<std::string>{"g=1", "a=1", "b=x", "c=0.1", "d=[1, 2]"}));
  EXPECT_EQ(s.rows[1].overrides({}), (std::vector<std::string>{"a=1", "b=x", "c=0.2", "d={e: \"f\"}"}));
  EXPECT_EQ(s.rows[2].overrides({}), (std::vector<std::string>{"a=1", "b=y", "c=0.1", "d=[1, 2]"}));
  EXPECT_EQ(s.rows[11].overrides({}), (std::vector<std::string>{"a=2", "b=z", "c=0.2", "d={e: \"f\"}"}));
}

// A draw depends on seed, path and row alone: more rows, or another parameter beside it, change none.
TEST_F(SweepFile, DrawsDoNotKnowTheirNeighbours) {
  const auto few = column(read("  - random: {count: 3, seed: 5, vary: {a: {uniform: [1 mm, 3 mm]}}}\n"), "a");
  const auto many = column(read("  - random: {count: 8, seed: 5, vary: {b: {normal: [0, 1]}, a: {uniform: [1 mm, 3 mm]}}}\n"), "a");
  EXPECT_EQ(few, std::vector<std::string>(many.begin(), many.begin() + 3));
  for (const std::string& v : many) EXPECT_TRUE(std::stod(v) > 1e-3 && std::stod(v) < 3e-3) << v;
  EXPECT_NE(few, column(read("  - random: {count: 3, seed: 6, vary: {a: {uniform: [1 mm, 3 mm]}}}\n"), "a"));
}

TEST_F(SweepFile, DistributionsHaveTheirMoments) {
  const Sweep s =
      read("  - latin_hypercube: {count: 1000, seed: 1, vary: {n: {normal: [2, 0.5]}, l: {log_uniform: [1 kPa, 100 kPa]}, c: {choice: [x, y]}}}\n");
  double mean = 0, square = 0, log_mean = 0;
  for (const std::string& v : column(s, "n")) mean += std::stod(v) / 1000, square += std::pow(std::stod(v) - 2, 2) / 1000;
  for (const std::string& v : column(s, "l")) log_mean += std::log10(std::stod(v)) / 1000;
  EXPECT_NEAR(mean, 2, 2e-3);  // strata leave far less than the 0.016 of random draws
  EXPECT_NEAR(std::sqrt(square), 0.5, 5e-3);
  EXPECT_NEAR(log_mean, 4, 2e-3);
  const auto c = column(s, "c");
  EXPECT_EQ(std::count(c.begin(), c.end(), "x"), 500);
}

TEST_F(SweepFile, LatinHypercubesHaveOneRowInEveryStratum) {
  const Sweep s = read("  - latin_hypercube: {count: 16, seed: 3, vary: {a: {uniform: [0, 16]}, b: {uniform: [0, 16]}}}\n");
  for (const char* path : {"a", "b"}) {
    std::set<int> strata;
    for (const std::string& v : column(s, path)) strata.insert(static_cast<int>(std::stod(v)));
    EXPECT_EQ(strata.size(), 16u) << path;
  }
  EXPECT_NE(column(s, "a"), column(s, "b"));
}

TEST_F(SweepFile, FilesOfRows) {
  write("rows.csv", "a.b, c\r\n1,\"[1, 2]\"\r\n\r\n0.5 mm,\"say \"\"x\"\"\"\n");
  const Sweep s = read("  - file: rows.csv\n");
  ASSERT_EQ(s.rows.size(), 2u);
  EXPECT_EQ(s.rows[0].overrides({}), (std::vector<std::string>{"a.b=1", "c=[1, 2]"}));
  EXPECT_EQ(s.rows[1].overrides({}), (std::vector<std::string>{"a.b=0.5 mm", "c=say \"x\""}));
  write("rows.csv",
        "\xEF\xBB\xBF"
        "a.b,c\n1,2\n");
  EXPECT_EQ(read("  - file: rows.csv\n").rows[0].values[0].first, "a.b") << "behind a mark of byte order";
  write("rows.csv", "a;b\n1;2\n");
  EXPECT_THAT(error("  - file: rows.csv\n"), HasSubstr("rows.csv:1 has no comma"));
  write("rows.csv", "a,b\n1\n");
  EXPECT_THAT(error("  - file: rows.csv\n"), HasSubstr("rows.csv:2 has 1 values, the first line has 2 paths"));
  EXPECT_THAT(error("  - file: none.csv\n"), HasSubstr("none.csv"));
}

TEST_F(SweepFile, ErrorsSayWhereAndWhatWasMeant) {
  EXPECT_THAT(error("  - produkt: {a: [1]}\n"), HasSubstr("did you mean 'product'"));
  EXPECT_THAT(error("  - zip: {a: [1, 2], b: [1]}\n"), HasSubstr("zip.b has 1 values, zip.a has 2"));
  EXPECT_THAT(error("  - product: {a: 1}\n"), HasSubstr("must be a list of values"));
  EXPECT_THAT(error("  - product: {a: [1]}\n  - zip: {a: [1]}\n"), HasSubstr("'a' is varied by two blocks"));
  EXPECT_THAT(error("  - random: {count: 2.5, seed: 1, vary: {a: {uniform: [1, 2]}}}\n"), HasSubstr("random.count is '2.5'; must be a whole number"));
  EXPECT_THAT(error("  - random: {count: 2, seed: 1, vary: {a: {uniform: [1 apple, 2]}}}\n"), HasSubstr("random.vary.a.uniform"));
  EXPECT_THAT(error("  - random: {count: 2, seed: 1, vary: {a: {log_uniform: [0, 2]}}}\n"), HasSubstr("both ends must be positive"));
  EXPECT_THAT(error("  - random: {count: 900000, seed: 1, vary: {a: {uniform: [1, 2]}}}\n  - product: {b: [1, 2]}\n"),
              HasSubstr("more than a million rows"));
  EXPECT_THAT(error("  []\n"), HasSubstr("needs 'rows:'"));
}

TEST_F(SweepFile, RowsAreCheckedBeforeAnyRuns) {
  const Sweep s = read("  - product: {time.steps: [1, 2], time.stpe: [1 ms]}\n");
  try {
    check_rows(s);
    ADD_FAILURE() << "no error";
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), HasSubstr("error: row 0: "));
    EXPECT_THAT(e.what(), HasSubstr("did you mean 'step'"));
  }
}

TEST_F(SweepFile, AFolderBelongsToOneSweep) {
  const Sweep one = read("  - product: {time.steps: [1, 2]}\n"), other = read("  - product: {time.steps: [1, 3]}\n");
  const std::string out = folder_ + "/out";
  claim_folder(one, out);
  EXPECT_NO_THROW(claim_folder(one, out));
  EXPECT_THROW(claim_folder(other, out), Error);
  const Sweep back = sweep_in(out);
  EXPECT_EQ(back.scene, one.scene);
  ASSERT_EQ(back.rows.size(), 2u);
  EXPECT_EQ(back.rows[1].values, one.rows[1].values);
  EXPECT_THROW(sweep_in(folder_), Error);
}

TEST_F(SweepFile, AFolderBelongsToWhatItsSceneSays) {
  std::string scene = read_regular_file(test_place::kSourceFolder + "/scenes/first/01_free_fall.yaml", max_bytes::scene);
  write("fall.yaml", scene);
  const Sweep s = read_sweep(write("s.yaml", "mortise_sweep: 1\nscene: fall.yaml\nrows:\n  - product: {time.steps: [1, 2]}\n"));
  claim_folder(s, folder_ + "/out");
  write("fall.yaml", "# a remark changes nothing\n" + scene);
  EXPECT_NO_THROW(claim_folder(s, folder_ + "/out"));
  const std::size_t density = scene.find("density: ");
  ASSERT_NE(density, std::string::npos);
  write("fall.yaml", scene.insert(density + 9, "1"));
  EXPECT_THROW(claim_folder(s, folder_ + "/out"), Error);
}

TEST(SweepRanges, AreThoseOfAnArray) {
  EXPECT_EQ(ranges({}), "");
  EXPECT_EQ(ranges({3}), "3");
  EXPECT_EQ(ranges({0, 1, 3, 5, 6, 7, 9}), "0,1,3,5-7,9");
}
