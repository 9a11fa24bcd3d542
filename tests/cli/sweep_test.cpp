// mortise sweep and mortise merge as a user runs them: killed, stopped, tried again.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <sstream>
#include <thread>

#include "process.h"

namespace mortise::cli {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

class SweepProgram : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_);
    std::ofstream(folder_ + "/s.yaml") << "mortise_sweep: 1\nscene: " << kSource << "/scenes/first/03_incline_friction.yaml\n"
                                       << "set: [time.steps=30]\nquantities: [inertia/kinetic_energy]\nrows:\n  - product: {effects.friction.mu: "
                                          "[0.1, 0.2, 0.3, 0.4], effects.friction.creep_speed: [0.1 mm/s, 1 mm/s]}\n";
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::vector<std::string> sweep(const std::string& out, std::vector<std::string> more = {}) const {
    std::vector<std::string> a{"sweep", folder_ + "/s.yaml", "-o", folder_ + "/" + out, "--no-render", "-j", "2", "--threads", "1"};
    a.insert(a.end(), more.begin(), more.end());
    return a;
  }
  pid_t start(const std::vector<std::string>& arguments) const {
    return cli::start(arguments, [this] {
      for (const auto& [name, fd] : {std::pair{"/out.txt", 1}, {"/err.txt", 2}})
        dup2(open((folder_ + name).c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644), fd);
    });
  }
  int run(const std::vector<std::string>& arguments) const { return wait_for(start(arguments)); }
  std::string said() const { return read_text(folder_ + "/out.txt"); }
  std::string complained() const { return read_text(folder_ + "/err.txt"); }
  // The rows of table.csv without what hangs on the machine.
  std::map<int, std::string> results(const std::string& out) const {
    std::map<int, std::string> rows;
    std::istringstream in(read_text(folder_ + "/" + out + "/table.csv"));
    std::string line;
    std::getline(in, line);
    while (std::getline(in, line)) {
      std::vector<std::string> f;
      std::stringstream s(line);
      for (std::string v; std::getline(s, v, ',');) f.push_back(v);
      rows[std::stoi(f[0])] = f[1] + " " + f[2] + " " + f[3] + " " + f.back();
    }
    return rows;
  }
  const std::string folder_ = (fs::temp_directory_path() / ("mortise_sweep_cli_" + std::to_string(getpid()))).string();
};

TEST_F(SweepProgram, RunsEveryRowOnceAndMerges) {
  ASSERT_EQ(run(sweep("a")), 0) << complained();
  EXPECT_THAT(complained(), HasSubstr("8/8"));
  const auto written = fs::last_write_time(folder_ + "/a/0003/fields.vtkhdf");
  ASSERT_EQ(run(sweep("a")), 0);
  EXPECT_THAT(complained(), HasSubstr("before"));
  EXPECT_EQ(fs::last_write_time(folder_ + "/a/0003/fields.vtkhdf"), written);
  EXPECT_EQ(run({"merge", folder_ + "/a"}), 0);
  EXPECT_THAT(said(), HasSubstr("8 done"));
  EXPECT_EQ(results("a").size(), 8u);
  EXPECT_TRUE(fs::exists(folder_ + "/a/fields.h5"));
}

// Killed at random, sweep and rows alike, it ends with the results of a run that nobody killed, and no row is run twice.
TEST_F(SweepProgram, KilledTenTimesItEndsWithEqualResults) {
  const auto begin = std::chrono::steady_clock::now();
  ASSERT_EQ(run(sweep("whole")), 0) << complained();
  const auto whole = std::chrono::steady_clock::now() - begin;  // on this machine, as busy as it is
  std::mt19937 dice(7);
  int killed = 0;
  for (int i = 0; i < 10; ++i) {
    const pid_t child = start(sweep("killed"));
    std::this_thread::sleep_for(whole * (30 + static_cast<int>(dice() % 100)) / 1000);
    kill(child, i % 3 == 2 ? SIGTERM : SIGKILL);
    const int code = wait_for(child);
    killed += code > 128 || code == 75;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));  // its rows die with it
  }
  EXPECT_GT(killed, 3);
  ASSERT_EQ(run(sweep("killed")), 0) << complained();
  for (const char* out : {"whole", "killed"}) ASSERT_EQ(run({"merge", folder_ + "/" + out}), 0);
  EXPECT_EQ(results("whole"), results("killed"));
}

TEST_F(SweepProgram, RowsThatFailOrAreMissingAreListed) {
  std::ofstream(folder_ + "/s.yaml", std::ios::app) << "  - product: {solver.iterations: [100, 1], solver.halvings: [0]}\n";
  ASSERT_EQ(run(sweep("b", {"--shard", "1/4"})), 5);  // rows 1, 5, 9, 13: one iteration is not enough
  EXPECT_THAT(complained(), HasSubstr("4 of 4 rows failed: 1,5,9,13"));
  EXPECT_EQ(run({"merge", folder_ + "/b"}), 5);
  EXPECT_THAT(said(), HasSubstr("4 failed: --array=1,5,9,13"));
  EXPECT_THAT(said(), HasSubstr("12 missing: --array=0,2-4,6-8,10-12,14,15"));
}

TEST_F(SweepProgram, OneTaskOfAnArray) {
  std::vector<std::string> one{"sweep", folder_ + "/s.yaml", "-o", folder_ + "/c", "--no-render", "--index", "5"};
  EXPECT_EQ(run(one), 0) << complained();
  EXPECT_TRUE(fs::exists(folder_ + "/c/0005/run.json"));
  EXPECT_FALSE(fs::exists(folder_ + "/c/0004"));
  EXPECT_EQ(run(one), 0);
  EXPECT_THAT(complained(), HasSubstr("nothing to do"));
  one.back() = "8";
  EXPECT_EQ(run(one), 2);
  EXPECT_THAT(complained(), HasSubstr("rows 0 to 7"));
}

// A walltime ends a sweep as a signal does: with checkpoints, and the same command goes on. Rows are so long that no machine is through in time.
TEST_F(SweepProgram, StopsBeforeItsWalltime) {
  std::string text = read_text(folder_ + "/s.yaml");
  text.replace(text.find("time.steps=30"), 13, "time.steps=900");  // 0.4 s are no time for eight of them, on any machine
  std::ofstream(folder_ + "/s.yaml") << text;
  const std::vector<std::string> limits{"--walltime", "60.4 s", "--grace", "60 s", "--checkpoint-every", "1 min"};
  ASSERT_EQ(run(sweep("w", limits)), 75) << complained();
  EXPECT_THAT(complained(), HasSubstr("stopped; the same command goes on"));
  EXPECT_FALSE(fs::exists(folder_ + "/w/0007"));
  ASSERT_EQ(run(sweep("w")), 0) << complained();
  EXPECT_EQ(run(sweep("v", {"--walltime", "1 min"})), 2);
  EXPECT_THAT(complained(), HasSubstr("leaves no time to run"));
  EXPECT_EQ(run(sweep("v", {"--walltime=-1 min"})), 2);
  EXPECT_THAT(complained(), HasSubstr("--walltime is '-1 min'; must be more than 0 s"));
  EXPECT_EQ(run(sweep("v", {"--device", "gpu"})), 2);
}

TEST_F(SweepProgram, QuantitiesThatNoRowHasAreNamed) {
  std::string text = read_text(folder_ + "/s.yaml");
  text.replace(text.find("inertia/kinetic_energy"), 22, "inertia/kinetic_enrgy");
  std::ofstream(folder_ + "/s.yaml") << text;
  ASSERT_EQ(run(sweep("q")), 3);
  EXPECT_THAT(complained(),
              HasSubstr("s.yaml:4:13: error: quantities: nothing reports 'inertia/kinetic_enrgy'; did you mean 'inertia/kinetic_energy'"));
  // A task of an array leaves that to `merge`.
  ASSERT_EQ(run({"sweep", folder_ + "/s.yaml", "-o", folder_ + "/q", "--no-render", "--threads", "1", "--index", "0"}), 0) << complained();
  EXPECT_EQ(run({"merge", folder_ + "/q"}), 3);
  EXPECT_THAT(complained(), HasSubstr("did you mean 'inertia/kinetic_energy'"));
  EXPECT_TRUE(fs::exists(folder_ + "/q/table.csv"));
}

TEST_F(SweepProgram, WrongInputIsSaidAtOnce) {
  EXPECT_EQ(run(sweep("d", {"--shard", "4/4"})), 2);
  std::ofstream(folder_ + "/s.yaml", std::ios::app) << "  - product: {effects.frictoin.mu: [1]}\n";
  EXPECT_EQ(run(sweep("d")), 3);
  EXPECT_THAT(complained(), HasSubstr("did you mean 'friction'"));
  EXPECT_FALSE(fs::exists(folder_ + "/d"));
  EXPECT_EQ(run({"merge", folder_}), 6);
}

}  // namespace
}  // namespace mortise::cli
