// `mortise bench hard` and `bench fuzz` from outside.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "program.h"

namespace fs = std::filesystem;

namespace mortise::cli {
namespace {

std::vector<nlohmann::json> rows(const Result& r) {
  std::vector<nlohmann::json> out;
  std::istringstream lines(r.out);
  for (std::string line; std::getline(lines, line);) out.push_back(nlohmann::json::parse(line));
  return out;
}

TEST(BenchHard, RowsTellWhatTheRunDid) {
  const std::string dir = (fs::temp_directory_path() / ("mortise_hard_" + std::to_string(getpid()))).string();
  const Result r = mortise("bench hard --only H02,h68 --json --out " + dir + " --result " + dir + ".json");
  const auto all = rows(r);
  ASSERT_EQ(all.size(), 7u) << r.out << r.err;  // two methods each, three variants of H68
  for (const auto& row : all) {
    for (const char* key : {"case", "pass", "reason", "steps", "newton_max", "min_distance", "min_det_f", "energy_gain", "residual", "seconds"})
      EXPECT_TRUE(row.contains(key)) << key;
    EXPECT_TRUE(row["pass"]) << row;
  }
  EXPECT_EQ(all[0]["case"], "h02_face_point");
  EXPECT_EQ(all[0]["steps"], 50);
  EXPECT_TRUE(all[0]["judged"]);
  EXPECT_LT(all[0]["energy_gain"], 1e-6);
  EXPECT_EQ(r.code, 0);
  EXPECT_EQ(mortise("bench hard --only H02 --json --out " + dir + " --expect " + dir + ".json").code, 0);
  // Where two bodies touch is drawn: a vertex's triangles of the one, and the triangle of the other.
  const std::string drawn = read_text(dir + "/h68_initial_touch-barrier/touching.obj");
  EXPECT_NE(drawn.find("o lower\nv "), std::string::npos) << drawn;
  EXPECT_NE(drawn.find("o upper\nv "), std::string::npos) << drawn;
  EXPECT_NE(drawn.find("\nf 1 2 3\n"), std::string::npos) << drawn;
  fs::remove_all(dir);
  fs::remove(dir + ".json");
}

// A criterion that the method does not claim to hold is a figure, not a failure.
TEST(BenchHard, ReportsWhatTheMethodDoesNotClaim) {
  const std::string dir = (fs::temp_directory_path() / ("mortise_hard_reported_" + std::to_string(getpid()))).string();
  const Result r = mortise("bench hard --only h58 --json --out " + dir);
  const auto all = rows(r);
  ASSERT_EQ(all.size(), 2u) << r.out << r.err;
  EXPECT_EQ(all[0]["verdict"], "reported");
  EXPECT_NE(all[0]["reported"].get<std::string>().find("velocity of cube (x), end near 1"), std::string::npos) << all[0];
  EXPECT_EQ(all[1]["verdict"], "pass");
  EXPECT_EQ(r.code, 0);
  fs::remove_all(dir);
}

// A case whose criterion does not hold is a row that says so, and the exit code of the whole.
TEST(BenchHard, FailuresAreShown) {
  const std::string dir = (fs::temp_directory_path() / ("mortise_hard_scenes_" + std::to_string(getpid()))).string();
  fs::create_directories(dir);
  std::string text = read_text(kSource + "/scenes/hard/h02_face_point.yaml");
  text.replace(text.find("min_distance, above: 0 m"), 24, "min_distance, above: 1 m");
  std::size_t at = 0;
  while ((at = text.find("meshes/", at)) != std::string::npos) text.replace(at, 7, kSource + "/scenes/hard/meshes/"), at += kSource.size() + 20;
  std::ofstream(dir + "/h02_face_point.yaml") << text;
  const Result r = mortise("bench hard --data " + dir + " --json --out " + dir + "/out");
  const auto all = rows(r);
  ASSERT_EQ(all.size(), 2u) << r.out << r.err;
  EXPECT_FALSE(all[0]["pass"]);
  EXPECT_NE(all[0]["reason"].get<std::string>().find("min_distance above 1"), std::string::npos) << all[0];
  EXPECT_EQ(r.code, 5);
  // As a list of what is expected, these failures are no regression; that nothing of it was run is one.
  std::ofstream(dir + "/expected.json") << nlohmann::json{{"rows", all}};
  EXPECT_EQ(mortise("bench hard --data " + dir + " --json --out " + dir + "/out --expect " + dir + "/expected.json").code, 0);
  const Result other =
      mortise("bench hard --only H02 --json --out " + dir + "/out --expect " + kSource + "/benchmarks/hard/result.json --data " + dir);
  EXPECT_EQ(other.code, 5);
  EXPECT_NE(other.err.find("worse: h02_face_point barrier: passed before: min_distance above 1"), std::string::npos) << other.err;
  EXPECT_EQ(mortise("bench hard --only nothing").code, 2);
  EXPECT_EQ(mortise("bench hard --only H02 --set edge=8").code, 2);
  fs::remove_all(dir);
}

TEST(BenchBandwidth, TakesTheSizesThatItIsGiven) {
  const Result r = mortise("bench bandwidth --set edge=4 edge=6 --json");
  EXPECT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(std::count(r.out.begin(), r.out.end(), '\n'), 2) << r.out;
  EXPECT_NE(r.out.find("\"rows\":64"), std::string::npos) << r.out;
  for (const char* bad : {"edge=1", "edge=5x", "edge=2000", "size=3"}) {
    const Result refused = mortise(std::string("bench bandwidth --set ") + bad);
    EXPECT_EQ(refused.code, 2) << bad;
    EXPECT_NE(refused.err.find("is not edge=N"), std::string::npos) << refused.err;
  }
}

// A program that was built without the tests has no judge: told before anything runs.
TEST(BenchHard, TellsThatThereIsNoJudgeBeforeAnythingRuns) {
  const std::string dir = (fs::temp_directory_path() / ("mortise_no_judge_" + std::to_string(getpid()))).string();
  fs::create_directories(dir);
  fs::copy_file(kProgram, dir + "/mortise");
  for (const char* name : {"hard --only H02", "fuzz --seeds 1"}) {
    const std::string command =
        "cd " + dir + " && ./mortise bench " + name + " --json --out " + dir + "/out --data " + kSource + "/scenes/hard >out.txt 2>err.txt";
    const int status = std::system(command.c_str());
    EXPECT_EQ(WEXITSTATUS(status), 6) << name;
    EXPECT_EQ(read_text(dir + "/out.txt"), "") << name;
    EXPECT_NE(read_text(dir + "/err.txt").find("tools/test -N"), std::string::npos) << read_text(dir + "/err.txt");
    EXPECT_FALSE(fs::exists(dir + "/out")) << name;
  }
  fs::remove_all(dir);
}

TEST(BenchFuzz, RunsTheSeedsThatAreAskedFor) {
  const std::string dir = (fs::temp_directory_path() / ("mortise_fuzz_" + std::to_string(getpid()))).string();
  const Result r = mortise("bench fuzz --first 7 --seeds 2 --json --out " + dir);
  const auto all = rows(r);
  ASSERT_EQ(all.size(), 2u) << r.out << r.err;
  EXPECT_EQ(all[0]["case"], "seed_7");
  EXPECT_EQ(all[1]["case"], "seed_8");
  fs::remove_all(dir);
}

}  // namespace
}  // namespace mortise::cli
