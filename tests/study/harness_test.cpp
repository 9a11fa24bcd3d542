#include "study/harness.h"

#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "study/benchmark.h"
#include "study/reference.h"

using namespace mortise;
using namespace mortise::study;

TEST(StudyHarness, RowsAreJsonWithExactlyTheseKeys) {
  Row row{"c", "gmcp_consistent", "gap", 1.5, 1, 0.5, 1e-8, 0.25, 7, 99, false};
  const auto j = nlohmann::ordered_json::parse(json_line(row));
  std::vector<std::string> keys;
  for (const auto& [key, v] : j.items()) keys.push_back(key);
  EXPECT_THAT(keys, testing::ElementsAre("case", "method", "quantity", "value", "reference", "error", "gate", "pass", "seconds", "newton_iterations", "dofs"));
  EXPECT_EQ(j["pass"], false);
  EXPECT_EQ(j["newton_iterations"], 7);
  row.error = 1e-9;
  EXPECT_EQ(nlohmann::json::parse(json_line(row))["pass"], true);
  row.error = NAN;  // nothing was measured
  EXPECT_EQ(nlohmann::json::parse(json_line(row))["pass"], false);
  row.gate = NAN;
  EXPECT_TRUE(nlohmann::json::parse(json_line(row))["pass"].is_null());
  row.failed = true;
  EXPECT_EQ(nlohmann::json::parse(json_line(row))["pass"], false);
}

TEST(StudyHarness, BarrierGapMatchesItsTable) {  // reference/accuracy.md, B27
  for (const auto& [ratio, t] : {std::pair{1e-4, .99424}, {1e-3, .98185}, {1e-2, .94338}, {.1, .82853}, {1., .53244}, {10., .12215}}) EXPECT_NEAR(barrier_gap(ratio), t, 5e-6);
}

TEST(StudyHarness, HertzOfTheHandbook) {  // R 10 mm, E* 0.549451 MPa, a 1 mm (reference/gmcp.md 3.4)
  const Hertz h = hertz(0.073260, 0.01, 0.549451e6);
  EXPECT_NEAR(h.a, 1e-3, 1e-8);
  EXPECT_NEAR(h.p0, 34979, 1);
  EXPECT_NEAR(h.pressure(0.6e-3), 0.8 * h.p0, 1);
  EXPECT_EQ(h.pressure(1.1e-3), 0);
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
    const std::string folder = std::string(MORTISE_SOURCE_DIR) + "/benchmarks/" + b.name;
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
TEST(StudyBenchmarks, TowerPasses) { expect_gates("tower", {"methods=gmcp_consistent"}, 10); }
TEST(StudyBenchmarks, SlidePasses) { expect_gates("slide", {"methods=gmcp_consistent"}, 3); }
TEST(StudyBenchmarks, CoarseHertzPasses) { expect_gates("hertz", {"methods=gmcp_consistent"}, 4); }
// A wrong answer does not pass: with a guard that acts at this gap the barrier's identity no longer holds.
TEST(StudyBenchmarks, BarrierFailsWithAGuard) {
  bool failed = false;
  for (const Row& row : run_benchmark(*find_benchmark("barrier"), {"methods=gmcp_consistent", "effects.mortar_contact.guard=0.2"}, {})) failed |= !row.pass();
  EXPECT_TRUE(failed);
}
