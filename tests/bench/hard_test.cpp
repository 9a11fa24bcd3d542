// Hard cases: what is made of a scene file, and random scenes.
#include "bench/hard/hard.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "base/error.h"
#include "engine/effect_tables.h"
#include "place.h"
#include "scene/scene.h"

namespace fs = std::filesystem;
using namespace mortise;
using namespace mortise::bench::hard;

namespace {

scene::Scene read(const std::string& text) { return scene::read_scene_text(text, "case.yaml", {}, engine::effect_tables()); }

TEST(Hard, EveryCaseOfEverySceneIsAScene) {
  int scenes = 0, cases = 0;
  for (const auto& entry : fs::directory_iterator(test_place::kSourceFolder + "/scenes/hard")) {
    if (entry.path().extension() != ".yaml") continue;
    ++scenes;
    for (const Case& c : cases_of(entry.path().string(), true)) {
      ++cases;
      const scene::Scene s = read(c.text);
      EXPECT_EQ(s.root.text("name") + ".yaml", entry.path().filename().string());
      EXPECT_EQ(s.root.at("effects").has("mortar_contact"), c.method == "mortar") << entry.path();
      EXPECT_FALSE(s.root.at("checks").items().empty());
      EXPECT_EQ(s.root.at("output").text("precision"), "double");
    }
  }
  EXPECT_GE(scenes, 50);
  EXPECT_GT(cases, 2 * scenes);
}

TEST(Hard, VariantsChangeWhatTheyName) {
  const auto cases = cases_of(test_place::kSourceFolder + "/scenes/hard/h48_incline.yaml", false);
  ASSERT_EQ(cases.size(), 4u);  // barrier, mortar, barrier with mu 0.49 and 0.5
  EXPECT_EQ(read(cases[1].text).root.at("effects").at("friction").text("follows"), "mortar_contact");
  EXPECT_EQ(cases[2].variant, "mu 0.49");
  EXPECT_DOUBLE_EQ(read(cases[2].text).root.at("effects").at("friction").number("mu"), 0.49);
  EXPECT_EQ(cases_of(test_place::kSourceFolder + "/scenes/hard/h48_incline.yaml", true).size(), 6u);
  EXPECT_TRUE(cases_of(test_place::kSourceFolder + "/scenes/hard/h67_pinch.yaml", false)[0].expects_failure);
}

TEST(Hard, WhatAMethodDoesNotClaimIsReported) {
  const auto cases = cases_of(std::string(MORTISE_SOURCE_DIR) + "/scenes/hard/h58_free_slide.yaml", false);
  EXPECT_EQ(cases[0].reported, std::vector<std::string>{"velocity"});  // barrier
  EXPECT_TRUE(cases[1].reported.empty());
}

Row row(const std::string& name, const std::string& reason) {
  Row r;
  r.name = name, r.method = "barrier", r.reason = reason, r.pass = reason.empty();
  return r;
}

// Against a committed result: what passed must pass; what failed may fail in other safe ways; crashes and inversions never go unseen.
TEST(Hard, RegressionsAreTold) {
  const std::string file = (fs::temp_directory_path() / ("mortise_expect_" + std::to_string(getpid()) + ".json")).string();
  std::ofstream(file) << R"({"rows": [{"case": "a", "method": "barrier", "variant": "", "pass": true, "reason": ""},
    {"case": "b", "method": "barrier", "variant": "", "pass": false, "reason": "energy_gain below 1e-06: 0.01"},
    {"case": "c", "method": "barrier", "variant": "", "pass": false, "reason": "not done after 30 s"}]})";
  const auto worse = [&](const Row& r) { return regressions({r}, file, false).size(); };
  EXPECT_EQ(worse(row("a", "")), 0u);
  EXPECT_EQ(worse(row("a", "energy_gain below 1e-06: 0.001")), 1u);
  EXPECT_EQ(worse(row("b", "")), 0u);  // better
  EXPECT_EQ(worse(row("b", "energy_gain below 1e-06: 0.019")), 0u);
  EXPECT_EQ(worse(row("a", "not done after 60 s")), 0u);  // a slow machine
  EXPECT_EQ(worse(row("b", "min_det_f above 1e-06: -0.001")), 1u);
  EXPECT_EQ(worse(row("c", "exit code 5: step 3 failed: Newton stopped")), 0u);
  EXPECT_EQ(worse(row("c", "ended by signal 11")), 1u);
  EXPECT_EQ(worse(row("d", "")), 1u);  // unknown
  Row touching = row("b", "energy_gain below 1e-06: 0.01");
  touching.unsafe = "judge: triangle 1 of a meets triangle 2 of b (frame 3)";
  EXPECT_EQ(worse(touching), 1u);
  EXPECT_EQ(regressions({row("a", "")}, file, true).size(), 2u);  // two were not run
  EXPECT_THROW(regressions({}, "/nowhere.json", false), Error);
  fs::remove(file);
}

TEST(Hard, ProgramsThatHangOrCrashAreToldApart) {
  EXPECT_EQ(run_program({"/bin/sh", "-c", "exit 5"}, "/dev/null", "/dev/null", 10).code, 5);
  EXPECT_EQ(run_program({"/bin/sh", "-c", "kill -SEGV $$"}, "/dev/null", "/dev/null", 10).code, 128 + 11);
  const Ended slow = run_program({"/bin/sleep", "10"}, "/dev/null", "/dev/null", 0.1);
  EXPECT_EQ(slow.code, -1);
  EXPECT_LT(slow.seconds, 5);
}

TEST(Fuzz, SeedsAreScenesAndStayTheSame) {
  for (unsigned long seed = 1; seed <= 200; ++seed) {
    const Case c = fuzz_case(seed);
    EXPECT_NO_THROW(read(c.text)) << c.text;
    EXPECT_EQ(c.text, fuzz_case(seed).text);
  }
  EXPECT_NE(fuzz_case(1).text.substr(30), fuzz_case(2).text.substr(30));
}

TEST(Fuzz, WildSeedsAreScenesAndStayTheSame) {
  const std::string folder = (fs::temp_directory_path() / ("mortise_wild_" + std::to_string(getpid()))).string();
  fs::create_directories(folder);
  std::string all;
  bool interrupted = false, debug = false;
  for (unsigned long seed = 1; seed <= 200; ++seed) {
    const Case c = wild_case(seed, folder);
    EXPECT_NO_THROW(read(c.text)) << c.text;
    EXPECT_EQ(c.text, wild_case(seed, folder).text);
    all += c.text, interrupted |= c.interrupted, debug |= !c.arguments.empty();
  }
  for (const char* kind : {"order: 2", "curved: true", ".msh", ".obj", "mode: static", "sensors:", "pressure_load:", "bdf2",
                           "body18:", "barrier_contact:", "mortar_contact:", "cg", "reuse", "release:", "side: all", "rotation:", "type: half_space",
                           "follows: mortar_contact", "traction:"})
    EXPECT_NE(all.find(kind), std::string::npos) << kind;
  EXPECT_TRUE(interrupted && debug);
  fs::remove_all(folder);
}

TEST(Fuzz, FailuresAreCountedByCause) {
  const Row a = row("wild_1", "exit code 5: step 3 (t = 0.125 s, dt = 0.005 s) failed: Newton stopped after 100 iterations with 2 N"),
            b = row("wild_2", "exit code 5: step 0 (t = 0 s, dt = 0.5 s) failed: Newton stopped after 20 iterations"),
            c = row("wild_3", "newton_iterations below 301: 970");
  EXPECT_EQ(causes({a, row("wild_4", ""), c, b}), "    2 a step fails: Newton stopped after : 1 2\n    1 newton_iterations below : 3\n");
}

}  // namespace
