// What `check --plan` says of a run's time, before and after there was one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "program.h"

namespace mortise::cli {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
namespace fs = std::filesystem;

class PlanProgram : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
  std::string plan(const std::string& more = "") const {
    const Result r = mortise("check " + scene_ + " --plan" + more, kSource, "MORTISE_CACHE=" + folder_ + "/cache");
    EXPECT_EQ(r.code, 0) << r.err;
    return r.out.substr(r.out.find("time  "));
  }
  void run(const std::string& more = "") const {
    const Result r =
        mortise("run " + scene_ + " -q --no-render --overwrite -o " + folder_ + "/run" + more, kSource, "MORTISE_CACHE=" + folder_ + "/cache");
    EXPECT_EQ(r.code, 0) << r.err;
  }
  const std::string folder_ = (fs::temp_directory_path() / ("mortise_plan_cli_" + std::to_string(getpid()))).string();
  const std::string scene_ = "scenes/first/02_block_on_floor.yaml";
};

TEST_F(PlanProgram, TimesComeFromATrialAndThenFromTheRun) {
  const std::string tried = plan();
  EXPECT_THAT(tried, HasSubstr("of CPU time in the steps"));
  EXPECT_THAT(tried, HasSubstr("steps were just tried"));
  EXPECT_TRUE(fs::exists(folder_ + "/cache/speed.json"));
  run();
  EXPECT_THAT(plan(), HasSubstr("this scene took"));
  EXPECT_THAT(plan(" --set time.steps=300"), HasSubstr("for 100 steps"));
  EXPECT_THAT(plan(" --set output.precision=double"), HasSubstr("this scene took"));  // what is written is not what takes long
  EXPECT_THAT(plan(" --set materials.gel.youngs_modulus='60 kPa'"), HasSubstr("the same bodies and effects with other numbers"));
}

// A part of a run says what it is a part of; one that a checkpoint began says nothing.
TEST_F(PlanProgram, PartsOfRunsAreNotTakenForWholeOnes) {
  run(" --frames 2");
  EXPECT_THAT(plan(), HasSubstr("for 10 steps"));
  run(" --set time.steps=100 --frames 2");
  EXPECT_THAT(plan(), Not(HasSubstr("for 100 steps")));
}

}  // namespace
}  // namespace mortise::cli
