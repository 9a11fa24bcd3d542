#include "output/run_json.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "helpers.h"
#include "output/atomic_file.h"

namespace mortise::output {
namespace {

using testing::HasSubstr;

RunRecord record() {
  RunRecord r;
  r.exit_code = Exit::stopped;
  r.message = "stopped \"by\" signal";
  r.hardware = hardware();
  r.device = {"cpu", "Some CPU", 2, 1024, ""};
  r.scene_path = "scenes/\xff.yaml";  // not UTF-8
  r.wall_seconds = 1.5;
  r.seconds["output"] = 0.25, r.cpu_seconds["output"] = 0.125;
  r.phases = {{"elasticity", "assemble", 0.5, 12}};
  r.launches = {{"elasticity.gradient", 12}, {"solver.step", 3}};
  r.waits = {{"residual", 7}};
  r.frames = 4;
  for (int i = 1; i <= 4; ++i) {
    StepRow row;
    row.step = i, row.newton_iterations = i, row.residual = i == 2 ? StepRow::unknown : 1e-6 * i;
    r.steps.push_back(row);
  }
  return r;
}

TEST(RunJson, SaysWhatTheRecordHolds) {
  const auto j = nlohmann::json::parse(run_json(record()));
  EXPECT_EQ(j["filetype"], "mortise run");
  EXPECT_EQ(j["status"], "stopped");
  EXPECT_EQ(j["exit_code"], 75);
  EXPECT_EQ(j["message"], "stopped \"by\" signal");
  EXPECT_EQ(j["seconds"]["output"], 0.25);
  EXPECT_EQ(j["cpu_seconds"]["output"], 0.125);
  EXPECT_EQ(j["phases"][0]["calls"], 12);
  EXPECT_EQ(j["launches"]["solver.step"], 3);
  EXPECT_EQ(j["waits"]["residual"], 7);
  EXPECT_EQ(j["steps"]["count"], 4);
  EXPECT_EQ(j["steps"]["newton_iterations"]["total"], 10);
  EXPECT_EQ(j["steps"]["newton_iterations"]["mean"], 2.5);
  EXPECT_EQ(j["steps"]["newton_iterations"]["max"], 4);
  EXPECT_DOUBLE_EQ(j["steps"]["residual"]["mean"], 8e-6 / 3);  // over the three steps that know it
  EXPECT_TRUE(j["steps"]["min_gap"].is_null());
  EXPECT_GE(j["hardware"]["cores"], 1);
  EXPECT_GT(j["hardware"]["memory_bytes"], 1'000'000);
}

TEST(RunJson, StatusFollowsTheExitCode) {
  RunRecord r = record();
  for (const auto& [code, status] :
       {std::pair{Exit::done, "done"}, {Exit::solve, "failed"}, {Exit::internal, "failed"}, {Exit::stopped, "stopped"}}) {
    r.exit_code = code;
    EXPECT_EQ(nlohmann::json::parse(run_json(r))["status"], status);
  }
}

TEST(RunJson, ReplacesTheFileAsAWhole) {
  Folder dir;
  write_file(dir / "run.json", "old", false);
  write_run_json(dir / "run.json", record());
  EXPECT_EQ(nlohmann::json::parse(read_file(dir / "run.json"))["frames"], 4);
  EXPECT_FALSE(std::filesystem::exists(dir / "run.json.tmp"));
  EXPECT_THAT(file_error([&] { write_run_json(dir / "none/run.json", record()); }), HasSubstr("cannot create: No such file"));
}

TEST(AtomicFile, FailureKeepsTheOldFile) {
  Folder dir;
  std::filesystem::create_directories(dir / "taken");
  write_file(dir / "taken/inside", "x", false);
  EXPECT_THAT(file_error([&] { write_file_atomically(dir / "taken", "new", false); }), HasSubstr("taken: cannot replace"));
  EXPECT_EQ(read_file(dir / "taken/inside"), "x");
  EXPECT_FALSE(std::filesystem::exists(dir / "taken.tmp"));
  EXPECT_THAT(file_error([&] { write_file("/dev/full", "x", false); }), HasSubstr("/dev/full: cannot write: No space left on device"));
}

TEST(Hardware, PeakMemoryGrowsWithUse) {
  const std::int64_t before = peak_memory_bytes();
  EXPECT_GT(before, 1'000'000);
  const std::vector<char> block(static_cast<std::size_t>(before) + 50'000'000, 1);
  EXPECT_GT(peak_memory_bytes(), before + 20'000'000 * (block.back() == 1));
}

}  // namespace
}  // namespace mortise::output
