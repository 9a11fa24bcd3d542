// `--device`: names, what stands for it, the debug device, and devices whose memory runs out.
#include <gtest/gtest.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "process.h"

namespace fs = std::filesystem;

namespace mortise::cli {
namespace {

const std::string kScene = kSource + "/scenes/first/02_block_on_floor.yaml";

struct Folder {
  std::string path = (fs::temp_directory_path() / ("mortise_device_" + std::to_string(getpid()) + "_" + std::to_string(counter++))).string();
  ~Folder() { fs::remove_all(path); }
  static inline int counter = 0;
};

nlohmann::json run_json(const std::string& dir) { return nlohmann::json::parse(read_text(dir + "/run.json")); }

}  // namespace

TEST(Device, NamesThatAreNoDeviceAreAUsageError) {
  for (const char* name : {"gpu", "cuda:", "cuda:-1", "cuda:x", "CPU"}) {
    const Result r = mortise("run " + kScene + " --device '" + name + "'");
    EXPECT_EQ(r.code, 2) << name;
    EXPECT_NE(r.err.find("must be auto, cpu, cuda, cuda:N or debug"), std::string::npos) << r.err;
  }
}

TEST(Device, AGpuThatIsNotThereIsExitCode4) {
  const Folder out;
  const Result r = mortise("run " + kScene + " --no-render --device cuda:99 -o " + out.path);
  EXPECT_EQ(r.code, 4);
  EXPECT_NE(r.err.find("--device cuda:99: "), std::string::npos) << r.err;
  EXPECT_FALSE(fs::exists(out.path));
}

TEST(Device, DebugGivesTheBitsOfTheCpu) {
  const std::string common = "run " + kScene + " --no-render --set time.steps=3 ";
  const Folder cpu, debug;
  ASSERT_EQ(mortise(common + "--device cpu -o " + cpu.path).code, 0);
  ASSERT_EQ(mortise(common + "--device debug -o " + debug.path).code, 0);
  EXPECT_EQ(unlike(cpu.path, debug.path), "");
  const nlohmann::json a = run_json(cpu.path), b = run_json(debug.path);
  EXPECT_EQ(a["device"]["kind"], "cpu");
  EXPECT_EQ(b["device"]["kind"], "debug");
  EXPECT_EQ(a["launches"], b["launches"]);
  EXPECT_EQ(a["transfers"], b["transfers"]);
  EXPECT_EQ(a["waits"], b["waits"]);
  long long waits = 0;  // every copy to the host in a step has a name
  for (const auto& [who, n] : a["waits"].items()) waits += n.get<long long>();
  EXPECT_EQ(a["transfers"]["steps"]["to_host"], waits);
  EXPECT_GT(a["waits"]["residual"], 0);
  EXPECT_GT(b["transfers"]["steps"]["to_host"], 0);
  EXPECT_LT(b["transfers"]["steps"]["to_host"], b["transfers"]["all"]["to_host"]);
}

TEST(Device, TheEnvironmentStandsForTheFlag) {
  const Folder out;
  const std::string run = "run " + kScene + " --no-render --set time.steps=1 --overwrite -o " + out.path;
  ASSERT_EQ(mortise(run, kSource, "MORTISE_DEVICE=debug").code, 0);
  EXPECT_EQ(run_json(out.path)["device"]["kind"], "debug");
  ASSERT_EQ(mortise(run + " --device cpu", kSource, "MORTISE_DEVICE=debug").code, 0);
  EXPECT_EQ(run_json(out.path)["device"]["kind"], "cpu");
}

TEST(Device, PlansPredictWhatRunsHold) {
  const std::string press = kSource +
                            "/scenes/tactile/press.yaml --set 'bodies.pad.shape.box.edge_length=1.4 mm' --set time.steps=3 "
                            "--set 'effects.pin.1.motion.time=[0, 0.01, 0.02, 0.03]'",
                    hertz = kSource +
                            "/benchmarks/gpu/hertz.yaml --set 'bodies.block.shape.box.edge_length=2 mm' "
                            "--set 'bodies.ball.shape.sphere.edge_length=2 mm' --set time.steps=1";
  const std::string free = kSource + "/scenes/first/02_block_on_floor.yaml --set 'bodies.block.shape.box.edge_length=2 mm' --set time.steps=25";
  for (const std::string& scene : {press, hertz, free}) {
    const Folder out;
    const std::string common = scene + " --set solver.linear=cg --set solver.preconditioner=mas ";
    ASSERT_EQ(mortise("run " + common + "--no-render --device debug -o " + out.path).code, 0);
    const double held = run_json(out.path)["memory_peak_bytes"]["device"].get<double>() / (1 << 20);
    const std::string plan = mortise("check --plan " + common).out;
    const std::size_t at = plan.find("about ");
    ASSERT_NE(at, std::string::npos);
    const double predicted = std::stod(plan.substr(at + 6));
    EXPECT_GE(predicted, held) << scene;
    EXPECT_LE(predicted, 1.5 * held) << scene;
  }
}

TEST(Device, ASceneThatWillNotFitIsRefusedBeforeItStarts) {
  const Folder out;
  const Result r = mortise("run " + kScene + " --no-render --device debug -o " + out.path, kSource, "MORTISE_DEBUG_MEMORY_MIB=2");
  EXPECT_EQ(r.code, 4);
  EXPECT_NE(r.err.find("the scene needs about 5 MiB of device memory, debug"), std::string::npos) << r.err;
  EXPECT_FALSE(fs::exists(out.path));
  const Result plan = mortise("check --plan " + kScene);
  EXPECT_NE(plan.out.find("about 4.5 MiB on the device in all"), std::string::npos) << plan.out;
}

// The pile falls freely at first; its contacts then need more memory than there is.
TEST(Device, MemoryThatRunsOutKeepsTheCheckpoint) {
  const Folder out;
  const std::string run = "run " + kSource + "/scenes/hard/h34_pile.yaml --no-render --device debug --set time.steps=40 -o " + out.path;
  const Result r = mortise(run, kSource, "MORTISE_DEBUG_MEMORY_MIB=0.75");
  EXPECT_EQ(r.code, 4);
  EXPECT_NE(r.err.find("error: out of device memory: "), std::string::npos) << r.err;
  EXPECT_NE(r.err.find("the last checkpoint in " + out.path + " is good"), std::string::npos) << r.err;
  const nlohmann::json record = run_json(out.path);
  EXPECT_EQ(record["exit_code"], 4);
  EXPECT_GT(record["steps"]["count"], 0);
  EXPECT_EQ(mortise(run + " --resume").code, 0);  // with more memory
  EXPECT_EQ(run_json(out.path)["exit_code"], 0);
}

}  // namespace mortise::cli
