// `mortise run` from outside: output folder, frames, restart after being stopped or killed, other devices.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "output/field_reader.h"
#include "process.h"
#include "render/image.h"

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

// It failed with "it is nan", exit 7.
TEST(Run, ChecksThatFramesDoNotReachDoNotFail) {
  const Folder out;
  const std::string checks =
      " --set 'checks=[{quantity: position, body: block, axis: z, from: 20 ms, below: 1}, {quantity: position, body: block, axis: z, when: end, "
      "below: -1}]' --no-render -o " +
      out.path;
  const Result early = mortise("run " + kScene + checks + " --frames 1");
  EXPECT_EQ(early.code, 0) << early.err;
  EXPECT_THAT(early.err, testing::HasSubstr("check not reached: position of block (z), from 0.02 s below 1; the run ended at"));
  EXPECT_THAT(early.err, testing::HasSubstr("check not reached: position of block (z), end"));
  const auto criteria = nlohmann::json::parse(read_text(out.path + "/certificate.json")).at("criteria");
  ASSERT_EQ(criteria.size(), 2u);
  for (const auto& c : criteria) EXPECT_TRUE(c.at("pass").is_null() && c.at("value").is_null()) << c;
  const Result late = mortise("check " + kScene + " --set 'checks=[{quantity: position, body: block, axis: z, from: 30 s, below: 1}]'");
  EXPECT_EQ(late.code, 3);
  EXPECT_THAT(late.err, testing::HasSubstr("checks.0.from: the scene ends at"));
  EXPECT_THAT(late.err, testing::HasSubstr("--frames N ends a run earlier"));
}

// A block that stands 6 m above its floor, where 6 mm was meant, said nothing of that.
TEST(Run, SaysThatNothingTouched) {
  const std::string said = "nothing touched at any time";
  const Folder high, low;
  const Result above = mortise("run " + kScene + " --no-render --set time.steps=5 --set bodies.block.position='[0, 0, 6]' -o " + high.path);
  ASSERT_EQ(above.code, 0) << above.err;
  EXPECT_THAT(above.err, testing::HasSubstr(said));
  const Result on_it = mortise("run " + kScene + " --no-render --set time.steps=40 -o " + low.path);
  ASSERT_EQ(on_it.code, 0) << on_it.err;
  EXPECT_THAT(on_it.err, testing::Not(testing::HasSubstr(said)));
}

// A ball on one vertex, above which no sample is: what keeps surfaces apart bears it, and its grade says so.
TEST(Run, SaysWhatTheGuardBearsAndNotThatNothingTouched) {
  const Folder out;
  fs::create_directories(out.path);
  const std::string scene = out.path + "/ball.yaml";
  std::ofstream(scene) << R"(
mortise: 1
name: ball
time: {mode: static, steps: 1}
materials: {rubber: {youngs_modulus: 1 MPa, poisson_ratio: 0.3, density: 1000}}
bodies:
  ball: {type: soft, order: 2, shape: {sphere: {radius: 20 mm, edge_length: 8 mm}}, material: rubber, position: [0, 0, 20.01 mm]}
  floor: {type: half_space}
effects: {elasticity: {}, gravity: {}, mortar_contact: {pairs: [{slave: ball, master: floor}]}}
)";
  const Result r = mortise("run " + scene + " --no-render -o " + out.path + "/run");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_THAT(r.err, testing::Not(testing::HasSubstr("nothing touched")));
  EXPECT_THAT(r.err, testing::HasSubstr("grade C: guard_share is 1"));
}

// The schema's keys and no others; E A travel / L = 2 N is what the value and its error make.
TEST(Run, CertifiesHowWrongTheQuantitiesOfItsSceneAre) {
  const std::string patch = kSource + "/benchmarks/effectivity/patch.yaml";
  const auto budget = [](const std::string& dir) {
    return nlohmann::json::parse(read_text(dir + "/certificate.json")).value("error_budget", nlohmann::json());
  };
  const Folder out, motion, wrong, none;
  ASSERT_EQ(mortise("run " + patch + " -o " + out.path).code, 0);
  const auto said = budget(out.path);
  ASSERT_EQ(said.size(), 1u);
  EXPECT_EQ(said[0]["quantity"], "force on the plate");
  EXPECT_NEAR(said[0]["value"].get<double>() + said[0]["error"].get<double>(), -2, 0.01);
  const auto schema = nlohmann::json::parse(read_text(kSource + "/schemas/certificate.schema.json"))["properties"]["error_budget"]["items"];
  for (const auto& [key, value] : said[0].items()) EXPECT_TRUE(schema["properties"].contains(key)) << key;
  for (const auto& key : schema["required"]) EXPECT_TRUE(said[0].contains(key)) << key;
  // What cannot be told is told, and costs no run its end.
  const std::string quantity = " --set 'quantities=[{value: elasticity/energy}]'";
  ASSERT_EQ(mortise("run " + kScene + " --no-render --set time.steps=2 -o " + motion.path + quantity).code, 0);
  EXPECT_GT(budget(motion.path)[0]["value"].get<double>(), 0);
  EXPECT_TRUE(budget(motion.path)[0]["error"].is_null());
  EXPECT_NE(budget(motion.path)[0]["why_not"].get<std::string>().find("in motion the errors of all steps add up"), std::string::npos);
  const Folder energy;
  ASSERT_EQ(mortise("run " + patch + " -o " + energy.path + quantity).code, 0);
  EXPECT_NE(budget(energy.path)[0]["why_not"].get<std::string>().find("mortise study SCENE --error-budget has it"), std::string::npos);
  // A name that nothing reports ends it before the first step.
  const Result misspelt = mortise("run " + patch + " -o " + wrong.path + " --set 'quantities=[{value: supports/plates_z}]'");
  EXPECT_EQ(misspelt.code, 3);
  EXPECT_NE(misspelt.err.find("nothing reports 'supports/plates_z'"), std::string::npos) << misspelt.err;
  ASSERT_EQ(mortise("run " + kScene + " --no-render --set time.steps=1 -o " + none.path).code, 0);
  EXPECT_TRUE(budget(none.path).is_null());
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

// Whoever wants more of a run goes on with more steps, and ends where a run of so many would have.
TEST(Run, ResumeTakesMoreSteps) {
  const Folder out, whole;
  const auto go = [](const Folder& to, const std::string& more) {
    return mortise("run " + kScene + " --no-render --set time.frame_every=2 -o " + to.path + " " + more);
  };
  ASSERT_EQ(go(whole, "--set time.steps=12").code, 0);
  ASSERT_EQ(go(out, "--set time.steps=6").code, 0);
  const Result longer = go(out, "--resume --set time.steps=12");
  ASSERT_EQ(longer.code, 0) << longer.err;
  EXPECT_NE(longer.err.find("continuing at step 6, t = 0.012 s, to step 12 instead of 6"), std::string::npos) << longer.err;
  EXPECT_EQ(unlike(out.path, whole.path), "");
  const output::FieldReader fields(out.path + "/fields.vtkhdf"), others(whole.path + "/fields.vtkhdf");
  EXPECT_EQ(fields.frames(), others.frames());
  EXPECT_EQ(fields.scene_text(), others.scene_text());
  EXPECT_EQ(read_text(out.path + "/certificate.json"), read_text(whole.path + "/certificate.json"));
  EXPECT_EQ(go(out, "--resume --set time.steps=12").code, 0) << "there is nothing left to do";

  const Result less = go(out, "--resume --set time.steps=8");
  EXPECT_EQ(less.code, 6);
  EXPECT_NE(less.err.find("time.steps is 12 there and 8 here; 12 are done"), std::string::npos) << less.err;
  const Result other = go(out, "--resume --set time.steps=14 --set effects.gravity.acceleration=[0,0,-5]");
  EXPECT_EQ(other.code, 6);
  EXPECT_NE(other.err.find("\n  time.steps is 12 there and 14 here"), std::string::npos) << other.err;
  EXPECT_NE(other.err.find("\n  effects.gravity.acceleration is [0, 0, "), std::string::npos) << other.err;
}

// Frame 0 is there, and nothing that could be lost.
TEST(Run, ResumeAutoStartsAfreshAfterAnErrorInTheScene) {
  const Folder out;
  const std::string run = "run " + kScene + " --no-render --resume=auto --frames 1 -o " + out.path;
  ASSERT_EQ(mortise(run + " --set 'quantities=[{value: supports/nobody_z}]'").code, 3);
  const Result again = mortise(run);
  EXPECT_EQ(again.code, 0) << again.err;
}

// What is printed would go into the next file that is opened.
TEST(Run, NeedsNoStandardStreams) {
  const Folder out;
  const std::string run = "run " + kScene + " --no-render --frames 2 -o " + quoted(out.path);
  ASSERT_EQ(std::system((quoted(kProgram) + " " + run + " >&- 2>&-").c_str()), 0);
  EXPECT_EQ(output::FieldReader(out.path + "/fields.vtkhdf").frames(), 3);
}

TEST(Run, SaysWhatAQuantityLooksAt) {
  const Folder sum, largest, still;
  const std::string frames = " --no-render --set time.steps=4 --set time.frame_every=2 -o ";
  const auto quantity = [](const std::string& value, const std::string& when) {
    return " --set 'quantities=[{value: " + value + ", when: " + when + "}]'";
  };
  const Result none = mortise("run " + kScene + frames + sum.path + quantity("supports/work", "sum"));
  EXPECT_EQ(none.code, 3);
  EXPECT_THAT(none.err, testing::HasSubstr("a sum is of all steps, and only one in 2 has a frame"));
  const Result some = mortise("run " + kScene + frames + largest.path + quantity("supports/work", "largest"));
  EXPECT_EQ(some.code, 0) << some.err;
  EXPECT_THAT(some.err, testing::HasSubstr("the largest is of steps with frames, one in 2"));
  for (const auto& [value, code] :
       {std::pair{"supports/block", 0}, {"balance/gravity", 0}, {"supports/block_x", 0}, {"supports/block_q", 3}, {"balance/none", 3}}) {
    const Folder out;
    EXPECT_EQ(mortise("run " + kScene + frames + out.path + quantity(value, "end")).code, code) << value;
  }
  const Result at_rest =
      mortise("run " + kSource + "/scenes/first/05_static_press.yaml --no-render -o " + still.path + quantity("supports/work", "end"));
  EXPECT_EQ(at_rest.code, 3);
  EXPECT_THAT(at_rest.err, testing::HasSubstr("nothing reports 'supports/work'"));
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
  EXPECT_EQ(unlike(whole.path, parts.path), "");
  EXPECT_EQ(output::FieldReader(parts.path + "/fields.vtkhdf").frames(), 21);

  const pid_t pid = start({"run", scene, "--no-render", "--quiet", "-o", killed.path});
  ASSERT_TRUE(appears(killed.path + "/checkpoint.h5"));
  kill(pid, SIGKILL);
  EXPECT_EQ(wait_for(pid), 128 + SIGKILL);
  EXPECT_FALSE(fs::exists(killed.path + "/run.json"));
  // It may have come further than 20 frames: compare with an unbroken run to the very end.
  ASSERT_EQ(mortise("run " + scene + " --no-render --resume -o " + killed.path).code, 0);
  ASSERT_EQ(mortise("run " + scene + " --no-render --resume -o " + whole.path).code, 0);
  EXPECT_EQ(unlike(whole.path, killed.path), "");
}

TEST(Run, SigtermStopsWithACheckpointAndExit75) {
  const std::string scene = kSource + "/scenes/first/03_incline_friction.yaml";
  const Folder out, whole;
  const pid_t pid = start({"run", scene, "--no-render", "--quiet", "-o", out.path, "--set", "time.steps=100000"});
  ASSERT_TRUE(appears(out.path + "/checkpoint.prev.h5"));  // one of the start, and one behind a step
  kill(pid, SIGTERM);
  EXPECT_EQ(wait_for(pid), 75);
  EXPECT_EQ(run_json(out.path).at("exit_code"), 75);
  const auto steps = output::CheckpointReader(out.path + "/checkpoint.h5").info().step;
  ASSERT_GT(steps, 0);
  const std::string more = std::to_string(steps / 5 + 3);  // the scene writes a frame every five steps
  ASSERT_EQ(mortise("run " + scene + " --no-render --resume --frames " + more + " --set time.steps=100000 -o " + out.path).code, 0);
  ASSERT_EQ(mortise("run " + scene + " --no-render --frames " + more + " --set time.steps=100000 -o " + whole.path).code, 0);
  EXPECT_EQ(unlike(whole.path, out.path), "");
}

// Checkpoints by steps, apart from frames; from any of them the run goes on to the same bits.
TEST(Run, SavesItsStateAsOftenAsTheSceneSays) {
  const Folder out;
  const std::string flags = " --no-render --set time.steps=10 --set time.frame_every=1 --set output.checkpoint_every.steps=4 -o " + out.path;
  const Result r = mortise("run " + kScene + flags);
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(output::CheckpointReader(out.path + "/checkpoint.h5").info().step, 10);  // the last step always
  const auto before = output::CheckpointReader(out.path + "/checkpoint.prev.h5").info();
  EXPECT_EQ(before.step, 8);
  EXPECT_EQ(before.frames, 9);
  const auto state = last_state(out.path);
  const std::vector<Vec3> points = output::FieldReader(out.path + "/fields.vtkhdf").points(10);
  fs::remove(out.path + "/checkpoint.h5");
  const Result again = mortise("run " + kScene + flags + " --resume");
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(run_json(out.path).at("steps").at("count"), 10);
  EXPECT_NE(again.err.find("continuing at step 8"), std::string::npos) << again.err;
  EXPECT_EQ(last_state(out.path), state);
  EXPECT_EQ(output::FieldReader(out.path + "/fields.vtkhdf").points(10), points);

  const Folder hourly;
  ASSERT_EQ(mortise("run " + kScene + " --no-render --frames 3 --set 'output.checkpoint_every={seconds: 3600 s}' -o " + hourly.path).code, 0);
  EXPECT_EQ(output::CheckpointReader(hourly.path + "/checkpoint.h5").info().frames, 4);
  EXPECT_EQ(output::CheckpointReader(hourly.path + "/checkpoint.prev.h5").info().frames, 1);
  // Strict: one of the two, and nothing else.
  const Result both = mortise("check " + kScene + " --set 'output.checkpoint_every={seconds: 60 s, steps: 3}'");
  EXPECT_EQ(both.code, 3);
  EXPECT_NE(both.err.find("must hold only one of: seconds, steps"), std::string::npos) << both.err;
  EXPECT_EQ(mortise("check " + kScene + " --set output.checkpoint_every.steps=0").code, 3);
  const Result never = mortise("run " + kScene + " --no-render --checkpoint-every '0 s' -o " + hourly.path);
  EXPECT_EQ(never.code, 2);
  EXPECT_NE(never.err.find("--checkpoint-every is '0 s'; must be more than 0 s"), std::string::npos) << never.err;
}

// A kill between checkpoints loses frames that --resume computes again.
TEST(Run, FramesAfterTheLastCheckpointComeBackAfterAKill) {
  const Folder out, whole;
  const std::string scene = kScene,
                    flags = " --no-render --quiet --set time.steps=400 --set time.frame_every=1 --set output.checkpoint_every.steps=50";
  std::vector<std::string> args{
      "run", scene,   "--no-render", "--quiet", "--set", "time.steps=400", "--set", "time.frame_every=1", "--set", "output.checkpoint_every.steps=50",
      "-o",  out.path};
  const pid_t pid = start(args);
  for (int i = 0; i < 600 && !(fs::exists(out.path + "/checkpoint.prev.h5")); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  kill(pid, SIGKILL);
  wait_for(pid);
  const auto saved = output::CheckpointReader(out.path + "/checkpoint.h5").info();
  EXPECT_EQ(saved.step % 50, 0);
  EXPECT_GE(output::FieldReader(out.path + "/fields.vtkhdf").frames(), saved.frames);
  ASSERT_EQ(mortise("run " + scene + flags + " --resume -o " + out.path).code, 0);
  ASSERT_EQ(mortise("run " + scene + flags + " -o " + whole.path).code, 0);
  EXPECT_EQ(unlike(whole.path, out.path), "");
  const output::FieldReader a(whole.path + "/fields.vtkhdf"), b(out.path + "/fields.vtkhdf");
  ASSERT_EQ(a.frames(), b.frames());
  for (long f = 0; f < a.frames(); ++f) ASSERT_EQ(a.points(f), b.points(f)) << f;
}

namespace {

// A pad that a stiff block presses and drags, with one sensor.
const char* const kPressed = R"(mortise: 1
name: pressed
time: {mode: static, steps: 4}
materials: {gel: {youngs_modulus: 0.1 MPa, poisson_ratio: 0.45, density: 1000}, steel: {density: 7800, youngs_modulus: 200 GPa, poisson_ratio: 0.3}}
bodies:
  pad: {type: soft, shape: {box: {size: [20 mm, 20 mm, 8 mm], edge_length: 4 mm}}, material: gel, position: [0, 0, -4 mm]}
  block: {type: stiff, shape: {box: {size: [8 mm, 8 mm, 8 mm], edge_length: 4 mm}}, material: steel, position: [0, 0, 4.05 mm]}
effects:
  elasticity: {}
  affine_body: {}
  barrier_contact: {d_hat: 0.1 mm}
  friction: {mu: 0.5}
  pin:
    - {body: pad, where: {side: z_min}}
    - {body: block, where: {side: all}, motion: {time: [0, 0.5, 1], translation: [[0, 0, 0], [0, 0, -0.5 mm], [0.4 mm, 0, -0.5 mm]]}}
sensors:
  skin: {body: pad, rows: 10, columns: 10, width: 20 mm, height: 20 mm}
)";

std::set<std::string> pictures(const std::string& dir) {
  std::set<std::string> out;
  for (const auto& entry : fs::directory_iterator(dir)) out.insert(entry.path().filename());
  return out;
}

}  // namespace

// Pictures of every second frame; drawn again from the file they are the same, and other scales change them.
TEST(Run, SensorsAreDrawnAsOftenAsTheSceneSaysAndAgainFromTheFields) {
  const Folder out;
  fs::create_directories(out.path);
  const std::string scene = out.path + "/pressed.yaml", run = out.path + "/run";
  std::ofstream(scene) << kPressed << "render: {every: 2}\noutput: {precision: double}\n";
  const Result r = mortise("run " + scene + " -o " + run);
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(pictures(run + "/frames"), (std::set<std::string>{"sensor_skin_0000.png", "sensor_skin_0002.png", "sensor_skin_0004.png"}));
  const std::string drawn = read_text(run + "/frames/sensor_skin_0004.png");
  const render::Image map = render::read_png(run + "/frames/sensor_skin_0004.png");
  EXPECT_EQ(std::vector<int>(map.at(45, 270), map.at(45, 270) + 3), (std::vector<int>{34, 37, 42})) << "y = 0, a tick on the left of the middle";
  const auto redraw = [&](const std::string& flags, const std::string& name) {
    const Result again = mortise("render " + scene + " " + run + "/fields.vtkhdf -o " + out.path + "/" + name + " " + flags);
    EXPECT_EQ(again.code, 0) << again.err;
    return read_text(out.path + "/" + name + "/sensor_skin_0004.png");
  };
  EXPECT_EQ(redraw("", "same"), drawn);
  EXPECT_EQ(pictures(out.path + "/same"), pictures(run + "/frames"));
  EXPECT_EQ(redraw("--frames 4", "last"), drawn);  // its scales know the frames before
  EXPECT_EQ(pictures((redraw("--every 1", "all"), out.path + "/all")).size(), 5u);
  const std::string ranged = redraw("--set 'sensors.skin.range=[0, 5 kPa]'", "ranged"),
                    shear = redraw("--set 'sensors.skin.shear_range=[0, 50 kPa]'", "shear");
  EXPECT_NE(ranged, drawn);
  EXPECT_NE(shear, drawn);
  EXPECT_NE(shear, ranged);
  const Result other = mortise("render " + scene + " " + run + "/fields.vtkhdf -o " + out.path + "/other --set sensors.skin.rows=11");
  EXPECT_EQ(other.code, 3);
  EXPECT_NE(other.err.find("has no pressure of a sensor 'skin' with 11 x 10 taxels"), std::string::npos) << other.err;
  for (const char* wrong : {"range=[5 kPa, 0]", "range=[1 kPa]", "range=[0, 5 mm]", "shear_range=[-1 kPa, 5 kPa]"})
    EXPECT_EQ(mortise("check " + scene + " --set 'sensors.skin." + wrong + "'").code, 3) << wrong;
}

// What one has to know to use a sensor's numbers stands in the file.
TEST(Run, SensorGroupsSayWhatTheyAre) {
  const Folder out;
  fs::create_directories(out.path);
  std::ofstream(out.path + "/pressed.yaml") << kPressed;
  const Result r = mortise("run pressed.yaml --no-render --frames 2 -o run", out.path);
  ASSERT_EQ(r.code, 0) << r.err;
  using namespace output;
  const h5::File f(out.path + "/run/fields.vtkhdf", h5::Mode::read);
  const h5::Id effects = h5::open_group(f, f.id(), "mortise/effects"), skin = h5::open_group(f, effects, "sensor_skin");
  EXPECT_EQ(h5::get_text(f, skin, "body"), "pad");
  EXPECT_EQ(h5::get_integer(f, skin, "rows"), 10);
  EXPECT_EQ(h5::get_integer(f, skin, "columns"), 10);
  EXPECT_EQ(h5::get_number(f, skin, "width_m"), 0.02);
  EXPECT_EQ(h5::get_number(f, skin, "taxel_height_m"), 0.002);
  for (const char* name : {"height_m", "taxel_width_m", "position_m", "x_axis", "y_axis", "normal", "moves_with", "description"})
    EXPECT_GT(H5Aexists(skin, name), 0) << name;
  // Every dataset of these groups is described.
  for (const std::string& group : h5::members(f, effects)) {
    const h5::Id at = h5::open_group(f, effects, group);
    for (const std::string& name : h5::members(f, at)) {
      if (name == "row_offset") continue;
      const h5::Table table = h5::Table::open(f, at, name);
      EXPECT_GT(H5Aexists(table.id(), "description"), 0) << group << "/" << name;
    }
  }
  for (const char* folder : {"VTKHDF/PointData", "VTKHDF/CellData"}) {
    const h5::Id at = h5::open_group(f, f.id(), folder);
    for (const std::string& name : h5::members(f, at)) {
      if (name == "body_id") continue;
      EXPECT_GT(H5Aexists(h5::Table::open(f, at, name).id(), "description"), 0) << name;
    }
  }
  const h5::Id balance = h5::open_group(f, effects, "balance");
  EXPECT_NE(h5::get_text(f, h5::Table::open(f, balance, "written_defect").id(), "description").find("written as fields"), std::string::npos);
  EXPECT_NE(h5::get_text(f, h5::Table::open(f, balance, "barrier_contact_z").id(), "description").find("this effect"), std::string::npos);
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

// What a batch job needs that must be over in time.
TEST(Run, StopsBeforeItsWalltimeAndGoesOn) {
  const Folder out;
  const std::string run = "run scenes/first/02_block_on_floor.yaml --no-render -o " + out.path;
  const Result r = mortise(run + " --walltime '60.3 s' --grace '1 min'");
  EXPECT_EQ(r.code, 75) << r.err;
  EXPECT_NE(r.err.find("continue with --resume"), std::string::npos);
  EXPECT_EQ(mortise(run + " --frames 1 --resume=auto --walltime '1 h'").code, 0);
  EXPECT_EQ(mortise(run + " --frames 2 --resume --checkpoint-every '1 h'").code, 0);
  EXPECT_EQ(mortise(run + " --resume --walltime '1 min'").code, 2) << "no time is left to run";
  const Result wrong = mortise(run + " --walltime 3m");
  EXPECT_EQ(wrong.code, 2);
  EXPECT_NE(wrong.err.find("must be a time"), std::string::npos);
}

}  // namespace mortise::cli
