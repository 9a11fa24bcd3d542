#include "study/study.h"

#include <gmock/gmock.h>

#include <fstream>

#include "base/error.h"
#include "bench/hertz/profiles.h"
#include "place.h"
#include "study/limit.h"
#include "study/scene_runs.h"

using namespace mortise;
using namespace mortise::study;

namespace {

Point point(const char* curve, double seconds, double error, const char* quantity = "q") {
  Point p;
  p.settings = {{"h", "1"}}, p.method = curve, p.quantity = quantity, p.seconds = seconds, p.error = error;
  return p;
}

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += what.size()) ++n;
  return n;
}

}  // namespace

TEST(Study, ParsesWhatIsVaried) {
  const Vary v = parse_vary("a.b=[1, 2],3 mm,{x: [4,5]}");
  EXPECT_EQ(v.key, "a.b");
  EXPECT_THAT(v.values, testing::ElementsAre("[1, 2]", "3 mm", "{x: [4,5]}"));
  for (const char* bad : {"a", "=1", "a=", "a=1,,2"}) EXPECT_THROW(parse_vary(bad), Error) << bad;
}

TEST(Study, FrontHoldsWhatNothingFasterBeats) {
  std::vector<Point> p{point("a", 1, 0.1),  point("a", 4, 0.01),     point("b", 2, 0.2),    point("b", 3, 0.05),
                       point("b", 5, 0.01), point("a", 9, 0.5, "r"), point("a", 0.5, 1e-9), point("a", 0.6, 1e-8)};
  p[6].reference = true;
  p[7].failed = true;
  mark_best(p);
  std::vector<int> best;
  for (std::size_t i = 0; i < p.size(); ++i)
    if (p[i].best) best.push_back(static_cast<int>(i));
  EXPECT_THAT(best, testing::ElementsAre(0, 1, 3, 5));
}

TEST(Study, FigureShowsCurvesFrontAndFailures) {
  std::vector<Point> p{point("a<b", 1, 0.1), point("a<b", 4, 0.01), point("c", 2, 0.2), point("c", 3, NAN), point("c", 3, 1, "other")};
  p[3].failed = true;
  mark_best(p);
  const std::string svg = figure_svg(p, "q", "t");
  EXPECT_EQ(count(svg, "<circle"), 3u + 2u);  // points and legend
  EXPECT_EQ(count(svg, "class=\"failed\""), 1u);
  EXPECT_EQ(count(svg, "<polyline"), 2u + 1u);
  EXPECT_EQ(count(svg, ">Pareto front<"), 1u);
  EXPECT_NE(svg.find("530.0,400.0 \""), std::string::npos) << svg;  // the front goes on to the right at its least error
  EXPECT_EQ(count(svg, "a<b"), 0u);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  // Down is more accurate, right is slower: 1 s and 0.1 lie on the corner of the decades 1..10 s and 0.01..1.
  EXPECT_NE(svg.find("<circle cx=\"80.0\" cy=\"220.0\""), std::string::npos) << svg;
}

// A bar of linear material under its end load: the energy is exact at any mesh, so all errors vanish against the right value ...
TEST(Study, RunsASceneAgainstAReference) {
  Study s{test_place::kSourceFolder + "/scenes/first/05_static_press.yaml",
          {"time.steps=1", "materials.gel.model=linear"},
          {parse_vary("bodies.block.shape.box.edge_length=10 mm,5 mm"), parse_vary("materials.gel.youngs_modulus=0.1 MPa,0.2 MPa")},
          {"elasticity/energy"},
          {}};
  // p^2 V/(2 E) = 25e6 Pa^2 * 4e-6 m^3 / (2 * 1e5 Pa)
  s.references = {5e-4};
  std::vector<Point> p = run_study(s, [](const Point&) {});
  ASSERT_EQ(p.size(), 4u);
  EXPECT_LT(p[0].error, 1e-9);
  EXPECT_LT(p[1].error, 1e-9);
  EXPECT_NEAR(p[2].error, 0.5, 1e-9);  // twice as stiff: half the energy
  EXPECT_EQ(p[2].curve(), "materials.gel.youngs_modulus=0.2 MPa");
  EXPECT_GT(p[1].dofs, p[0].dofs);
  // ... and without one the last of the ladder stands in.
  s.references.clear();
  p = run_study(s, [](const Point&) {});
  EXPECT_TRUE(p[1].reference);
  EXPECT_FALSE(p[0].reference || p[2].reference || p[3].reference);
  const std::string csv = points_csv(p);
  EXPECT_EQ(count(csv, "\n"), 5u);
  EXPECT_EQ(count(csv, ",reference,"), 1u);
  s.quantities = {"elasticity/enrgy"};
  EXPECT_THROW(run_study(s, [](const Point&) {}), Error);
}

TEST(Study, RunsABenchmarkMethodByMethod) {
  const Study s{"barrier",
                {"methods=gmcp_consistent,ipc_classic"},
                {parse_vary("effects.pressure_load.0.pressure=1000,2000")},
                {"p/kappa=1: gap (worst sample)"},
                {}};
  const std::vector<Point> p = run_study(s, [](const Point&) {});
  ASSERT_EQ(p.size(), 4u);
  EXPECT_EQ(p[0].curve(), "gmcp_consistent");
  EXPECT_LT(p[0].error, 1e-8);
  EXPECT_GT(p[1].error, 1e-2);
}

TEST(Study, ProfilesLieOverTheExactCurve) {
  const std::vector<bench::Panel> panels{{"one", {{"coarse", {{0, 1}, {0.5, 0.5}, {3, 1}}}}}, {"two", {{"coarse", {{1, 0}}}, {"fine", {{1, 0.2}}}}}};
  const std::string svg = bench::profiles_svg(
      panels, [](double x) { return 1 - x; }, "title", "r", "p", 1, 1);
  const auto count = [&](const std::string& what) {
    int n = 0;
    for (std::size_t at = svg.find(what); at != std::string::npos; at = svg.find(what, at + 1)) ++n;
    return n;
  };
  EXPECT_EQ(count("class=\"exact\""), 2);
  EXPECT_EQ(count("<circle"), 4 + 3);  // a dot beyond the end of the axis is left out; one per series explains it
  EXPECT_EQ(count(">two</text>"), 1);
  // The curve falls from the upper left to the lower right corner of the first panel: pixels grow along both axes.
  EXPECT_NE(svg.find("points=\"56.0,64.0 "), std::string::npos);
  EXPECT_NE(svg.find("388.0,264.0 \""), std::string::npos);
}

// Ladders are seldom even: a limit that takes them for even is 138 % off where 35 % is true.
TEST(Study, ReferenceIsTheLimitOfAnUnevenLadder) {
  const auto at = [](double h) { return 2 + std::pow(h, 1.5); };
  for (const std::vector<double>& h : {std::vector<double>{1, 0.5, 0.25}, {4, 3, 1}, {8, 2, 1.5, 1.25}}) {
    std::vector<double> values;
    for (double size : h) values.push_back(at(size));
    const Limit limit = limit_of(h, values);
    EXPECT_TRUE(limit.extrapolated);
    EXPECT_NEAR(limit.value, 2, 1e-10);
    EXPECT_EQ(limit.how, "extrapolated at an observed order of 1.5");
  }
  EXPECT_FALSE(limit_of({4, 2, 1}, {1, 2, 1.5}).extrapolated);  // oscillates
  EXPECT_EQ(limit_of({4, 2, 1}, {1, 2, 4}).value, 4);           // diverges
  EXPECT_FALSE(limit_of({4, 2, 1}, {1, 2, 2.9}).extrapolated);  // hardly converges
  EXPECT_EQ(limit_of({2, 1}, {1, 2}).value, 2);
  EXPECT_FALSE(limit_of({}, {3, 2.5, 2.25}).extrapolated);
}

TEST(Study, LaddersHaveSizes) {
  EXPECT_THAT(ladder_sizes({"2 mm", "1500 um", "1 mm"}), testing::Pointwise(testing::DoubleNear(1e-15), {2e-3, 1.5e-3, 1e-3}));
  EXPECT_THAT(ladder_sizes({"2", "4", "10"}), testing::Pointwise(testing::DoubleNear(1e-15), {0.5, 0.25, 0.1}));
  for (const std::vector<std::string>& none : {std::vector<std::string>{"a", "b"}, {"1 mm", "2 s"}, {"1", "3", "2"}, {"[1]", "[2]"}})
    EXPECT_TRUE(ladder_sizes(none).empty());
}

// Falling for 0.1 s whatever the step is, and never compared at different times.
TEST(Study, VariedTimeStepsEndTogether) {
  Study s{test_place::kSourceFolder + "/scenes/first/01_free_fall.yaml", {"time.step=5 ms", "time.steps=20"}, {}, {"gravity/energy"}, {}};
  const auto with = [&](const char* key, const char* value) { return overrides_of(s, {{key, value}}).back(); };
  EXPECT_EQ(with("time.step", "2.5 ms"), "time.steps=40");
  EXPECT_EQ(with("time.step", "5 ms"), "time.step=5 ms");
  EXPECT_THROW(with("time.step", "3 ms"), Error);
  EXPECT_THROW(with("time.steps", "10"), Error);
}
