// mortise study as a user runs it: killed, stopped, with runs that fail, with wrong quantities.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "process.h"

namespace mortise::cli {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
namespace fs = std::filesystem;

class StudyProgram : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
  std::string write(const std::string& text) const {
    std::ofstream(folder_ + "/s.yaml") << text;
    return folder_ + "/s.yaml";
  }
  std::string free_fall(const std::string& more = "") const {
    return write("mortise_study: 1\nscene: " + kSource +
                 "/scenes/first/01_free_fall.yaml\nset: [time.step=10 ms, time.steps=10]\nladders:\n  - {knob: time.step, values: [10 ms, 5 ms, 2.5 "
                 "ms, 1.25 ms]}\n" +
                 more);
  }
  pid_t start(const std::vector<std::string>& arguments) const {
    return cli::start(arguments, [this] {
      for (const auto& [name, fd] : {std::pair{"/out.txt", 1}, {"/err.txt", 2}})
        dup2(open((folder_ + name).c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644), fd);
    });
  }
  int run(const std::vector<std::string>& arguments) const { return wait_for(start(arguments)); }
  std::string said() const { return read_text(folder_ + "/out.txt"); }
  std::string complained() const { return read_text(folder_ + "/err.txt"); }
  std::string file(const std::string& name) const { return read_text(folder_ + "/" + name); }
  nlohmann::json json(const std::string& name) const { return nlohmann::json::parse(file(name)); }
  // Of every run its settings and value.
  std::string values(const std::string& out) const {
    std::string text;
    for (const auto& r : json(out + "/study.json")["runs"]) text += r["label"].get<std::string>() + " " + r["values"].dump() + "\n";
    return text;
  }
  const std::string folder_ = (fs::temp_directory_path() / ("mortise_study_cli_" + std::to_string(getpid()))).string();
};

// Backward Euler falls too far by g t dt / 2: first order, a limit of g t^2 / 2 = 49.05 mm, and every error is known.
TEST_F(StudyProgram, FindsOrderLimitAndErrorsOfAFall) {
  const std::string study = free_fall("quantities:\n  - {name: fall, value: displacement, body: box, over: mean, axis: z}\n");
  ASSERT_EQ(run({"study", study, "-o", folder_ + "/a"}), 0) << complained();
  const auto q = json("a/study.json")["quantities"][0];
  EXPECT_NEAR(q["reference"]["value"].get<double>(), -9.81 * 0.01 / 2, 1e-7);
  EXPECT_NEAR(q["error_shares"][0]["observed_order"].get<double>(), 1, 1e-3);
  EXPECT_NEAR(q["error_shares"][0]["error"].get<double>(), 0.1, 1e-4);  // dt / t
  EXPECT_THAT(said(), HasSubstr("as it is: -0.053955, error 10 %"));
  EXPECT_THAT(file("a/study.html"), HasSubstr("</svg>"));
  EXPECT_EQ(file("a/work_precision.png").substr(1, 3), "PNG");
  // The scene of the knee runs, and is written like any other: nothing of the study is left in it.
  EXPECT_THAT(file("a/recommended.yaml"), Not(HasSubstr("precision: double")));
  EXPECT_EQ(run({"run", folder_ + "/a/recommended.yaml", "-o", folder_ + "/recommended", "--no-render"}), 0) << complained();
}

TEST_F(StudyProgram, AFinishedRunIsNeverRunAgain) {
  const std::string study = free_fall("quantities: [gravity/energy]\n");
  ASSERT_EQ(run({"study", study, "-o", folder_ + "/a"}), 0) << complained();
  EXPECT_THAT(complained(), Not(HasSubstr("before")));
  const std::string first = file("a/points.csv");
  ASSERT_EQ(run({"study", study, "-o", folder_ + "/a"}), 0);
  EXPECT_THAT(complained(), HasSubstr("4/4"));
  EXPECT_THAT(complained(), HasSubstr("(before)"));
  EXPECT_EQ(file("a/points.csv"), first);
  // Another study does not take the place of this one unasked; one that asks for more goes on with its runs.
  std::ofstream(study, std::ios::app) << "  # the same\nrepeat: 1\n";
  EXPECT_EQ(run({"study", study, "-o", folder_ + "/a", "--set", "time.steps=20"}), 2);
  EXPECT_THAT(complained(), HasSubstr("holds another study"));
  EXPECT_EQ(file("a/points.csv"), first);
  ASSERT_EQ(run({"study", study, "-o", folder_ + "/a", "--set", "time.steps=20", "--overwrite"}), 0) << complained();
  EXPECT_THAT(complained(), Not(HasSubstr("before")));
  const std::string scene = kSource + "/scenes/first/01_free_fall.yaml";
  const auto ladder = [&](const std::string& steps) {
    return run({"study", scene, "--vary", "time.step=" + steps, "--qoi", "gravity/energy", "-o", folder_ + "/b"});
  };
  ASSERT_EQ(ladder("10 ms,5 ms,2.5 ms"), 0) << complained();
  EXPECT_EQ(ladder("20 ms,10 ms,5 ms"), 2);
  EXPECT_EQ(ladder("20 ms,10 ms,5 ms,2.5 ms"), 0) << complained();
}

// Killed at random, study and runs alike, it ends with the values of a study that nobody killed.
TEST_F(StudyProgram, KilledItEndsWithEqualResults) {
  const std::string study = free_fall("quantities: [gravity/energy, {value: steps/newton_iterations, when: sum}]\n");
  ASSERT_EQ(run({"study", study, "-o", folder_ + "/whole"}), 0) << complained();
  std::mt19937 dice(7);
  int killed = 0;
  for (int i = 0; i < 8; ++i) {
    const pid_t child = start({"study", study, "-o", folder_ + "/killed"});
    std::this_thread::sleep_for(std::chrono::milliseconds(10 + dice() % 120));
    kill(child, i % 3 == 2 ? SIGTERM : SIGKILL);
    const int code = wait_for(child);
    killed += code > 128 || code == 75;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));  // its runs die with it
  }
  EXPECT_GT(killed, 2);
  ASSERT_EQ(run({"study", study, "-o", folder_ + "/killed"}), 0) << complained();
  EXPECT_EQ(values("whole"), values("killed"));
}

TEST_F(StudyProgram, GoesOnWhenARunFails) {
  const std::string study = write("mortise_study: 1\nscene: " + kSource +
                                  "/scenes/first/03_incline_friction.yaml\nset: [time.steps=5]\nquantities: [inertia/kinetic_energy]\n"
                                  "ladders:\n  - {name: newton, knobs: {solver.iterations: [1, 50, 100], solver.halvings: [0, 4, 4]}}\n");
  ASSERT_EQ(run({"study", study, "-o", folder_ + "/a"}), 0) << complained();
  EXPECT_THAT(said(), HasSubstr("failed: "));
  EXPECT_THAT(file("a/points.csv"), HasSubstr(",failed,"));
  EXPECT_THAT(file("a/work_precision.svg"), HasSubstr(">failed</text>"));
  ASSERT_EQ(run({"study", kSource + "/scenes/first/03_incline_friction.yaml", "--set", "time.steps=5", "--set", "solver.halvings=0", "--vary",
                 "solver.iterations=1", "--qoi", "inertia/kinetic_energy", "-o", folder_ + "/b"}),
            5);
  EXPECT_THAT(complained(), HasSubstr("every run failed, the first with: "));
}

// A disk that is full (here: files may not grow) says nothing about the settings: no cross, and the same command goes on.
TEST_F(StudyProgram, AFullDiskEndsTheStudy) {
  const std::string study = free_fall("quantities: [gravity/energy]\n");
  const pid_t child = cli::start({"study", study, "-o", folder_ + "/a"}, [this] {
    dup2(open((folder_ + "/err.txt").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644), 2);
    const rlimit most{20000, 20000};
    setrlimit(RLIMIT_FSIZE, &most);
  });
  EXPECT_EQ(wait_for(child), 6);
  EXPECT_THAT(complained(), HasSubstr("a run could not be written: "));
  EXPECT_THAT(complained(), HasSubstr("the same command goes on"));
  EXPECT_EQ(run({"study", study, "-o", folder_ + "/a"}), 0) << complained();
}

TEST_F(StudyProgram, ARunTakesNoLongerThanItMay) {
  const std::string study =
      write("mortise_study: 1\nscene: " + kSource +
            "/scenes/first/04_two_bodies.yaml\nset: [time.steps=2]\nlimit: 2 s\nquantities: [supports/stamp]\nplan: combinations\n"
            "ladders:\n  - {knob: bodies.ball.shape.sphere.edge_length, values: [4 mm, 0.7 mm]}\n");
  ASSERT_EQ(run({"study", study, "-o", folder_ + "/a"}), 0) << complained();
  EXPECT_THAT(said(), HasSubstr("failed: took more than 2 s of CPU time in its steps"));
}

// A limit is of what the tables show, to the digit: it was one of whole seconds, and of meshing and files too.
TEST_F(StudyProgram, LimitsAreOfTheSteps) {
  const auto limited = [&](const std::string& limit) {
    const std::string study =
        write("mortise_study: 1\nscene: " + kSource + "/scenes/first/04_two_bodies.yaml\nset: [time.steps=2]\nlimit: " + limit +
              "\nquantities: [supports/stamp]\nplan: combinations\nladders:\n  - {knob: solver.linear, values: [direct, cg]}\n");
    return run({"study", study, "-o", folder_ + "/a"});
  };
  EXPECT_EQ(limited("1 ms"), 5) << said();
  EXPECT_THAT(complained(), HasSubstr("took more than 0.001 s of CPU time in its steps: 0."));
  EXPECT_EQ(limited("60 s"), 0) << complained();
  EXPECT_THAT(complained(), HasSubstr("(before)")) << "what had ended is not run again";
}

TEST_F(StudyProgram, EffectsAreSwitchedOffInTurn) {
  ASSERT_EQ(run({"study", kSource + "/scenes/first/03_incline_friction.yaml", "--set", "time.steps=20", "--effects", "--qoi",
                 "{value: displacement, body: block, over: mean, axis: x}", "--qoi", "barrier_contact/force_block_z", "-o", folder_ + "/a"}),
            0)
      << complained();
  // A step of implicit Euler with g sin(20 deg) instead of g (sin(20 deg) - mu cos(20 deg)): 2.22 times as far.
  EXPECT_THAT(said(), testing::ContainsRegex("friction +[0-9.e-]+ s +-?[0-9]+ % +\\+1[12][0-9] %"));
  EXPECT_THAT(said(), testing::ContainsRegex("barrier_contact and friction .* gone"));
  EXPECT_THAT(said(), testing::ContainsRegex("inertia +cannot be left out: "));
  EXPECT_THAT(file("a/effects.csv"), HasSubstr("\"inertia\",,,,"));
}

// A linear block under pressure sinks by p h / E: 1 % more of E is 1 % less, and of p 1 % more.
TEST_F(StudyProgram, TellsWhatAQuantityHangsOn) {
  const std::string scene = kSource + "/scenes/first/05_static_press.yaml",
                    sinks = "{name: top, value: displacement, body: block, over: min, axis: z}";
  ASSERT_EQ(run({"study", scene, "--sensitivity", "materials.gel.youngs_modulus", "--sensitivity", "effects.pressure_load.0.pressure", "--qoi", sinks,
                 "--qoi", "steps/newton_iterations", "-o", folder_ + "/a"}),
            0)
      << complained();
  EXPECT_THAT(said(), HasSubstr("top = -0.0005\n"));
  EXPECT_THAT(said(), testing::ContainsRegex("materials.gel.youngs_modulus +100000 +5e-09 +\\+1 %"));
  EXPECT_THAT(said(), testing::ContainsRegex("effects.pressure_load.0.pressure.value +all of it +- +-1 %"));
  EXPECT_THAT(said(), testing::ContainsRegex("materials.gel.youngs_modulus +is not followed"));  // counts of iterations
  EXPECT_THAT(file("a/sensitivity.csv"), testing::ContainsRegex("\"top\",-0.0005[0-9]*,\"materials.gel.youngs_modulus\",100000,"));
  EXPECT_FALSE(fs::exists(folder_ + "/a/runs/sensitivity.vtkhdf")) << "what was only measured";
  const auto error = [&](const std::string& path, const std::string& more = "time.steps=5") {
    EXPECT_EQ(run({"study", scene, "--set", more, "--sensitivity", path, "--qoi", sinks, "-o", folder_ + "/b"}), 2) << path;
    return complained();
  };
  EXPECT_THAT(error("materials.gel.youngs_modulu"), HasSubstr("has no 'youngs_modulu' under materials.gel\n  did you mean 'youngs_modulus'?"));
  EXPECT_THAT(error("time.steps"), HasSubstr("'time.steps' is a count"));
  EXPECT_THAT(error("materials.gel"), HasSubstr("'materials.gel' is a block: derivatives are with respect to numbers; it has model, "));
  EXPECT_THAT(error("materials.gel.poisson_ratio", "materials.gel.poisson_ratio=0"), HasSubstr("is 0, of which no share can be changed"));
  // What is no smooth matter is told, and the others are found.
  ASSERT_EQ(
      run({"study", scene, "--sensitivity", "all", "--sensitivity", "bodies.block.shape.box.edge_length", "--qoi", sinks, "-o", folder_ + "/c"}), 0)
      << complained();
  EXPECT_THAT(said(), HasSubstr("materials.gel.poisson_ratio"));
}

// E A travel / L = 2 N without the gap that contact leaves; a uniform stress needs no finer mesh.
TEST_F(StudyProgram, TellsWhereAnErrorComesFrom) {
  const std::string patch = kSource + "/benchmarks/effectivity/patch.yaml";
  ASSERT_EQ(run({"study", patch, "--error-budget", "--qoi", "supports/plate_z", "--qoi", "{value: contact_pressure, body: block, over: max}", "-o",
                 folder_ + "/a"}),
            0)
      << complained();
  const auto j = json("a/error_budget.json")["quantities"];
  EXPECT_NEAR(j[0]["value"].get<double>() + j[0]["error"].get<double>(), -2, 0.01);
  EXPECT_NEAR(j[0]["parts"][0]["error"].get<double>(), 0, 1e-6);
  EXPECT_GT(j[0]["parts"][1]["error"].get<double>(), 0.3);
  EXPECT_FALSE(j[0]["complete"]) << "facets are not estimated";
  // A pressure has no gradient, but scenes that go beside the run: 2 N over 4 cm^2.
  EXPECT_THAT(j[1]["parts"][0]["why_not"], HasSubstr("how far the surface's own elements resolve a pressure"));
  EXPECT_NEAR(j[1]["value"].get<double>() + j[1]["error"].get<double>(), 5000, 150);
  EXPECT_GT(j[1]["value"].get<double>(), 5500);
  EXPECT_THAT(said(), HasSubstr("not estimated: not reliable: how far the surface"));
  // Linear elements are too stiff in bending: quadratic ones of half the size sink by 0.26375 mm. What is found of meshes that are too coarse is too
  // little (0.57 of the true error), and kept back.
  const auto beam_with = [&](const std::string& where, const std::vector<std::string>& sets) {
    std::vector<std::string> all{"study",
                                 kSource + "/benchmarks/effectivity/beam.yaml",
                                 "--error-budget",
                                 "--overwrite",
                                 "--qoi",
                                 "{value: displacement, body: beam, point: [" + where + ", 0, 0], axis: z}",
                                 "-o",
                                 folder_ + "/d"};
    for (const std::string& s : sets) all.insert(all.end(), {"--set", s});
    EXPECT_EQ(run(all), 0) << complained();
    return json("d/error_budget.json")["quantities"][0];
  };
  const auto beam = [&](const std::string& edge, const std::string& nu) {
    return beam_with("40 mm", {"bodies.beam.shape.box.edge_length=" + edge, "materials.rubber.poisson_ratio=" + nu});
  };
  const auto fine = beam("1.667 mm", "0.3"), coarse = beam("5 mm", "0.3");
  const double missing = -0.26375e-3 - fine["value"].get<double>();
  EXPECT_NEAR(fine["error"].get<double>() / missing, 0.89, 0.05);
  EXPECT_TRUE(coarse["parts"][0]["error"].is_null());
  EXPECT_THAT(coarse["parts"][0]["why_not"], HasSubstr("not reliable: the mesh is too coarse"));
  EXPECT_THAT(said(), HasSubstr("not reliable"));
  // Where volumes are averaged (quadratic elements of 1.25 mm: 0.25986 and 0.25809 mm).
  for (const auto& [nu, sinks] : {std::pair("0.45", -0.25986e-3), std::pair("0.49", -0.25809e-3)}) {
    const auto averaged = beam("1.667 mm", nu);
    EXPECT_NEAR(averaged["error"].get<double>() / (sinks - averaged["value"].get<double>()), 1.04, 0.03) << nu;
  }
  // Half of the beam held fast: those elements have no free node, and no stress either. A thin one between what holds its faces has nothing else.
  const auto held = [&](const std::string& more) {
    return beam_with("39 mm",
                     {"effects.pin=[{body: beam, where: {box: {min: [-1 mm, -6 mm, -6 mm], max: [20.1 mm, 6 mm, 6 mm]}}}" + more})["parts"][0];
  };
  const auto half = held("]");
  EXPECT_TRUE(half["error"].is_number() || half["why_not"].get<std::string>().starts_with("not reliable")) << half;
  EXPECT_THAT(
      held(", {body: beam, where: {box: {min: [22.4 mm, -6 mm, -6 mm], max: [22.6 mm, 6 mm, 6 mm]}}, motion: {time: [0, 1], translation: [[0, 0, "
           "0], [0, 0, -0.1 mm]]}}]")["why_not"],
      HasSubstr("elements that have no free node"));
  // Without --qoi it is the scene's own.
  ASSERT_EQ(run({"study", patch, "--error-budget", "-o", folder_ + "/e"}), 0) << complained();
  EXPECT_EQ(json("e/error_budget.json")["quantities"][0]["quantity"], "force on the plate");
  // Friction over several load steps: the gap as of one without friction; the mesh, as stresses vary where friction holds (quadratic elements of half
  // the size: 2.6511 N).
  ASSERT_EQ(run({"study", patch, "--error-budget", "--qoi", "supports/plate_z", "--set", "time.steps=3", "--set",
                 "effects.friction={follows: mortar_contact, mu: 0.3}", "-o", folder_ + "/b"}),
            0)
      << complained();
  const auto path = json("b/error_budget.json")["quantities"][0];
  EXPECT_NEAR(path["parts"][0]["error"].get<double>() / (-2.6511 - path["value"].get<double>()), 0.9, 0.15);
  EXPECT_NEAR(path["error"].get<double>() - path["parts"][0]["error"].get<double>(), j[0]["error"].get<double>(), 0.05);
  ASSERT_EQ(run({"study", patch, "--error-budget", "--qoi", "supports/plate_z", "--set", "materials.gel.poisson_ratio=0.45", "-o", folder_ + "/c"}),
            0);
  EXPECT_NEAR(json("c/error_budget.json")["quantities"][0]["parts"][0]["error"].get<double>(), 0, 1e-6);
}

// z = - g t^2 / 2 of what falls, and no parts where there is nothing to be wrong in; numbers of the whole way too.
TEST_F(StudyProgram, TellsWhatTimeStepsDo) {
  const std::string scene = write(R"(
mortise: 1
time: {step: 5 ms, steps: 20}
materials: {wood: {density: 700}}
bodies:
  cube: {type: stiff, shape: {box: {size: [20 mm, 20 mm, 20 mm], edge_length: 20 mm}}, material: wood}
effects:
  inertia: {}
  gravity: {}
  affine_body: {}
)");
  ASSERT_EQ(run({"study", scene, "--error-budget", "--qoi", "{name: end, value: displacement, body: cube, over: min, axis: z}", "--qoi",
                 "{name: mean, value: displacement, body: cube, over: min, axis: z, when: mean}", "-o", folder_ + "/f"}),
            0)
      << complained();
  const auto j = json("f/error_budget.json")["quantities"];
  for (int k : {0, 1}) {
    ASSERT_EQ(j[k]["parts"].size(), 3u) << j[k];
    EXPECT_EQ(j[k]["parts"][1]["source"], "length of time steps");
    EXPECT_EQ(j[k]["parts"][0]["why_not"], "the scene has no soft bodies");
  }
  EXPECT_NEAR(j[0]["value"].get<double>() + j[0]["error"].get<double>(), -9.81 * 0.1 * 0.1 / 2, 1e-7);
  EXPECT_GT(j[0]["error"].get<double>(), 2e-3);
  EXPECT_NEAR(j[1]["value"].get<double>() + j[1]["error"].get<double>(), -9.81 * 0.1 * 0.1 / 6, 1e-4) << "but for what trapezoids make of a mean";
  EXPECT_THAT(said(), HasSubstr("estimates included"));
  // What it lands on: a blow is higher than steps see, and when it comes within a step is not told.
  ASSERT_EQ(run({"study", scene, "--error-budget", "--set", "bodies.floor={type: half_space, point: [0, 0, -20 mm]}", "--set",
                 "effects.barrier_contact={}", "--qoi", "{name: blow, value: barrier_contact/force_cube_z, when: largest}", "--qoi",
                 "steps/newton_iterations", "--qoi", "{value: inertia/kinetic_energy, at: 1 s}", "-o", folder_ + "/g"}),
            0)
      << complained();
  const auto blow = json("g/error_budget.json");
  EXPECT_THAT(blow["note"], HasSubstr("bodies touch or let go in 1 of 20 steps"));
  EXPECT_EQ(blow["quantities"][0]["parts"][1]["source"], "what lies between steps");
  EXPECT_THAT(blow["quantities"][0]["parts"][1]["why_not"], HasSubstr("not reliable: between steps it may be"));
  EXPECT_THAT(blow["quantities"][1]["why_not"], HasSubstr("are not followed"));
  EXPECT_THAT(blow["quantities"][2]["why_not"], HasSubstr("it has no value"));
  EXPECT_EQ(run({"study", scene, "--error-budget", "--dry-run", "--qoi", "joint/x"}), 2) << "it would run";
}

// What is planned does not fit; what is run, setup included, does.
TEST_F(StudyProgram, StaysWithinItsBudget) {
  const std::string study = write("mortise_study: 1\nscene: " + kSource +
                                  "/scenes/first/04_two_bodies.yaml\nset: [time.steps=10]\nquantities: [supports/stamp]\nladders:\n"
                                  "  - {name: step, knob: time.step, values: [4 ms, 2 ms, 1 ms, 0.5 ms]}\n"
                                  "  - {name: d_hat, knob: effects.barrier_contact.d_hat, values: [0.2 mm, 0.1 mm, 0.05 mm]}\n"
                                  "  - {name: mesh, knob: bodies.ball.shape.sphere.edge_length, values: [4 mm, 2.5 mm, 1.2 mm, 0.8 mm]}\n");
  ASSERT_EQ(run({"study", study, "-o", folder_ + "/a", "--budget", "12 s"}), 0) << complained();
  const auto j = json("a/study.json");
  double spent = 0;
  std::map<std::string, double> runs;
  for (const auto& r : j["runs"])
    if (r["id"] != "") runs[r["id"]] = r["cpu_seconds_of_processes"];
  for (const auto& [id, seconds] : runs) spent += seconds;
  EXPECT_LT(spent, 13);
  EXPECT_GT(spent, 2);
  EXPECT_THAT(said(), HasSubstr("not run: the budget was spent"));
  EXPECT_THAT(said(), HasSubstr("of CPU time, "));
}

// Ladders that a slow or loaded machine climbs within the budget too.
TEST_F(StudyProgram, WhatIsLeftOfTheBudgetTurnsKnobsTogether) {
  const std::string study = write("mortise_study: 1\nscene: " + kSource +
                                  "/scenes/first/04_two_bodies.yaml\nset: [time.steps=4, bodies.ball.shape.sphere.edge_length=5 mm]\n"
                                  "quantities: [supports/stamp]\nladders:\n"
                                  "  - {name: step, knob: time.step, values: [4 ms, 2 ms, 1 ms]}\n"
                                  "  - {name: d_hat, knob: effects.barrier_contact.d_hat, values: [0.4 mm, 0.2 mm, 0.1 mm]}\n");
  ASSERT_EQ(run({"study", study, "-o", folder_ + "/a", "--budget", "60 s"}), 0) << complained();
  EXPECT_THAT(said(), HasSubstr("knobs together"));
}

TEST_F(StudyProgram, WrongQuantitiesSayWhatThereIs) {
  const auto error = [&](const std::string& quantity) {
    EXPECT_EQ(run({"study", free_fall("quantities:\n  - " + quantity + "\n"), "-o", folder_ + "/a"}), 2);
    return complained();
  };
  EXPECT_THAT(error("inertia/kinetic_enrgy"),
              testing::AllOf(HasSubstr("s.yaml:7:5: error:"), HasSubstr("did you mean 'inertia/kinetic_energy'?"), HasSubstr("inertia/momentum_x")));
  EXPECT_THAT(error("steps/newton"), HasSubstr("steps/newton_iterations"));
  EXPECT_THAT(error("{value: velocty, body: box, over: max}"), HasSubstr("did you mean 'velocity'?"));
  EXPECT_THAT(error("{value: velocity, body: bx, over: max}"), HasSubstr("no body 'bx' has points"));
  EXPECT_EQ(run({"study", free_fall("quantities: [gravity/energy]\n"), "--vary", "time.step=1 ms"}), 2);
}

}  // namespace
}  // namespace mortise::cli
