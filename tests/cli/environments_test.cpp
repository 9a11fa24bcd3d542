// Many environments as a user runs them: each has the bits that it has alone, whatever becomes of the others.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <thread>

#include "output/field_reader.h"
#include "process.h"

namespace mortise::cli {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

const std::string kJudge = test_place::kBuildFolder + "/bin/mortise_judge";

// A ball is pressed into a pad and dragged over it.
std::string press(const std::string& contact, const std::string& solver, const std::string& environments) {
  return "mortise: 1\nname: press\ntime: {step: 5 ms, steps: 8, frame_every: 2}\nsolver: " + solver + "\n" + environments +
         "materials: {gel: {youngs_modulus: 0.2 MPa, poisson_ratio: 0.45, density: 1050}, steel: {density: 7850}}\n"
         "bodies:\n"
         "  pad: {type: soft, shape: {box: {size: [12 mm, 9 mm, 4 mm], edge_length: 2 mm}}, material: gel, position: [0, 0, -2 mm]}\n"
         "  ball: {type: stiff, shape: {sphere: {radius: 4 mm, edge_length: 2 mm}}, material: steel, position: [-1 mm, 0, 4.05 mm]}\n"
         "effects:\n  inertia: {}\n  elasticity: {}\n"
         "  pin: [{body: pad, where: {side: z_min}}, {body: ball, where: {side: all}, motion: {time: [0, 20 ms, 40 ms], translation: [[0, 0, 0], [0, "
         "0, -0.4 mm], [0.4 mm, 0, -0.4 mm]]}}]\n" +
         contact + "output: {precision: double}\n";
}
const std::string kMortar = "  mortar_contact: {pairs: [{slave: pad, master: ball}]}\n  friction: {follows: mortar_contact, mu: 0.5}\n",
                  kBarrier = "  barrier_contact: {}\n  friction: {follows: barrier_contact, mu: 0.5}\n";
std::string varied(int count) {
  return "environments:\n  count: " + std::to_string(count) +
         "\n  seed: 7\n  vary:\n    - {path: materials.gel.youngs_modulus, scale: {log_uniform: [0.5, 2]}}\n    - {path: effects.friction.mu, abs: "
         "{uniform: [0.2, 0.8]}}\n"
         "    - {path: bodies.ball.position.0, add: {normal: [0, 0.5 mm]}}\n";
}

class EnvironmentsProgram : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
  std::string at(const std::string& name) const { return folder_ + "/" + name; }
  void write(const std::string& name, const std::string& text) const { std::ofstream(at(name)) << text; }
  Result run(const std::string& arguments) const { return mortise("run " + arguments + " --no-render", folder_); }
  nlohmann::json summary(const std::string& out) const { return nlohmann::json::parse(read_text(at(out) + "/environments.json")); }
  static std::string env(int k) { return "/env_000" + std::to_string(k); }
  // State and fields, bit for bit; seconds apart.
  void expect_equal(const std::string& a, const std::string& b) const {
    EXPECT_EQ(unlike(at(a), at(b)), "") << a << " and " << b;
    const std::string said = at("judge.txt");
    EXPECT_EQ(std::system(
                  (quoted(kJudge) + " " + quoted(at(a) + "/fields.vtkhdf") + " " + quoted(at(b) + "/fields.vtkhdf") + " > " + quoted(said)).c_str()),
              0)
        << a << " and " << b << ": " << read_text(said);
  }
  // Environment k of many, of few, alone, with more threads, and as a scene of its own.
  void expect_invariant(const std::string& scene_of_six, const std::string& scene_of_three, int k) const {
    write("six.yaml", scene_of_six), write("three.yaml", scene_of_three);
    const Result six = run("six.yaml -o six -j 2");
    ASSERT_EQ(six.code, 0) << six.err;
    const Result three = run("three.yaml -o three -j 1");
    ASSERT_EQ(three.code, 0) << three.err;
    const std::string number = std::to_string(k);
    ASSERT_EQ(run("six.yaml -o alone -j 2 --environment " + number).code, 0);
    const Result printed = mortise("check six.yaml --print-resolved --environment " + number, folder_);
    ASSERT_EQ(printed.out.find("environments:"), std::string::npos);
    write("own.yaml", printed.out);
    ASSERT_EQ(run("own.yaml -o own").code, 0);
    for (const char* other : {"three", "alone", "own"})
      expect_equal("six" + env(k), std::string(other) + (std::string(other) == "three" ? env(k) : ""));
    EXPECT_NE(last_state(at("six" + env(0))), last_state(at("six" + env(1))));
  }
  // Rows of one model, in one of any size, against processes; `codes` may be those of failures.
  void expect_together(const std::string& scene, int count, int code = 0, const std::vector<std::string>& sizes = {"", "=2"}) const {
    write("s.yaml", scene);
    ASSERT_EQ(run("s.yaml -o processes -j 2").code, code);
    for (const std::string& k : sizes) {
      const std::string out = k.empty() ? "together" : "together2";
      const Result r = run("s.yaml -o " + out + " --together" + k);
      ASSERT_EQ(r.code, code) << r.err;
      const nlohmann::json a = summary("processes")["environments"], b = summary(out)["environments"];
      const auto done = std::count_if(a.begin(), a.end(), [](const nlohmann::json& one) { return one["status"] == "done"; });
      EXPECT_TRUE(code == 0 ? done == count : done > 0 && done < count) << done << " of them do not fail";
      for (int e = 0; e < count; ++e) {
        for (const char* key : {"status", "exit_code", "grade", "reason", "steps", "frames", "newton_iterations", "values"})
          EXPECT_EQ(a[e][key], b[e][key]) << out << ", environment " << e << ", " << key;
        for (int j = 0; fs::exists(at("processes" + env(e) + part(j))); ++j) {
          expect_equal("processes" + env(e) + part(j), out + env(e) + part(j));
          EXPECT_EQ(certificate("processes" + env(e) + part(j)), certificate(out + env(e) + part(j)));
        }
      }
    }
    fs::remove_all(at("processes")), fs::remove_all(at("together")), fs::remove_all(at("together2"));
  }
  std::string part(int episode) const {
    return fs::exists(at("processes" + env(0) + "/episode_0000")) ? "/episode_000" + std::to_string(episode) : episode ? "/none" : "";
  }
  // Without the name of the folder in a message.
  std::string certificate(const std::string& out) const {
    std::string text = read_text(at(out) + "/certificate.json");
    const std::string folder = out.substr(0, out.find('/')) + "/env_";
    for (std::size_t i; (i = text.find(folder)) != std::string::npos;) text.erase(i, folder.size());
    return text;
  }
  const std::string folder_ = (fs::temp_directory_path() / ("mortise_environments_" + std::to_string(getpid()))).string();
};

TEST_F(EnvironmentsProgram, LeaveAFolderEachAndWhatSumsThemUp) {
  write("s.yaml", press(kMortar, "{}", varied(3)));
  const Result r = run("s.yaml -o out --json");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_THAT(r.out, HasSubstr("\"environments\":3"));
  EXPECT_THAT(r.out, HasSubstr("{\"event\":\"step\",\"environment\":2,"));
  const nlohmann::json j = summary("out");
  EXPECT_EQ(j["done"], 3);
  std::istringstream table(read_text(at("out/environments.csv")));
  std::string line;
  std::getline(table, line);
  EXPECT_THAT(line, HasSubstr(",materials.gel.youngs_modulus,effects.friction.mu,bodies.ball.position.0"));
  for (int e = 0; e < 3; ++e) {
    std::getline(table, line);
    EXPECT_EQ(line.rfind(std::to_string(e) + ",done,0,", 0), 0u) << line;
    for (const char* file : {"fields.vtkhdf", "run.json", "certificate.json", "checkpoint.h5"})
      EXPECT_TRUE(fs::exists(at("out" + env(e) + "/" + file)));
    EXPECT_EQ(j["environments"][e]["steps"], 8);
  }
  EXPECT_EQ(nlohmann::json::parse(read_text(at("out/run.json")))["status"], "done");
  EXPECT_EQ(run("s.yaml -o out").code, 2) << "the folder is not empty";
  EXPECT_EQ(run("s.yaml -o out --environment 3").code, 2);
  // Fewer of them replace all.
  ASSERT_EQ(run("s.yaml -o out --overwrite --set environments.count=2").code, 0);
  EXPECT_FALSE(fs::exists(at("out" + env(2))));
  EXPECT_EQ(std::system((quoted(kJudge) + " " + quoted(at("out/fields.vtkhdf")) + " > " + quoted(at("judged"))).c_str()), 0);
  EXPECT_EQ(nlohmann::json::parse(read_text(at("judged")))["environments"].size(), 2u);
}

TEST_F(EnvironmentsProgram, MortarAndFrictionBitForBit) {
  expect_invariant(press(kMortar, "{linear: direct}", varied(6)), press(kMortar, "{linear: direct}", varied(3)), 2);
}
TEST_F(EnvironmentsProgram, ReusedFactorsBitForBit) {
  expect_invariant(press(kBarrier, "{linear: reuse}", varied(6)), press(kBarrier, "{linear: reuse}", varied(3)), 1);
}
TEST_F(EnvironmentsProgram, ConjugateGradientsBitForBit) {
  expect_invariant(press(kMortar, "{linear: cg}", varied(6)), press(kMortar, "{linear: cg}", varied(3)), 2);
}

TEST_F(EnvironmentsProgram, JointsBitForBit) {
  std::string scene = read_text(kSource + "/scenes/first/07_pendulum_with_pad.yaml");
  const auto of = [&](int count) {
    std::string s = scene;
    s.replace(s.find("steps: 200"), 10, "steps: 90");
    return s + "\nenvironments: {count: " + std::to_string(count) +
           ", seed: 2, vary: [{path: materials.rubber.youngs_modulus, scale: {log_uniform: [0.5, 2]}}, {path: effects.friction.mu, abs: {uniform: "
           "[0.2, 0.8]}}, {path: materials.steel.density, scale: {uniform: [0.8, 1.25]}}]}\n";
  };
  expect_invariant(of(3), of(2), 1);
}

// One fails in a step, one starts inside the pad, one is killed: the others have the bits of runs without them.
TEST_F(EnvironmentsProgram, FailuresAreTheirOwn) {
  const auto scene = [](const std::string& of_heights, const std::string& iterations) {
    return press(kBarrier, "{iterations: " + iterations + ", halvings: 0}",
                 "environments:\n  count: 5\n  vary: [{path: bodies.ball.position.2, add: {choice: " + of_heights +
                     "}}, {path: materials.gel.youngs_modulus, scale: {log_uniform: [0.9, 1.1]}}]\n");
  };
  write("good.yaml", scene("[0 mm]", "100")), write("bad.yaml", scene("[0 mm, -0.5 mm]", "100"));
  ASSERT_EQ(run("good.yaml -o good").code, 0);
  const Result bad = run("bad.yaml -o bad");
  EXPECT_EQ(bad.code, 5) << bad.err;
  const nlohmann::json j = summary("bad");
  ASSERT_GT(j["failed"], 0);
  ASSERT_GT(j["done"], 0);
  for (int e = 0; e < 5; ++e) {
    const auto& one = j["environments"][e];
    if (one["exit_code"] == 0) {
      expect_equal("bad" + env(e), "good" + env(e));
    } else {
      EXPECT_EQ(one["exit_code"], 3);
      EXPECT_THAT(one["message"].get<std::string>(), HasSubstr("bodies must start apart"));
      EXPECT_EQ(one["grade"], "F");
    }
  }
  // A single Newton iteration is too few for all: exit 5, each says why, with the command that replays it.
  write("hard.yaml", scene("[0 mm]", "1"));
  const Result hard = run("hard.yaml -o hard");
  EXPECT_EQ(hard.code, 5);
  EXPECT_THAT(hard.err, HasSubstr("all 5 environments failed"));
  EXPECT_THAT(summary("hard")["environments"][4]["message"].get<std::string>(), HasSubstr("--resume --frames 1 --environment 4"));
}

TEST_F(EnvironmentsProgram, StoppedAndKilledItEndsWithEqualBits) {
  write("s.yaml", press(kMortar, "{}", varied(4)));
  const auto begin = std::chrono::steady_clock::now();
  ASSERT_EQ(run("s.yaml -o whole").code, 0);
  const auto whole = std::chrono::steady_clock::now() - begin;  // on this machine, as busy as it is
  int stopped = 0;
  for (int i = 0; i < 6; ++i) {
    const pid_t child = start({"run", at("s.yaml"), "-o", at("cut"), "--no-render", "--resume=auto", "-q", "-j", "2"}, [this] {
      const int out = open(at("cut.txt").c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
      dup2(out, 1), dup2(out, 2);
    });
    std::this_thread::sleep_for(whole * (2 + i) / 20);
    kill(child, i % 2 ? SIGKILL : SIGTERM);
    const int code = wait_for(child);
    stopped += code == 75 || code == 137;
    std::this_thread::sleep_for(std::chrono::milliseconds(100));  // its environments die with it
  }
  EXPECT_GT(stopped, 1) << read_text(at("cut.txt"));
  const Result last = run("s.yaml -o cut --resume");
  ASSERT_EQ(last.code, 0) << last.err;
  for (int e = 0; e < 4; ++e) expect_equal("whole" + env(e), "cut" + env(e));
}

// An environment that is killed by the system is one that failed.
TEST_F(EnvironmentsProgram, AKilledEnvironmentIsNamed) {
  write("s.yaml", press(kMortar, "{}", varied(3)));
  const pid_t child = start({"run", at("s.yaml"), "-o", at("out"), "--no-render", "-q", "-j", "1", "--set", "time.steps=400"}, [this] {
    const int out = open(at("said.txt").c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
    dup2(out, 1), dup2(out, 2);
  });
  int killed = 0;
  for (int i = 0; i < 400 && killed < 3; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    const std::string lock = at("out" + env(killed) + "/run.lock");
    std::istringstream in(read_text(lock));
    std::string host;
    pid_t process = 0;
    if (!(in >> host >> process) || process == child) continue;
    std::error_code ec;
    const auto threads = std::distance(fs::directory_iterator("/proc/" + std::to_string(process) + "/task", ec), fs::directory_iterator());
    if (!ec) {
      EXPECT_EQ(threads, 1) << "-j 1 is one thread, those of libraries included";
    }
    killed += kill(process, SIGKILL) == 0;
  }
  EXPECT_EQ(wait_for(child), 1) << read_text(at("said.txt"));
  EXPECT_EQ(killed, 3);
  EXPECT_THAT(summary("out")["environments"][1]["message"].get<std::string>(), HasSubstr("signal 9"));
}

// A ball is thrown onto a pad again and again.
std::string thrown(const std::string& reset, const std::string& heights = "[4.5 mm]") {
  return "mortise: 1\nname: thrown\ntime: {step: 5 ms, steps: 24, frame_every: 2}\nenvironments:\n  count: 3\n  seed: 3\n  vary:\n    - {path: "
         "materials.gel.youngs_modulus, scale: {log_uniform: [0.5, 2]}}\n"
         "    - {path: bodies.ball.velocity.2, abs: {uniform: [-0.4 m/s, -0.2 m/s]}}\n    - {path: bodies.ball.position.2, abs: {choice: " +
         heights + "}}\n  reset: " + reset +
         "\n"
         "materials: {gel: {youngs_modulus: 0.2 MPa, poisson_ratio: 0.45, density: 1050}, steel: {density: 7850}}\n"
         "bodies:\n"
         "  pad: {type: soft, shape: {box: {size: [15 mm, 12 mm, 4 mm], edge_length: 3 mm}}, material: gel, position: [0, 0, -2 mm]}\n"
         "  ball: {type: stiff, shape: {sphere: {radius: 4 mm, edge_length: 2 mm}}, material: steel, position: [-1 mm, 0, 4.5 mm], velocity: [0.1 "
         "m/s, 0, 0]}\n"
         "effects:\n  inertia: {}\n  elasticity: {}\n  affine_body: {}\n  pin: [{body: pad, where: {side: z_min}}]\n  mortar_contact: {pairs: "
         "[{slave: pad, master: ball}]}\n"
         "  friction: {follows: mortar_contact, mu: 0.5}\noutput: {precision: double}\n";
}

// After a reset everything is that of a run from the start: an episode has the bits that it has alone, whatever went before it.
TEST_F(EnvironmentsProgram, EpisodesBeginAfresh) {
  write("s.yaml", thrown("[{after: 50 ms}, {body: ball, axis: z, above: 4.6 mm}, {quantity: mortar_contact/force_pad_z, below: -0.047 N}]"));
  const Result r = run("s.yaml -o out");
  ASSERT_EQ(r.code, 0) << r.err;
  std::istringstream log(read_text(at("out/episodes.csv")));
  std::string line;
  std::getline(log, line);
  EXPECT_EQ(line, "environment,episode,first_step,steps,ended_by,materials.gel.youngs_modulus,bodies.ball.velocity.2,bodies.ball.position.2");
  std::set<std::string> draws, reasons;
  std::map<int, int> taken;
  int compared = 0;
  while (std::getline(log, line)) {
    int e = 0, j = 0, first = 0, steps = 0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%d,%d,%d,%d,", &e, &j, &first, &steps), 4) << line;
    EXPECT_EQ(first, taken[e]);
    taken[e] += steps;
    const std::size_t quote = line.find('"'), end = line.find('"', quote + 1);
    draws.insert(line.substr(end)), reasons.insert(line.substr(quote + 1, 5));
    if (steps % 2 != 0 || compared == 3 || j == 0) continue;
    const std::string alone = "alone" + std::to_string(compared++), number = std::to_string(e), episode = std::to_string(j);
    ASSERT_EQ(run("s.yaml -o " + alone + " --environment " + number + " --episode " + episode + " --frames " + std::to_string(steps / 2)).code, 0);
    auto there = last_state(at("out" + env(e) + "/episode_000" + episode));
    std::erase_if(there, [](const auto& entry) { return entry.first.rfind("run/reset", 0) == 0; });
    EXPECT_EQ(there, last_state(at(alone))) << line;
  }
  EXPECT_GE(compared, 2);
  EXPECT_GT(draws.size(), 5u);
  EXPECT_TRUE(reasons.count("after") && reasons.count("morta")) << read_text(at("out/episodes.csv"));
  for (const auto& [e, steps] : taken) EXPECT_EQ(steps, 24);
}

// What has ended is not run again: results of another scene would stand under its numbers.
TEST_F(EnvironmentsProgram, AnotherSceneIsNotResumed) {
  write("resets.yaml", thrown("[{after: 40 ms}]"));
  write("plain.yaml", press(kMortar, "{}", varied(2)));
  for (const std::string name : {"resets", "plain"}) {
    ASSERT_EQ(run(name + ".yaml -o " + name).code, 0);
    const std::string table = read_text(at(name) + "/environments.csv"), sums = read_text(at(name) + "/environments.json");
    for (const std::string other : {"environments.seed=99", "materials.steel.density=3000"}) {
      const Result again = run(name + ".yaml -o " + name + " --resume --set " + other);
      EXPECT_EQ(again.code, 6) << again.err;
      EXPECT_THAT(again.err, HasSubstr("belong to another scene, other --set values"));
      EXPECT_EQ(read_text(at(name) + "/environments.csv"), table);
      EXPECT_EQ(read_text(at(name) + "/environments.json"), sums);
    }
    EXPECT_EQ(run(name + ".yaml -o " + name + " --resume --set environments.count=3").code, 0) << "more of them";
  }
}

// Episodes have values of the scene's quantities, and so has one that is continued after its last step.
TEST_F(EnvironmentsProgram, EpisodesHaveValuesOfQuantities) {
  write("s.yaml", thrown("[{after: 40 ms}]") + "quantities: [{value: elasticity/energy}]\n");
  ASSERT_EQ(run("s.yaml -o out").code, 0);
  const auto value = [this](const std::string& dir) {
    return nlohmann::json::parse(read_text(at(dir) + "/certificate.json"))["error_budget"][0]["value"].get<double>();
  };
  const std::string first = "out" + env(1) + "/episode_0000", last = "out" + env(1) + "/episode_0002";
  EXPECT_GT(value(first), 0);
  const double before = value(last);
  fs::remove(at(last) + "/run.json"), fs::remove(at(last) + "/certificate.json");
  std::string log = read_text(at("out" + env(1)) + "/episodes.csv");
  log.erase(log.rfind('\n', log.size() - 2) + 1);
  write("out" + env(1) + "/episodes.csv", log);
  ASSERT_EQ(run("s.yaml -o out --resume").code, 0);
  EXPECT_EQ(value(last), before);
}

TEST_F(EnvironmentsProgram, ResetsSurviveKills) {
  write("s.yaml", thrown("[{after: 40 ms}, {body: ball, axis: z, above: 4.6 mm}]"));
  ASSERT_EQ(run("s.yaml -o whole").code, 0);
  for (int i = 0; i < 6; ++i) {
    const pid_t child = start({"run", at("s.yaml"), "-o", at("cut"), "--no-render", "--resume=auto", "-q", "-j", "2"}, [this] {
      const int out = open(at("cut.txt").c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
      dup2(out, 1), dup2(out, 2);
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(150 + 100 * i));
    kill(child, i % 2 ? SIGKILL : SIGTERM);
    wait_for(child);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  const Result last = run("s.yaml -o cut --resume");
  ASSERT_EQ(last.code, 0) << last.err;
  EXPECT_EQ(read_text(at("whole/episodes.csv")), read_text(at("cut/episodes.csv")));
  for (int e = 0; e < 3; ++e)
    for (int j = 0; fs::exists(at("whole" + env(e) + "/episode_000" + std::to_string(j))); ++j)
      expect_equal("whole" + env(e) + "/episode_000" + std::to_string(j), "cut" + env(e) + "/episode_000" + std::to_string(j));
  // After the last state of all, before its reason was noted.
  const std::string log = at("cut" + env(0) + "/episodes.csv"), noted = read_text(log);
  std::ofstream(log) << noted.substr(0, noted.rfind('\n', noted.size() - 2) + 1);
  for (const char* summary : {"cut/environments.csv", "cut/environments.json"}) fs::remove(at(summary));
  EXPECT_EQ(run("s.yaml -o cut --resume").code, 0);
  EXPECT_EQ(read_text(log), noted);
}

// Episodes that start inside the pad are over at once; the environment goes on with other numbers. Without the condition it fails.
TEST_F(EnvironmentsProgram, AFailureMayBeAReset) {
  write("s.yaml", thrown("[{after: 40 ms}, {failure: true}]", "[4.5 mm, 3.5 mm]"));
  const Result r = run("s.yaml -o out");
  EXPECT_EQ(r.code, 0) << r.err;
  EXPECT_THAT(read_text(at("out/episodes.csv")), HasSubstr(",1,\"failure: "));
  EXPECT_EQ(summary("out")["done"], 3);
  const Result checked = mortise("check " + at("s.yaml"));  // said 3, though the run is fine
  EXPECT_EQ(checked.code, 0);
  EXPECT_THAT(checked.err, HasSubstr("warning: a start that fails, after which the environment is reset:"));
  write("v.yaml", thrown("[{after: 1 us}]"));
  EXPECT_THAT(run("v.yaml -o odd --environment 0 --set time.steps=3").err,
              HasSubstr("warning: its first 3 episodes all ended with their first step: after 1e-06 s"));
  write("t.yaml", thrown("[{after: 40 ms}]", "[4.5 mm, 3.5 mm]"));
  EXPECT_EQ(run("t.yaml -o other").code, 5);
  write("u.yaml", thrown("[{quantity: mortar_contact/force_pad_y_, above: 1 N}]"));
  const Result unknown = run("u.yaml -o unknown");
  EXPECT_EQ(unknown.code, 5);
  EXPECT_THAT(unknown.err, HasSubstr("did you mean 'mortar_contact/force_pad_"));
}

// One model of all of them, on a scene with friction and each linear solver.
TEST_F(EnvironmentsProgram, TogetherMortarAndFrictionBitForBit) {
  for (const char* linear : {"direct", "reuse", "cg"}) expect_together(press(kMortar, std::string("{linear: ") + linear + "}", varied(3)), 3);
  expect_together(press(kBarrier, "{}", varied(3)), 3);
}

// A robot's leg with a motor: what may differ, differs.
TEST_F(EnvironmentsProgram, TogetherARobotBitForBit) {
  const auto shortened = [](std::string scene, const std::string& steps, const std::string& to, const std::string& vary) {
    scene.replace(scene.find(steps), steps.size(), to);
    return scene + "\noutput: {precision: double}\nenvironments: {count: 3, seed: 2, vary: [" + vary + "]}\n";
  };
  expect_together(
      shortened(read_text(kSource + "/scenes/first/07_pendulum_with_pad.yaml"), "steps: 200", "steps: 90",
                "{path: materials.rubber.youngs_modulus, scale: {log_uniform: [0.5, 2]}}, {path: effects.friction.mu, abs: {uniform: [0.2, "
                "0.8]}}, {path: materials.steel.density, scale: {uniform: [0.8, 1.25]}}"),
      3);
}

// A failure, and bodies that touch at the start, are an environment's own.
TEST_F(EnvironmentsProgram, TogetherFailuresAreTheirOwn) {
  const auto scene = [](const std::string& of_heights, const std::string& iterations) {
    return press(kBarrier, "{iterations: " + iterations + ", halvings: 0}",
                 "environments:\n  count: 5\n  vary: [{path: bodies.ball.position.2, add: {choice: " + of_heights +
                     "}}, {path: materials.gel.youngs_modulus, scale: {log_uniform: [0.1, 10]}}]\n");
  };
  expect_together(scene("[0 mm, -0.5 mm]", "100"), 5, 5);
  std::string rubs = press(kMortar, "{iterations: 3, halvings: 0}",
                           "environments:\n  count: 5\n  vary: [{path: effects.friction.mu, abs: {choice: [0.1, 0.9]}}, {path: "
                           "materials.gel.youngs_modulus, scale: {log_uniform: [0.1, 10]}}]\n");
  rubs.replace(rubs.find("mu: 0.5}"), 8, "mu: 0.5, creep_speed: 1e-5 m/s}");  // hard enough for three iterations
  expect_together(rubs, 5, 5);
}

// Each is reset by itself, with numbers of its own; an episode that cannot begin is one too.
TEST_F(EnvironmentsProgram, TogetherEpisodesBeginAfresh) {
  expect_together(thrown("[{after: 50 ms}, {body: ball, axis: z, above: 4.6 mm}, {quantity: mortar_contact/force_pad_z, below: -0.047 N}]"), 3, 0,
                  {""});
  expect_together(thrown("[{after: 40 ms}, {failure: true}]", "[4.5 mm, 3.5 mm]"), 3, 0, {"=2"});
}

TEST_F(EnvironmentsProgram, TogetherStoppedAndKilledTheyEndWithEqualBits) {
  write("s.yaml", press(kMortar, "{}", varied(3)));
  ASSERT_EQ(run("s.yaml -o whole --together").code, 0);
  int stopped = 0;
  for (int i = 0; i < 6; ++i) {
    const pid_t child = start({"run", at("s.yaml"), "-o", at("cut"), "--no-render", "--resume=auto", "-q", "--together"}, [this] {
      const int out = open(at("cut.txt").c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
      dup2(out, 1), dup2(out, 2);
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(200 + 150 * i));
    kill(child, i % 2 ? SIGKILL : SIGTERM);
    const int code = wait_for(child);
    stopped += code == 75 || code == 137;
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  EXPECT_GT(stopped, 1) << read_text(at("cut.txt"));
  // And from there as processes.
  const Result last = run("s.yaml -o cut --resume");
  ASSERT_EQ(last.code, 0) << last.err;
  for (int e = 0; e < 3; ++e) expect_equal("whole" + env(e), "cut" + env(e));
}

TEST_F(EnvironmentsProgram, TogetherWhatAModelHasInCommonIsNamed) {
  const auto refused = [&](const std::string& path, const std::string& bodies = "") {
    std::string scene = press(kBarrier, "{}", "environments: {count: 2, vary: [{path: " + path + ", scale: {uniform: [0.5, 1]}}]}\n");
    if (!bodies.empty()) scene.insert(scene.find("effects:"), bodies);
    write("s.yaml", scene);
    const Result r = run("s.yaml -o refused --together");
    EXPECT_EQ(r.code, 2) << path;
    EXPECT_FALSE(fs::exists(at("refused/env_0000")));
    return r.err;
  };
  EXPECT_THAT(refused("effects.friction.lag_tolerance"), HasSubstr("s.yaml:5:"));
  EXPECT_THAT(refused("effects.friction.lag_tolerance"), HasSubstr("what may differ there: mu, pairs, creep_speed"));
  EXPECT_THAT(refused("bodies.floor.point.2", "  floor: {type: half_space, point: [0, 0, -9 mm]}\n"),
              HasSubstr("a half_space is in all environments"));
  write("plain.yaml", press(kBarrier, "{}", ""));
  EXPECT_EQ(run("plain.yaml -o plain --together").code, 2);
  for (const char* wrong : {"0", "-1", "many", "-2"}) {
    const Result bad = run(std::string("s.yaml -o none --together=") + wrong);
    EXPECT_EQ(bad.code, 2) << wrong;
    EXPECT_NE(bad.err.find("is no number of environments"), std::string::npos) << bad.err;
  }
  EXPECT_FALSE(fs::exists(at("none")));
  EXPECT_EQ(run("s.yaml -o none --together --environment 1").code, 2);
}

TEST_F(EnvironmentsProgram, OtherCommandsKnowThem) {
  write("s.yaml", press(kMortar, "{}", varied(3)));
  const Result check = mortise("check s.yaml", folder_);
  EXPECT_EQ(check.code, 0) << check.err;
  EXPECT_THAT(check.out, HasSubstr("3 environments"));
  EXPECT_THAT(mortise("check s.yaml --plan", folder_).out, HasSubstr("environments  3"));
  EXPECT_EQ(mortise("check s.yaml --environment 3", folder_).code, 2);
  EXPECT_EQ(mortise("render s.yaml none.vtkhdf", folder_).code, 2);
  write("sweep.yaml",
        "mortise_sweep: 1\nscene: s.yaml\nset: [environments.count=2, time.steps=2]\nrows: [{product: {effects.mortar_contact.d_hat: [0.1 mm, 0.2 "
        "mm]}}]\n");
  const Result sweep = mortise("sweep sweep.yaml -o swept --no-render", folder_), merged = mortise("merge swept", folder_);
  EXPECT_EQ(sweep.code, 0) << sweep.err;
  EXPECT_EQ(merged.code, 0) << merged.err;
  EXPECT_THAT(read_text(at("swept/table.csv")), HasSubstr("done,0,C,"));
  // What every environment draws no row can set, and there is no one number of a row.
  write("mu.yaml", "mortise_sweep: 1\nscene: s.yaml\nrows: [{product: {effects.friction.mu: [0.1, 0.2]}}]\n");
  EXPECT_THAT(mortise("sweep mu.yaml --dry-run", folder_).err, HasSubstr("effects.friction.mu is drawn for every environment"));
  write("q.yaml", "mortise_sweep: 1\nscene: s.yaml\nquantities: [inertia/kinetic_energy]\nrows: [{product: {time.steps: [2]}}]\n");
  EXPECT_THAT(mortise("sweep q.yaml --dry-run", folder_).err, HasSubstr("a row of environments has no values of its own"));
  EXPECT_EQ(mortise("study s.yaml --vary time.step=1ms,2ms --quantity inertia/kinetic_energy", folder_).code, 2);
}

}  // namespace
}  // namespace mortise::cli
