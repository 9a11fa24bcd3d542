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
#include "cost/coarser.h"
#include "cost/scout.h"
#include "cost/tuning.h"
#include "engine/choose.h"
#include "engine/effect_tables.h"
#include "engine/input.h"
#include "output/hardware.h"
#include "scene/scene.h"

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
  const auto all = from_trial(work(10), {10, 40, 0.5, 4, 0.0125});
  EXPECT_NEAR(all->seconds, 0.5, 1e-12);
  EXPECT_NEAR(all->factor, tuning::kAgain, 1e-12);
  // Iterations of what comes lie between those that were seen and those of scenes in general, nearer to what was seen the farther the trial went.
  double before = INFINITY;
  for (long taken : {1, 10, 50, 90}) {
    const auto p = from_trial(work(100), {taken, 20 * taken, 0.02 * static_cast<double>(taken), 20, 0.001});
    const double later = (p->seconds - 0.02 * static_cast<double>(taken)) / static_cast<double>(100 - taken) / 0.001;
    EXPECT_GT(later, tuning::kIterations);
    EXPECT_LT(later, 19);
    EXPECT_LT(p->factor, before);
    before = p->factor;
  }
}

// What a scout sees of steps of this many iterations, which take a tenth of the scene's time each.
Scouted scouted(const std::vector<double>& iterations) {
  Scouted out{2, {}};
  Passed all;
  for (double n : iterations) {
    all.iterations += n, all.seconds += 0.0001 * n;
    out.steps.push_back(all);
  }
  return out;
}

TEST(Cost, AScoutSeesTheStepsThatATrialDoesNotReach) {
  const Trial trial{10, 10, 0.01, 1, 0.001};
  std::vector<double> course(100, 1.0);
  for (std::size_t i = 50; i < 100; ++i) course[i] = 30;  // contact begins
  const auto p = from_scout(work(100), trial, scouted(course), 7);
  ASSERT_TRUE(p);
  EXPECT_NEAR(p->seconds, 0.01 + (40 + 50 * 30) * 0.001, 1e-9);
  EXPECT_NEAR(p->factor, tuning::kScouted, 1e-12);
  EXPECT_GT(p->seconds, 4 * from_trial(work(100), trial)->seconds);
  // A scout that was stopped foretells the rest by the later half of what it saw, and is less sure.
  course.resize(80);
  const auto part = from_scout(work(100), trial, scouted(course), 7);
  EXPECT_NEAR(part->seconds, 0.01 + (40 + 50 * 30) * 0.001, 0.1);
  EXPECT_GT(part->factor, tuning::kScouted);
  // One that saw no more than the trial, or nothing, says nothing.
  course.resize(10);
  EXPECT_FALSE(from_scout(work(100), trial, scouted(course), 7));
  EXPECT_FALSE(from_scout(work(100), trial, {}, 7));
  // Without a trial an iteration takes what sizes say.
  EXPECT_NEAR(from_scout(work(10), {}, scouted(std::vector<double>(10, 3.0)), 7)->seconds, 30 * 7, 1e-9);
}

TEST(Cost, ATrialSaysHowManyMoreIterationsTheSceneTakesThanItsScout) {
  const std::vector<double> course(100, 2.0);
  // Half of the way it took twice as many; in the logarithm that counts by the root of the half.
  const auto p = from_scout(work(100), {50, 50 * 4, 0.2, 4, 0.001}, scouted(course), 7);
  EXPECT_NEAR(p->seconds - 0.2, 50 * 2 * 0.001 * std::pow(2, std::sqrt(0.5)), 1e-9);
  EXPECT_NEAR(scouted(course).until(6.5).iterations, 13, 1e-12);
  EXPECT_NEAR(scouted(course).until(1000).iterations, 200, 1e-12);
}

// A ball on its way comes to a pad.
constexpr const char* kPressed = R"(
mortise: 1
name: t
time: {step: 2 ms, steps: 21}
materials: {rubber: {youngs_modulus: 1 MPa, poisson_ratio: 0.3, density: 1000}}
bodies:
  pad: {type: soft, shape: {box: {size: [10 mm, 10 mm, 10 mm], edge_length: 2 mm}}, material: rubber}
  ball: {type: stiff, shape: {sphere: {radius: 5 mm, edge_length: 1 mm}}, material: rubber, position: [0, 0, 11 mm]}
effects:
  inertia: {}
  elasticity: {}
  affine_body: {}
  pin: [{body: ball, where: {side: all}, motion: {time: [0, 42 ms], translation: [[0, 0, 0], [0, 0, -2 mm]]}}]
  barrier_contact: {d_hat: 0.1 mm}
)";

TEST(Cost, ACoarserSceneGoesTheSameWay) {
  const Params scene = scene::read_scene_text(kPressed, "t.yaml", {}, engine::effect_tables()).root;
  EXPECT_TRUE(can_be_coarser(scene, "pad"));
  EXPECT_FALSE(can_be_coarser(scene, "ball"));
  const Params other = coarser(scene, 3);
  EXPECT_NEAR(other.at("bodies").at("pad").at("shape").at("box").number("edge_length"), 6e-3, 1e-12);
  EXPECT_NEAR(other.at("bodies").at("ball").at("shape").at("sphere").number("edge_length"), 1e-3, 1e-12);
  const model::ModelInput input = engine::make_input(scene);
  EXPECT_TRUE(work_of(input, "direct").drives);  // a motion that a pin gives
  EXPECT_NEAR(work_of(input, "direct", 2).tets, work_of(input, "direct").tets / 8, 1e-9);
  // As coarse as it must be, and no coarser.
  EXPECT_EQ(coarse_enough(input, "direct", 11, 10), 1.5);
  EXPECT_EQ(coarse_enough(input, "direct", 1000, 10), 4);
  const Scouted seen = scout(scene, 2, 60);
  ASSERT_EQ(seen.steps.size(), 21U);
  EXPECT_GT(seen.steps[20].iterations, 3 * seen.steps[8].iterations) << "the ball comes to the pad in the tenth step";
  EXPECT_TRUE(scout(scene, 2, 0).steps.empty());
}

// What is broken off goes on where it was, and counts with what was before.
TEST(Cost, ATrialGoesOn) {
  const Params scene = scene::read_scene_text(kPressed, "t.yaml", {}, engine::effect_tables()).root;
  const model::ModelInput input = engine::make_input(scene);
  std::unique_ptr<engine::Engine> engine;
  ASSERT_EQ(engine::chosen().api->create(input, engine).code, 0);
  ASSERT_EQ(engine->begin().code, 0);
  // Broken off within its first iteration: it takes at least that long. A layer as thick as its body has iterations of many seconds.
  bool told = false;
  for (int i = 0; i < 20 && !told; ++i) told = try_steps(*engine, 5, 1e-3).each > 0;  // CPU time goes by in ticks
  EXPECT_TRUE(told);
  const Trial first = try_steps(*engine, 5, 60), all = try_steps(*engine, 21, 60, first);
  EXPECT_EQ(first.steps, 5);
  EXPECT_EQ(all.steps, 21);
  EXPECT_EQ(all.taken.size(), 21U);
  EXPECT_GT(all.seconds, first.seconds);
  EXPECT_NEAR(all.each, all.seconds / static_cast<double>(all.iterations), 1e-12);
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
