// `mortise run` from outside: output folder, frames, restart after being stopped or killed, other devices.
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "output/field_reader.h"
#include "process.h"

namespace fs = std::filesystem;

namespace mortise::cli {
namespace {

const std::string kScene = kSource + "/scenes/first/02_block_on_floor.yaml";

// A folder that is removed at the end.
struct Folder {
  std::string path = (fs::temp_directory_path() / ("mortise_run_" + std::to_string(getpid()) + "_" + std::to_string(counter++))).string();
  ~Folder() { fs::remove_all(path); }
  static inline int counter = 0;
};

nlohmann::json run_json(const std::string& dir) { return nlohmann::json::parse(read_text(dir + "/run.json")); }

bool appears(const std::string& path) {
  for (int i = 0; i < 600; ++i) {
    if (fs::exists(path)) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return false;
}

}  // namespace

TEST(Run, LeavesFieldsCheckpointAndRunJson) {
  const Folder out;
  const Result r = mortise("run " + kScene + " --no-render --frames 3 -o " + out.path);
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(r.out, "");
  const output::FieldReader fields(out.path + "/fields.vtkhdf");
  EXPECT_EQ(fields.frames(), 4);
  const auto json = run_json(out.path);
  EXPECT_EQ(json.at("status"), "done");
  EXPECT_EQ(json.at("exit_code"), 0);
  bool elasticity = false;
  for (const auto& phase : json.at("phases")) elasticity |= phase.at("effect") == "elasticity" && phase.at("seconds").get<double>() > 0;
  EXPECT_TRUE(elasticity);
  EXPECT_TRUE(fs::exists(out.path + "/checkpoint.h5"));
  EXPECT_FALSE(fs::exists(out.path + "/frames"));
}

TEST(Run, RunJsonTellsTheCommandAndTheLibrariesThatInfoLists) {
  const Folder out;
  ASSERT_EQ(mortise("run " + kScene + " --no-render --frames 0 --set 'description=it is mine' -o " + out.path).code, 0);
  const auto json = run_json(out.path), info = nlohmann::json::parse(mortise("info --json").out);
  EXPECT_EQ(json.at("command_line"), kProgram + " run " + kScene + " --no-render --frames 0 --set 'description=it is mine' -o " + out.path);
  EXPECT_EQ(json.at("libraries"), info.at("libraries"));
  EXPECT_GE(json.at("libraries").size(), 9u);
  for (const auto& [name, version] : json.at("libraries").items()) EXPECT_NE(version, "") << name;
}

// The same names and values as in the field file.
TEST(Run, EventsOfStepsAreRowsOfTheStepTable) {
  const Folder out;
  const Result r = mortise("run " + kScene + " --json --no-render --frames 2 -o " + out.path);
  ASSERT_EQ(r.code, 0) << r.err;
  const std::vector<output::StepRow> rows = output::FieldReader(out.path + "/fields.vtkhdf").steps();
  std::istringstream lines(r.out);
  std::size_t n = 0;
  for (std::string line; std::getline(lines, line);) {
    const auto event = nlohmann::json::parse(line);
    if (event.at("event") != "step") continue;
    std::size_t known = 0;
    for (const output::StepColumn& column : output::step_columns) {
      const double value = rows.at(n).*column.value;
      EXPECT_EQ(event.contains(column.name), std::isfinite(value)) << column.name;
      if (!std::isfinite(value)) continue;
      EXPECT_EQ(event.at(column.name).get<double>(), value) << column.name;
      ++known;
    }
    EXPECT_EQ(event.size(), known + 1) << line;
    ++n;
  }
  EXPECT_EQ(n, rows.size());
}

TEST(Run, JsonEventsAreOneObjectPerLine) {
  const Folder out;
  const Result r = mortise("run " + kScene + " --json --no-render --frames 2 -o " + out.path);
  ASSERT_EQ(r.code, 0) << r.err;
  std::istringstream lines(r.out);
  std::string line, events;
  while (std::getline(lines, line)) events += nlohmann::json::parse(line).at("event").get<std::string>() + " ";
  EXPECT_EQ(events.substr(0, 12), "start frame ");
  EXPECT_NE(events.find("step step frame end "), std::string::npos) << events;
}

TEST(Run, RefusesToMixResults) {
  const Folder out;
  ASSERT_EQ(mortise("run " + kScene + " --no-render --frames 1 -o " + out.path).code, 0);
  const Result again = mortise("run " + kScene + " --no-render --frames 1 -o " + out.path);
  EXPECT_EQ(again.code, 2);
  EXPECT_NE(again.err.find("--overwrite"), std::string::npos) << again.err;
  EXPECT_EQ(mortise("run " + kScene + " --no-render --frames 1 --overwrite -o " + out.path).code, 0);
  const Result other = mortise("run " + kScene + " --no-render --resume --set effects.gravity.acceleration.2=-5 -o " + out.path);
  EXPECT_EQ(other.code, 6);
  EXPECT_NE(other.err.find("another scene"), std::string::npos) << other.err;
}

TEST(Run, ResumeNeedsACheckpointUnlessAuto) {
  const Folder out;
  EXPECT_EQ(mortise("run " + kScene + " --no-render --resume --frames 1 -o " + out.path).code, 6);
  EXPECT_EQ(mortise("run " + kScene + " --no-render --resume=auto --frames 1 -o " + out.path).code, 0);
}

TEST(Run, CudaWithoutAGpuIsAnErrorNotASilentCpuRun) {
  const Folder out;
  if (mortise("info --json").out.find("\"cuda\"") != std::string::npos) GTEST_SKIP() << "there is a GPU";
  const Result r = mortise("run " + kScene + " --no-render --device cuda -o " + out.path);
  EXPECT_EQ(r.code, 4);
  EXPECT_NE(r.err.find("--device cuda"), std::string::npos) << r.err;
}

// The unbroken run, a run in two parts, and a run killed without warning end in the same bits.
TEST(Run, RestartEqualsTheUnbrokenRunBitForBit) {
  const std::string scene = kSource + "/scenes/first/03_incline_friction.yaml";
  const Folder whole, parts, killed;
  const std::string common = "run " + scene + " --no-render --frames 20 ";
  ASSERT_EQ(mortise(common + "-j 1 -o " + whole.path).code, 0);
  ASSERT_EQ(mortise("run " + scene + " --no-render --frames 7 -o " + parts.path).code, 0);
  ASSERT_EQ(mortise(common + "-j 2 --resume -o " + parts.path).code, 0);
  EXPECT_EQ(last_state(whole.path), last_state(parts.path));
  EXPECT_EQ(output::FieldReader(parts.path + "/fields.vtkhdf").frames(), 21);

  const pid_t pid = start({"run", scene, "--no-render", "--quiet", "-o", killed.path});
  ASSERT_TRUE(appears(killed.path + "/checkpoint.h5"));
  kill(pid, SIGKILL);
  EXPECT_EQ(wait_for(pid), 128 + SIGKILL);
  EXPECT_FALSE(fs::exists(killed.path + "/run.json"));
  // It may have come further than 20 frames: compare with an unbroken run to the very end.
  ASSERT_EQ(mortise("run " + scene + " --no-render --resume -o " + killed.path).code, 0);
  ASSERT_EQ(mortise("run " + scene + " --no-render --resume -o " + whole.path).code, 0);
  EXPECT_EQ(last_state(whole.path), last_state(killed.path));
}

TEST(Run, SigtermStopsWithACheckpointAndExit75) {
  const std::string scene = kSource + "/scenes/first/03_incline_friction.yaml";
  const Folder out, whole;
  const pid_t pid = start({"run", scene, "--no-render", "--quiet", "-o", out.path, "--set", "time.steps=100000"});
  ASSERT_TRUE(appears(out.path + "/checkpoint.h5"));
  kill(pid, SIGTERM);
  EXPECT_EQ(wait_for(pid), 75);
  EXPECT_EQ(run_json(out.path).at("exit_code"), 75);
  const auto steps = output::CheckpointReader(out.path + "/checkpoint.h5").info().step;
  ASSERT_GT(steps, 0);
  const std::string more = std::to_string(steps / 5 + 3);  // the scene writes a frame every five steps
  ASSERT_EQ(mortise("run " + scene + " --no-render --resume --frames " + more + " --set time.steps=100000 -o " + out.path).code, 0);
  ASSERT_EQ(mortise("run " + scene + " --no-render --frames " + more + " --set time.steps=100000 -o " + whole.path).code, 0);
  EXPECT_EQ(last_state(whole.path), last_state(out.path));
}

// Pictures of a run, then the same again from its fields.
TEST(Run, PicturesCanBeDrawnAgainFromTheFields) {
  const Folder out;
  const std::string camera = " --set 'render={width: 64, height: 48, cameras: {side: {position: [0.5, -0.5, 0.3], look_at: [0, 0, 0.05]}}}'";
  const Result r = mortise("run " + kScene + " --frames 1 -o " + out.path + camera);
  ASSERT_EQ(r.code, 0) << r.err;
  const std::string first = read_text(out.path + "/frames/side_0001.png");
  ASSERT_GT(first.size(), 100u);
  const Result again = mortise("render " + kScene + " " + out.path + "/fields.vtkhdf --frames 1 -o " + out.path + "/again" + camera);
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_TRUE(fs::exists(out.path + "/again/side_0001.png"));
  EXPECT_FALSE(fs::exists(out.path + "/again/side_0000.png"));
}

}  // namespace mortise::cli
