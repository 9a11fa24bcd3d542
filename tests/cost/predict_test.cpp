// What is foretold of a run's time, from made-up pasts, trials and sizes.
#include "cost/predict.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "base/version.h"
#include "cost/tuning.h"
#include "output/hardware.h"

namespace mortise::cost {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

Work work(long steps) {
  Work w;
  w.blocks = 500, w.tets = 2000, w.triangles = 800, w.factor = 250000, w.contact = true, w.steps = steps;
  return w;
}

Past past(const std::string& physics, const std::string& kind, long steps, double seconds) {
  return {physics, kind, version(), output::hardware().cpu, "2026-01-01", 1, steps, 4 * steps, seconds, iteration_seconds(work(1))};
}

TEST(Cost, TheSameSceneTakesPerStepWhatItTook) {
  const auto p = from_past(work(200), "a", "k", {past("a", "k", 100, 3), past("b", "k", 100, 30)});
  ASSERT_TRUE(p);
  EXPECT_NEAR(p->seconds, 6, 1e-12);
  EXPECT_GT(p->factor, tuning::kAgain);  // the second half is not known
  EXPECT_NEAR(from_past(work(100), "a", "k", {past("a", "k", 100, 3)})->factor, tuning::kAgain, 1e-12);
  EXPECT_THAT(text(*p), HasSubstr("this scene took 3 s for 100 steps"));
  // The last that went as far counts, not a short one after it.
  EXPECT_NEAR(from_past(work(100), "a", "k", {past("a", "k", 100, 3), past("a", "k", 5, 5)})->seconds, 3, 1e-12);
  EXPECT_NEAR(from_past(work(100), "a", "k", {past("a", "k", 100, 3), past("a", "k", 100, 4)})->seconds, 4, 1e-12);
}

TEST(Cost, OneOfTheSameKindIsScaledBySizes) {
  Work finer = work(100);
  finer.blocks *= 2, finer.tets *= 2, finer.triangles *= 2, finer.factor *= 4;
  const auto p = from_past(finer, "b", "k", {past("a", "k", 50, 3)});
  ASSERT_TRUE(p);
  EXPECT_NEAR(p->seconds, 2 * 3 * iteration_seconds(finer) / iteration_seconds(work(1)), 1e-9);
  EXPECT_EQ(p->factor, tuning::kSameKind);
  EXPECT_FALSE(from_past(finer, "b", "other", {past("a", "k", 50, 3)}));
}

TEST(Cost, ATrialCountsAsFarAsItWent) {
  EXPECT_FALSE(from_trial(work(100), {}));
  const auto all = from_trial(work(10), {10, 40, 0.5, 4});
  EXPECT_NEAR(all->seconds, 0.5, 1e-12);
  EXPECT_NEAR(all->factor, tuning::kAgain, 1e-12);
  // Iterations of what comes lie between those that were seen and those of scenes in general, nearer to what was seen the farther the trial went.
  double before = INFINITY;
  for (long taken : {1, 10, 50, 90}) {
    const auto p = from_trial(work(100), {taken, 20 * taken, 0.02 * static_cast<double>(taken), 20});
    const double later = (p->seconds - 0.02 * static_cast<double>(taken)) / static_cast<double>(100 - taken) / 0.001;
    EXPECT_GT(later, tuning::kIterations);
    EXPECT_LT(later, 19);
    EXPECT_LT(p->factor, before);
    before = p->factor;
  }
}

TEST(Cost, SizesSayThatTheyAreUnsure) {
  const Prediction p = from_sizes(work(10), {2, 0, "2026-01-01", false});
  EXPECT_NEAR(p.seconds, 10 * tuning::kIterations * 2 * iteration_seconds(work(1)), 1e-12);
  EXPECT_EQ(p.factor, tuning::kSpread);
  EXPECT_THAT(p.from, HasSubstr("measured on 2026-01-01"));
}

class Kept : public ::testing::Test {
 protected:
  void SetUp() override {
    if (const char* old = std::getenv("MORTISE_CACHE")) before_ = old;
    setenv("MORTISE_CACHE", folder_.c_str(), 1);
  }
  void TearDown() override {
    before_.empty() ? unsetenv("MORTISE_CACHE") : setenv("MORTISE_CACHE", before_.c_str(), 1);
    fs::remove_all(folder_);
  }
  std::string before_;
  const fs::path folder_ = fs::temp_directory_path() / ("mortise_cost_" + std::to_string(getpid()));
};

TEST_F(Kept, RunsAreReadBackAndDamageIsPassedOver) {
  EXPECT_TRUE(kept_runs().empty());
  keep(past("a", "k", 100, 3));
  std::ofstream(folder_ / "times.jsonl", std::ios::app) << "{\"physics\": \"torn\n[1]\n\n{\"physics\": 3}\n\xff\xfe\n";
  Past elsewhere = past("b", "k", 10, 1);
  elsewhere.cpu = "another processor";
  keep(elsewhere);
  keep(past("c", "k", 20, 2));
  const std::vector<Past> runs = kept_runs();
  ASSERT_EQ(runs.size(), 2U);
  EXPECT_EQ(runs[0].physics, "a");
  EXPECT_EQ(runs[0].iterations, 400);
  EXPECT_EQ(runs[1].physics, "c");
  EXPECT_DOUBLE_EQ(runs[1].seconds, 2);
}

TEST_F(Kept, AFileThatGrewLongLosesItsOlderHalf) {
  long n = 0;
  for (; n < 10 || fs::file_size(folder_ / "times.jsonl") > 1000; ++n) {  // until it was cut
    keep(past("run " + std::to_string(n), "k", 1, 1));
    ASSERT_LT(n, 5000);
    if (n > 10 && fs::file_size(folder_ / "times.jsonl") < tuning::kMostKept / 2 + 1000 && kept_runs().front().physics != "run 0") break;
  }
  const std::vector<Past> runs = kept_runs();
  EXPECT_EQ(runs.back().physics, "run " + std::to_string(n));
  EXPECT_GT(runs.size(), 300U);
}

TEST_F(Kept, WithoutACacheFolderNothingIsKept) {
  setenv("MORTISE_CACHE", "", 1);
  keep(past("a", "k", 100, 3));
  EXPECT_TRUE(kept_runs().empty());
}

}  // namespace
}  // namespace mortise::cost
