// Runs that somebody else drives: live, again from their recording, broken off in every way, taken up again.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "output/field_reader.h"
#include "process.h"

namespace fs = std::filesystem;

namespace mortise::cli {
namespace {

struct Folder {
  std::string path = (fs::temp_directory_path() / ("mortise_bridge_" + std::to_string(getpid()) + "_" + std::to_string(counter++))).string();
  Folder() { fs::create_directories(path); }
  ~Folder() { fs::remove_all(path); }
  std::string operator/(const std::string& name) const { return path + "/" + name; }
  static inline int counter = 0;
};

// A link that a motor turns and that carries another, which is turned exactly.
constexpr const char* kArm = R"(
mortise: 1
name: arm
time: {step: 5 ms, steps: 40, frame_every: 8}
materials: {steel: {density: 1000 kg/m^3}}
bodies:
  upper: {type: stiff, shape: {box: {size: [100 mm, 20 mm, 20 mm], edge_length: 100 mm}}, material: steel, position: [50 mm, 0, 0], rotation: {axis: [1, 0, 0], angle: 30 deg}}
  fore: {type: stiff, shape: {box: {size: [80 mm, 20 mm, 20 mm], edge_length: 80 mm}}, material: steel, position: [140 mm, 0, 0]}
effects:
  inertia: {}
  gravity: {}
  affine_body: {}
  joint:
    - {name: hip, type: revolute, body: upper, at: [0, 0, 0], axis: [0, 1, 0]}
    - {name: elbow, type: revolute, body: fore, to: upper, at: [100 mm, 0, 0], axis: [0, 1, 0], angle_limits: [-1 rad, 1 rad]}
  drive:
    - {joint: hip, mode: pd, kp: 5, kd: 0.05, angle: 0}
    - {joint: elbow, mode: kinematic, angle: 0}
)";

// A policy of the shell, which knows no floating point: it counts.
const std::string kCounts = R"(n=9; read hello; while read state; do n=$((n+1)); echo "{\"targets\":{\"hip\":-0.$n,\"elbow\":0.$n}}"; done)";
const std::string kSame = R"(read hello; while read state; do echo "{\"targets\":{\"hip\":-0.2,\"elbow\":0.3}}"; done)";

class Bridge : public testing::Test {
 protected:
  void SetUp() override { std::ofstream(dir_ / "arm.yaml") << kArm; }
  Result run(const std::string& more) const { return mortise("run arm.yaml --no-render -q " + more, dir_.path); }
  std::string out(const std::string& name) const { return dir_ / name; }
  Folder dir_;
};

std::vector<nlohmann::json> lines_of(const std::string& text) {
  std::vector<nlohmann::json> all;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) all.push_back(nlohmann::json::parse(line));
  return all;
}

}  // namespace

TEST_F(Bridge, ReplayIsTheRunAgainBitForBit) {
  ASSERT_EQ(run("-o live --bridge-every 4 --bridge " + quoted(kCounts)).code, 0);
  const Result again = run("-o again --replay live");
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(unlike(out("again"), out("live")), "");
  EXPECT_EQ(read_text(out("again/bridge.jsonl")), read_text(out("live/bridge.jsonl")));
  EXPECT_EQ(lines_of(read_text(out("live/bridge.jsonl"))).size(), 1u + 10u);
  ASSERT_EQ(run("-o alone").code, 0);
  EXPECT_NE(last_state(out("alone")).at("q"), last_state(out("live")).at("q")) << "it matters what is commanded";
  const output::FieldReader a(out("again/fields.vtkhdf")), b(out("live/fields.vtkhdf"));
  EXPECT_EQ(a.frames(), b.frames());
  // With another scene the commands are repeated, and it is told.
  const Result other = mortise("run arm.yaml --no-render -o other --replay live/bridge.jsonl --set materials.steel.density=900", dir_.path);
  EXPECT_EQ(other.code, 0) << other.err;
  EXPECT_NE(other.err.find("recorded with another scene"), std::string::npos) << other.err;
}

// Through the standard streams: everything that is said, and that it is what the fields say.
TEST_F(Bridge, SaysWhatThereIs) {
  std::string answers;
  for (int i = 0; i < 10; ++i) answers += R"({"targets":{"elbow":)" + std::to_string(0.05 * (i + 1)) + "}}\n";
  std::ofstream(dir_ / "answers") << answers;
  const Result r = run("-o live --bridge-every 4 --bridge - < answers");
  ASSERT_EQ(r.code, 0) << r.err;
  const std::vector<nlohmann::json> said = lines_of(r.out);
  ASSERT_EQ(said.size(), 1u + 10u + 1u + 1u);
  EXPECT_EQ(said[0]["hello"], "mortise");
  EXPECT_EQ(said[0]["drives"]["elbow"], (nlohmann::json{{"mode", "kinematic"}, {"unit", "rad"}, {"limits", {-1.0, 1.0}}}));
  EXPECT_DOUBLE_EQ(said[0]["control_step"], 0.02);
  EXPECT_EQ(said[1]["step"], 0);
  EXPECT_EQ(said[3]["step"], 8);
  EXPECT_DOUBLE_EQ(said[3]["time"], 0.04);
  // What is given exactly is there when it was asked to be.
  for (int i = 1; i <= 10; ++i) EXPECT_NEAR(said[i + 1]["joints"]["elbow"]["angle"], 0.05 * i, 1e-12);
  EXPECT_NEAR(said[5]["joints"]["elbow"]["rate"], 0.05 / 0.02, 1e-9) << "and went there on a straight line";
  EXPECT_TRUE(said[3]["joints"]["hip"].contains("torque") && said[3]["joints"]["hip"]["reaction_force"].size() == 3);
  EXPECT_EQ(said[11]["last"], true);
  EXPECT_EQ(said[12], (nlohmann::json{{"end", "done"}, {"exit_code", 0}}));
  // At the start a pose is what the scene says: 30 degrees about x.
  const nlohmann::json pose = said[1]["poses"]["upper"];
  EXPECT_NEAR(pose["position"][0], 0.05, 1e-12);
  EXPECT_NEAR(pose["quaternion"][0], std::cos(M_PI / 12), 1e-12);
  EXPECT_NEAR(pose["quaternion"][1], std::sin(M_PI / 12), 1e-12);
  // The forearm ends where the two angles put it.
  const nlohmann::json end = said[11];
  const double hip = end["joints"]["hip"]["angle"], both = hip + end["joints"]["elbow"]["angle"].get<double>();
  EXPECT_NEAR(end["poses"]["fore"]["position"][0], 0.1 * std::cos(hip) + 0.04 * std::cos(both), 1e-6) << "bodies strain by a hair";
  EXPECT_NEAR(end["poses"]["fore"]["position"][2], -0.1 * std::sin(hip) - 0.04 * std::sin(both), 1e-6);
}

TEST_F(Bridge, PartnerThatDiesLeavesARunThatGoesOn) {
  const std::string three = R"(read hello; for i in 1 2 3; do read state; echo "{\"targets\":{\"hip\":-0.2,\"elbow\":0.3}}"; done; exit 3)";
  ASSERT_EQ(run("-o whole --bridge-every 4 --bridge " + quoted(kSame)).code, 0);
  const Result r = run("-o live --bridge-every 4 --bridge " + quoted(three));
  EXPECT_EQ(r.code, 8);
  EXPECT_NE(r.err.find("ended with exit code 3 before it answered the state of step 12"), std::string::npos) << r.err;
  EXPECT_EQ(nlohmann::json::parse(read_text(out("live/run.json")))["exit_code"], 8);
  // What was said takes it as far as that again, without a partner or in another folder.
  EXPECT_EQ(run("-o replayed --replay live").code, 8);
  EXPECT_EQ(unlike(out("replayed"), out("live")), "");
  const Result alone = run("-o live --resume");
  EXPECT_EQ(alone.code, 8);
  EXPECT_NE(alone.err.find("ends before the state of step 12; --resume --bridge COMMAND goes on"), std::string::npos) << alone.err;
  EXPECT_EQ(run("-o live --resume --bridge-every 5 --bridge " + quoted(kSame)).code, 2) << "another control step";
  // The next one hears the state at which the first one went, with all that was known of it then.
  const std::string next = R"(read hello; read state; case "$state" in *'"step":12,'*'"reaction_force"'*) ;; *) exit 9;; esac
    echo '{"targets":{"hip":-0.2,"elbow":0.3}}'; while read state; do echo '{"targets":{"hip":-0.2,"elbow":0.3}}'; done)";
  const Result resumed = run("-o live --resume --bridge-every 4 --bridge " + quoted(next));
  ASSERT_EQ(resumed.code, 0) << resumed.err;
  EXPECT_EQ(unlike(out("live"), out("whole")), "");
  EXPECT_EQ(read_text(out("live/bridge.jsonl")), read_text(out("whole/bridge.jsonl")));
}

TEST_F(Bridge, GarbageIsNamedWithItsMessage) {
  const std::tuple<std::string, std::string> cases[] = {
      {"echo I am ready", "message 1 of the bridge's partner, to the state of step 0: is no JSON"},
      {"echo '{}'; echo '{\"targets\":{\"elbwo\":1}}'",
       "message 2 of the bridge's partner, to the state of step 1: targets: no drive of the scene moves a "
       "joint 'elbwo'; did you mean 'elbow'?"},
      {"echo '{\"targets\":{\"elbow\":1.5}}'", "not between the limits"},
      {"echo", "empty line"},
      {"head -c 3000000 /dev/zero | tr '\\0' x", "longer than 1048576 bytes"},
  };
  for (const auto& [say, what] : cases) {
    const Result r = run("-o live --overwrite --bridge " + quoted(say + "; cat >/dev/null"));
    EXPECT_EQ(r.code, 8) << say;
    EXPECT_NE(r.err.find(what), std::string::npos) << r.err;
  }
}

TEST_F(Bridge, SilentAndSlowPartners) {
  const Result silent = run("-o live --bridge-timeout '300 ms' --bridge 'exec sleep 60'");
  EXPECT_EQ(silent.code, 8);
  EXPECT_NE(silent.err.find("did not answer the state of step 0 within 0.3 s"), std::string::npos) << silent.err;
  const std::string slow = R"(sleep 0.5; read hello; while read state; do sleep 0.02; echo "{\"targets\":{\"hip\":-0.2,\"elbow\":0.3}}"; done)";
  ASSERT_EQ(run("-o slow --bridge-timeout '5 s' --bridge-every 4 --bridge " + quoted(slow)).code, 0);
  ASSERT_EQ(run("-o quick --bridge-every 4 --bridge " + quoted(kSame)).code, 0);
  EXPECT_EQ(unlike(out("slow"), out("quick")), "");
}

TEST_F(Bridge, ASignalStopsTheWait) {
  const pid_t pid = start({"run", dir_ / "arm.yaml", "-q", "--no-render", "-o", out("live"), "--bridge-timeout", "0 s", "--bridge", "exec sleep 60"});
  for (int i = 0; i < 600 && !fs::exists(out("live/checkpoint.h5")); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  kill(pid, SIGTERM);
  EXPECT_EQ(wait_for(pid), 75);
  ASSERT_EQ(run("-o live --resume --bridge-every 1 --bridge " + quoted(kSame)).code, 0);
}

// The example policy, which sees and feels, killed with the run at moments of chance: taken up again, the run is what it would have been.
TEST(BridgePolicy, KilledRunsGoOnBitForBit) {
  if (std::system("python3 -c pass >/dev/null 2>&1") != 0) GTEST_SKIP() << "there is no python3";
  const Folder dir;
  const std::string policy = "python3 " + quoted(kSource + "/tools/bridge_policy.py"), scene = kSource + "/scenes/robots/finger.yaml";
  const std::string common =
      "run " + scene +
      " --no-render -q --set time.steps=48 --set time.frame_every=6 --set 'checks=[{quantity: substeps, below: 100}]' --bridge-every 4 --bridge " +
      quoted(policy);
  ASSERT_EQ(mortise(common + " -o " + (dir / "whole")).code, 0);
  std::vector<std::string> args{"run",
                                scene,
                                "--no-render",
                                "-q",
                                "--set",
                                "time.steps=48",
                                "--set",
                                "time.frame_every=6",
                                "--set",
                                "checks=[{quantity: substeps, below: 100}]",
                                "--bridge-every",
                                "4",
                                "--bridge",
                                policy,
                                "-o",
                                dir / "broken",
                                "--resume=auto"};
  int killed = 0;
  for (int i = 0; i < 3; ++i) {
    const pid_t pid = start(args);
    std::this_thread::sleep_for(std::chrono::milliseconds(400 + 300 * i));
    kill(pid, SIGKILL);
    killed += wait_for(pid) != 0;
  }
  EXPECT_GE(killed, 1);
  const Result last = mortise(common + " --resume=auto -o " + (dir / "broken"));
  ASSERT_EQ(last.code, 0) << last.err;
  EXPECT_EQ(unlike(dir / "broken", dir / "whole"), "");
  EXPECT_EQ(read_text(dir / "broken/bridge.jsonl"), read_text(dir / "whole/bridge.jsonl"));
  // And without the policy.
  ASSERT_EQ(
      mortise("run " + scene + " --no-render -q --set time.steps=48 --set time.frame_every=6 --set 'checks=[{quantity: substeps, below: 100}]' -o " +
              (dir / "replayed") + " --replay " + (dir / "broken"))
          .code,
      0);
  EXPECT_EQ(unlike(dir / "replayed", dir / "whole"), "");
}

TEST_F(Bridge, ResetsBeginAgain) {
  // Two resets, the second after the last step; then the third episode is ended.
  const std::string resets =
      R"(n=0; while read line; do case "$line" in
           *'"hello"'*) n=$((n+1));;
           *'"end"'*) exit;;
           *) case "$n:$line" in
                1:*'"step":8,'*) echo '{"reset":true}';;
                2:*'"last":true'*) echo '{"reset":true}';;
                3:*'"step":4,'*) echo '{"end":true}';;
                *) echo '{"targets":{"hip":-0.2}}';;
              esac;;
         esac; done)";
  const Result r = run("-o live --bridge-every 4 --bridge " + quoted(resets));
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_FALSE(fs::exists(out("live/episode_0003")));
  const auto steps = [&](const std::string& folder) { return output::CheckpointReader(out(folder) + "/checkpoint.h5").info().step; };
  EXPECT_EQ(steps("live"), 8);
  EXPECT_EQ(steps("live/episode_0001"), 40);
  EXPECT_EQ(steps("live/episode_0002"), 4);
  for (const char* again : {"-o again --replay live", "-o again --resume"}) ASSERT_EQ(run(again).code, 0) << again;
  for (const char* part : {"", "/episode_0001", "/episode_0002"})
    EXPECT_EQ(unlike(out(std::string("again") + part), out(std::string("live") + part)), "") << part;
  ASSERT_EQ(run("-o live --overwrite --bridge 'read hello; read state; echo \"{\\\"end\\\":true}\"'").code, 0);
  EXPECT_FALSE(fs::exists(out("live/episode_0001"))) << "what was there is gone";
}

// Each environment has a partner of its own, which knows whose it is; the second one's begins it again. Nobody else notices: all have the bits that
// they have alone, and again without partners.
TEST_F(Bridge, EnvironmentsAreResetOneByOne) {
  const std::string resets =
      R"(second=no; n=0; while read line; do case "$line" in
           *'"hello"'*) n=$((n+1)); case "$line" in *'"environment":1'*) second=yes;; esac;;
           *'"end"'*) exit;;
           *) case "$second:$n:$line" in
                yes:1:*'"step":8,'*) echo '{"reset":true}';;
                *) echo '{"targets":{"hip":-0.2}}';;
              esac;;
         esac; done)";
  const std::string varied =
      " --bridge-every 4 --set 'environments={count: 3, seed: 1, vary: [{path: materials.steel.density, scale: {uniform: [0.8, 1.2]}}]}' ";
  const Result r = run("-o live -j 2" + varied + "--bridge " + quoted(resets));
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_FALSE(fs::exists(out("live/env_0000/episode_0001"))) << "only the second is reset";
  EXPECT_FALSE(fs::exists(out("live/env_0002/episode_0001")));
  const std::string parts[] = {"env_0000", "env_0001", "env_0001/episode_0001", "env_0002"};
  const auto steps = [&](const std::string& folder) { return output::CheckpointReader(out(folder) + "/checkpoint.h5").info().step; };
  EXPECT_EQ(steps("live/env_0001"), 8);
  EXPECT_EQ(steps("live/env_0001/episode_0001"), 40);
  EXPECT_NE(last_state(out("live/env_0001/episode_0001")).at("q"), last_state(out("live/env_0000")).at("q")) << "numbers of its own";
  const auto summary = nlohmann::json::parse(read_text(out("live/environments.json")));
  EXPECT_EQ(summary["environments"][1]["steps"], 48);
  EXPECT_EQ(summary["environments"][1]["episodes"], 2);
  for (int e = 0; e < 3; ++e)
    ASSERT_EQ(run(fmt::format("-o alone/env_000{} --environment {}{}--bridge {}", e, e, varied, quoted(resets))).code, 0) << e;
  ASSERT_EQ(run("-o again --replay live" + varied.substr(varied.find(" --set"))).code, 0);
  for (const std::string& part : parts)
    for (const char* other : {"alone/", "again/"}) EXPECT_EQ(unlike(out(other + part), out("live/" + part)), "") << other << part;
}

TEST_F(Bridge, WrongUse) {
  const std::string environments = "'environments={count: 2, seed: 1, vary: [{path: materials.steel.density, scale: {uniform: [0.9, 1.1]}}]}'";
  const std::tuple<std::string, int, std::string> cases[] = {
      {"--bridge ''", 2, "needs a command"},
      {"--bridge-every 4", 2, "--bridge"},
      {"--bridge cat --bridge-every 0", 2, ""},
      {"--bridge cat --replay x", 2, ""},
      {"--bridge - --json", 2, "--json"},
      {"--replay nowhere", 6, "nowhere"},
      {"--replay arm.yaml", 6, "no line of a recording"},
      {"--bridge - --set " + environments, 2, "--environment"},
      {"--bridge cat --together --set " + environments, 2, "leave --together out"},
      {"--replay arm.yaml --set " + environments, 2, "the output folder of a run"},
      {"--bridge cat --set " + environments, 8, "all 2 environments failed"},
      {"--bridge cat", 8, "unknown key"},
  };
  int number = 0;
  for (const auto& [more, code, what] : cases) {
    const Result r = run("-o out_" + std::to_string(number++) + " " + more);
    EXPECT_EQ(r.code, code) << more << "\n" << r.err;
    EXPECT_NE(r.err.find(what), std::string::npos) << r.err;
  }
  ASSERT_EQ(run("-o alone").code, 0);
  const Result r = run("-o alone --set time.steps=50 --resume --bridge cat");
  EXPECT_NE(r.code, 0);
  ASSERT_EQ(run("-o half --frames 2").code, 0);
  const Result half = run("-o half --resume --bridge cat");
  EXPECT_EQ(half.code, 2);
  EXPECT_NE(half.err.find("was made without a bridge"), std::string::npos) << half.err;
}

TEST_F(Bridge, DamagedRecordings) {
  ASSERT_EQ(run("-o live --bridge-every 4 --bridge " + quoted(kSame)).code, 0);
  const std::string whole = read_text(out("live/bridge.jsonl"));
  // A last line that was cut short counts as not there.
  std::ofstream(dir_ / "cut") << whole.substr(0, whole.size() - 5);
  const Result cut = run("-o cut_out --replay cut");
  EXPECT_EQ(cut.code, 8);
  EXPECT_NE(cut.err.find("ends before the state of step 36"), std::string::npos) << cut.err;
  std::ofstream(dir_ / "bad") << whole.substr(0, whole.find("\"said\"")) << "\n" << whole;
  const Result bad = run("-o bad_out --replay bad");
  EXPECT_EQ(bad.code, 6);
  EXPECT_NE(bad.err.find("bad:2"), std::string::npos) << bad.err;
  std::ofstream(dir_ / "empty") << "";
  EXPECT_EQ(run("-o empty_out --replay empty").code, 6);
}

}  // namespace mortise::cli
