#include "bench/harness.h"

#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "base/error.h"
#include "bench/benchmark.h"
#include "bench/reference.h"
#include "place.h"

using namespace mortise;
using namespace mortise::bench;

TEST(StudyHarness, RowsAreJsonWithExactlyTheseKeys) {
  Row row{"c", "gmcp_consistent", "gap", 1.5, 1, 0.5, 1e-8, 0.25, 7, 99, false, {}, 0.125};
  const auto j = nlohmann::ordered_json::parse(json_line(row));
  std::vector<std::string> keys;
  for (const auto& [key, v] : j.items()) keys.push_back(key);
  EXPECT_THAT(keys, testing::ElementsAre("case", "method", "quantity", "value", "reference", "error", "gate", "pass", "seconds", "cpu_seconds",
                                         "newton_iterations", "dofs"));
  EXPECT_EQ(j["pass"], false);
  EXPECT_EQ(j["cpu_seconds"], 0.125);
  EXPECT_EQ(j["newton_iterations"], 7);
  row.error = 1e-9;
  EXPECT_EQ(nlohmann::json::parse(json_line(row))["pass"], true);
  row.error = NAN;  // nothing was measured
  EXPECT_EQ(nlohmann::json::parse(json_line(row))["pass"], false);
  row.gate = NAN;
  EXPECT_TRUE(nlohmann::json::parse(json_line(row))["pass"].is_null());
  row.failed = true;
  EXPECT_EQ(nlohmann::json::parse(json_line(row))["pass"], false);
  const audit::Grade::Verdict a{"A", "every bound is met"}, b{"B", "stress_error is 0.07, more than 0.05"};
  row.as = {.all = b, .forces = a, .graded = {{"stress_error", 0.07}}};
  const auto graded = nlohmann::json::parse(json_line(row));
  EXPECT_EQ(graded["grade"], "B");
  EXPECT_EQ(graded["grade_reason"], b.reason);
  EXPECT_EQ(graded["grade_forces"], "A");
  EXPECT_EQ(graded["graded"]["stress_error"], 0.07);
}

TEST(StudyHarness, BarrierGapMatchesItsTable) {
  for (const auto& [ratio, t] : {std::pair{1e-4, .99424}, {1e-3, .98185}, {1e-2, .94338}, {.1, .82853}, {1., .53244}, {10., .12215}})
    EXPECT_NEAR(barrier_gap(ratio), t, 5e-6);
}

TEST(StudyHarness, HertzOfTheHandbook) {  // R 10 mm, E* 0.549451 MPa, a 1 mm
  const Hertz h = hertz(0.073260, 0.01, 0.549451e6);
  EXPECT_NEAR(h.a, 1e-3, 1e-8);
  EXPECT_NEAR(h.p0, 34979, 1);
  EXPECT_NEAR(h.pressure(0.6e-3), 0.8 * h.p0, 1);
  EXPECT_EQ(h.pressure(1.1e-3), 0);
}

TEST(StudyHarness, LineContactOfNafems) {  // CB-1: E* 57692 MPa, a 6.2146 mm, p0 3585.4 MPa
  const Hertz h = hertz_line(35e6, 0.05, 57692e6);
  EXPECT_NEAR(h.a, 6.2146e-3, 1e-7);
  EXPECT_NEAR(h.p0, 3585.4e6, 0.1e6);
}

TEST(StudyHarness, PunchesOfSneddon) {
  const double slope = 1 / std::tan(70.3 * std::numbers::pi / 180);
  EXPECT_NEAR(cone_force(slope, 1, 1), 1.7780, 1e-4);
  EXPECT_NEAR(cone_radius(slope, 1, cone_force(slope, 1, 1)), 2 / std::numbers::pi / slope, 1e-12);
  // Forces are the integrals of the pressures; the surface starts at the rim of the contact.
  double flat = 0, cone = 0;
  constexpr int n = 200000;
  for (int i = 0; i < n; ++i) {
    const double r = (i + 0.5) / n;
    flat += 2 * std::numbers::pi * r * flat_punch_pressure(3, 1, r) / n, cone += 2 * std::numbers::pi * r * cone_pressure(0.1, 2, 1, r) / n;
  }
  EXPECT_NEAR(flat, 3, 0.01);
  EXPECT_NEAR(cone_radius(0.1, 2, cone), 1, 1e-4);
  EXPECT_NEAR(flat_punch_surface(0.1, 0.1), 1, 1e-12);
  EXPECT_NEAR(cone_surface(0.1, 0.1), 1 - 2 / std::numbers::pi, 1e-12);
}

TEST(StudyHarness, PinOfPersson) {
  // E* D/Q at 60 degrees: b^2 = 1/3, (2 - 2/9 - ln(4/3))/(pi 4/9).
  EXPECT_NEAR(pin_half_angle((16.0 / 9 - std::log(4.0 / 3)) / (std::numbers::pi * 4 / 9)), std::numbers::pi / 3, 1e-12);
  // A small angle is Hertz's: a^2 = 4 Q R_e/(pi E*), R_e = R^2/D, E* half of one body's; p0 = 2Q/(pi a).
  const double small = pin_half_angle(1e4);
  EXPECT_NEAR(small, std::sqrt(8 / (std::numbers::pi * 1e4)), 1e-3 * small);
  EXPECT_NEAR(pin_pressure(small, 0), 2 / (std::numbers::pi * small), 1e-3 / small);
  for (const double half : {0.2, 1.0, 1.4}) {  // the vertical part of the pressure is the force
    double sum = 0;
    constexpr int n = 100000;
    for (int i = 0; i < n; ++i) {
      const double angle = half * (i + 0.5) / n;
      sum += 2 * pin_pressure(half, angle) * std::cos(angle) * half / n;
    }
    EXPECT_NEAR(sum, 1, 1e-5) << half;
    EXPECT_NEAR(pin_half_angle_of_moment(pin_moment(half)), half, 1e-9);
    EXPECT_EQ(pin_pressure(half, half), 0);
  }
}

TEST(StudyHarness, ShrinkFitOfLame) {
  EXPECT_NEAR(pressed_rings_pressure(1, 2, 2, 3, 0.01, 1000), 1.17188, 1e-5);
  EXPECT_NEAR(pressed_rings_pressure(1, 2, 2, 3, 0.01, 1000 / (1 - 0.09)), 1.28777, 1e-5);
}

TEST(StudyHarness, MethodsReplaceMortarContact) {
  for (const Method& m : methods()) {
    SceneText scene(benchmark_scene("patch"));
    scene.set("effects.mortar_contact.d_hat", 0.002);
    scene.use(m, 0.5);
    EXPECT_EQ(scene.number("effects." + m.effect + ".d_hat"), 0.002);
    if (m.effect == "mortar_contact") {
      EXPECT_EQ(scene.get("effects.mortar_contact.weights"), m.weights);
    } else {
      EXPECT_THROW(scene.get("effects.mortar_contact.d_hat"), std::exception);
    }
    if (m.weights == "classic") {
      EXPECT_DOUBLE_EQ(scene.number("effects.barrier_contact.stiffness"), 1e6 * 0.5 / (0.002 * 0.002));
    }
  }
}

TEST(StudyHarness, UnknownOptionsAreRefused) {
  const Benchmark& b = *find_benchmark("barrier");
  EXPECT_THROW(run_benchmark(b, {"sise=2"}, {}), Error);
  EXPECT_THROW(run_benchmark(b, {"methods=ipc"}, {}), Error);
  EXPECT_THROW(run_benchmark(b, {"effects.mortar_contact.d_hut=1"}, {}), Error);
  EXPECT_EQ(find_benchmark("barier"), nullptr);
}

TEST(StudyBenchmarks, EachHasADescription) {
  for (const Benchmark& b : benchmarks()) {
    const std::string folder = test_place::kSourceFolder + "/benchmarks/" + b.name;
    EXPECT_FALSE(benchmark_scene(b.name).empty());
    for (const char* file : {"/README.md", "/result.json"}) EXPECT_TRUE(std::ifstream(folder + file).good()) << folder << file;
  }
}

namespace {

void expect_gates(const char* name, const std::vector<std::string>& sets, int at_least) {
  int gated = 0;
  for (const Row& row : run_benchmark(*find_benchmark(name), sets, {})) {
    if (!row.gated()) continue;
    ++gated;
    EXPECT_TRUE(row.pass()) << table_line(row);
  }
  EXPECT_GE(gated, at_least);
}

}  // namespace

TEST(StudyBenchmarks, BarrierPasses) { expect_gates("barrier", {}, 18); }
TEST(StudyBenchmarks, PatchPasses) { expect_gates("patch", {"methods=gmcp_consistent"}, 40); }
TEST(StudyBenchmarks, FinerPatchPasses) {
  expect_gates("patch", {"methods=gmcp_consistent", "case=non-matching", "finer=2"}, 2);
  EXPECT_THROW(run_benchmark(*find_benchmark("patch"), {"case=none"}, {}), Error);
}
TEST(StudyBenchmarks, HertzLeavesFigures) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "mortise_hertz";
  std::filesystem::remove_all(folder);
  std::vector<std::string> notes;
  run_benchmark(*find_benchmark("hertz"), {"methods=gmcp_consistent", "size=tiny"},
                {{}, folder.string(), [&](const std::string& text) { notes.push_back(text); }});
  EXPECT_EQ(notes.size(), 3u);  // nodes, picture (or why there is none), profiles
  for (const char* file : {"pressure.svg", "tiny_gmcp_consistent.csv"}) EXPECT_TRUE(std::filesystem::exists(folder / file)) << file;
  EXPECT_EQ(std::filesystem::exists(folder / "tiny_gmcp_consistent.png"), notes.at(1).starts_with("written"));
  std::filesystem::remove_all(folder);
}
TEST(StudyBenchmarks, TowerPasses) { expect_gates("tower", {"methods=gmcp_consistent"}, 10); }
TEST(StudyBenchmarks, SlidePasses) { expect_gates("slide", {"methods=gmcp_consistent"}, 3); }
TEST(StudyBenchmarks, InterfacePasses) { expect_gates("interface", {"methods=gmcp_consistent"}, 5); }
TEST(StudyBenchmarks, LinePasses) { expect_gates("line", {"methods=gmcp_consistent"}, 4); }
TEST(StudyBenchmarks, LockingPasses) { expect_gates("locking", {"methods=linear_averaged,quadratic_averaged"}, 56); }
TEST(StudyBenchmarks, SpheresPass) { expect_gates("spheres", {"methods=gmcp_consistent"}, 6); }
TEST(StudyBenchmarks, PinPasses) { expect_gates("pin", {"methods=gmcp_consistent", "cells=20"}, 4); }
TEST(StudyBenchmarks, IndentPasses) { expect_gates("indent", {"methods=gmcp_consistent"}, 6); }
TEST(StudyBenchmarks, RingPasses) { expect_gates("ring", {"methods=gmcp_consistent"}, 4); }
TEST(StudyBenchmarks, PartitionPasses) { expect_gates("partition", {"methods=gmcp_consistent", "ratio=10"}, 24); }
TEST(StudyBenchmarks, SharpPasses) { expect_gates("sharp", {"methods=gmcp_consistent", "time.steps=10"}, 6); }
TEST(StudyBenchmarks, CoarseHertzPasses) { expect_gates("hertz", {"methods=gmcp_consistent"}, 4); }
// Newton's last iterations have the whole Jacobian, and none is wasted below rounding.
TEST(StudyBenchmarks, HertzEndsInFewIterationsAndInBalance) {
  int seen = 0;
  for (const Row& row : run_benchmark(*find_benchmark("hertz"), {"methods=gmcp_consistent", "size=small"}, {})) {
    if (row.quantity != "contact force") continue;
    ++seen;
    EXPECT_LE(row.error, 1e-12);
    EXPECT_LE(row.newton_iterations, 12);
  }
  EXPECT_EQ(seen, 1);
}
TEST(StudyBenchmarks, HertzWithTheLayerOfAScene) {
  for (const Row& row : run_benchmark(*find_benchmark("hertz"), {"size=tiny", "layer=auto"}, {})) EXPECT_FALSE(row.failed) << row.method;
}
TEST(StudyBenchmarks, CoarseHertzOnACylinderPasses) { expect_gates("hertz", {"methods=gmcp_consistent", "under=cylinder"}, 4); }
TEST(StudyBenchmarks, HertzRefusesSizesThatItDoesNotHave) {
  EXPECT_THROW(run_benchmark(*find_benchmark("hertz"), {"size=huge"}, {}), Error);
  EXPECT_THROW(run_benchmark(*find_benchmark("hertz"), {"under=pad"}, {}), Error);
  for (const char* wrong : {"k=abc", "k=-1", "layer=0", "d_hat=nan", "start=inf", "k=4x", "order=3"})
    EXPECT_THROW(run_benchmark(*find_benchmark("hertz"), {wrong}, {}), Error) << wrong;
  for (const char* wrong : {"finer=1.5", "finer=0", "case=none"})
    EXPECT_THROW(run_benchmark(*find_benchmark("locking"), {wrong}, {}), Error) << wrong;
}
// A wrong answer does not pass: with a guard that acts at this gap the barrier's identity no longer holds.
TEST(StudyBenchmarks, BarrierFailsWithAGuard) {
  bool failed = false;
  for (const Row& row : run_benchmark(*find_benchmark("barrier"), {"methods=gmcp_consistent", "effects.mortar_contact.guard=0.2"}, {}))
    failed |= !row.pass();
  EXPECT_TRUE(failed);
}
