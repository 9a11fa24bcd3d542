// Errors, fronts, knees and figures of results that are made up.
#include "study/compare.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <filesystem>

#include "bench/hertz/profiles.h"
#include "render/image.h"
#include "study/axis.h"
#include "study/canvas.h"
#include "study/corrections.h"
#include "study/figure.h"
#include "study/greedy.h"
#include "study/read.h"
#include "study/report.h"
#include "study/run_study.h"

using namespace mortise;
using namespace mortise::study;
using testing::ElementsAre;
using testing::HasSubstr;

namespace {

Point point(const char* curve, double seconds, double error, std::size_t quantity = 0) {
  Point p;
  p.curve = p.label = curve, p.quantity = quantity, p.seconds = p.slowest = seconds, p.error = error, p.value = 1 + error;
  return p;
}

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += what.size()) ++n;
  return n;
}

std::vector<int> marked(const std::vector<Point>& p, bool Point::*mark) {
  std::vector<int> out;
  for (std::size_t i = 0; i < p.size(); ++i)
    if (p[i].*mark) out.push_back(static_cast<int>(i));
  return out;
}

// Two knobs: q = 3 + 2 h + 5 t^2, one at a time from h = 1/2, t = 1/2; runs take 1/(h t) seconds.
struct TwoKnobs {
  Plan plan;
  Results results;

  TwoKnobs() {
    Study& s = results.study;
    s.one_at_a_time = true, s.methods.emplace_back(), s.quantities.resize(1), s.quantities[0].name = "q";
    for (const char* name : {"h", "t"})
      s.ladders.push_back({name, {{{{name, "1"}}, "1"}, {{{name, "0.5"}}, "0.5"}, {{{name, "0.25"}}, "0.25"}}, {1, 0.5, 0.25}, {}});
    plan.base = {run(0.5, 0.5)};
    plan.runs.back().label = "as it is";
    for (std::size_t l = 0; l < 2; ++l) {
      plan.curves.push_back({s.ladders[l].name, 0, l, {}});
      for (double size : {1.0, 0.5, 0.25}) plan.curves[l].runs.push_back(l == 0 ? run(size, 0.5) : run(0.5, size));
    }
  }
  std::size_t run(double h, double t) {
    RunResult r;
    r.id = "run", r.seconds = r.slowest = 1 / (h * t), r.values = {3 + 2 * h + 5 * t * t}, r.dofs = static_cast<long>(1000 / (h * t));
    results.runs.push_back(r), plan.runs.push_back({0, {}, "run", {}});
    return results.runs.size() - 1;
  }
};

}  // namespace

TEST(Compare, FrontHoldsWhatNothingFasterBeats) {
  std::vector<Point> p{point("a", 1, 0.1),  point("a", 4, 0.01),   point("b", 2, 0.2),    point("b", 3, 0.05),
                       point("b", 5, 0.01), point("a", 9, 0.5, 1), point("a", 0.5, 1e-9), point("a", 0.6, 1e-8)};
  p[6].reference = true;
  p[7].failed = true;
  mark_best(p, {Reference{1, 0}, Reference{1, 0}});
  EXPECT_THAT(marked(p, &Point::best), ElementsAre(0, 1, 3, 5));
  // Below what the reference is known to nothing is better: 0.05 in 3 s is as good as 0.01 in 4 s.
  mark_best(p, {Reference{1, 0.06}, Reference{1, 0}});
  EXPECT_THAT(marked(p, &Point::best), ElementsAre(0, 3, 5));
}

TEST(Compare, TheKneeIsWhereTheFrontBends) {
  std::vector<Point> bent{point("a", 1, 1), point("a", 2, 0.1), point("a", 4, 0.01), point("a", 40, 0.007), point("a", 400, 0.005)};
  mark_best(bent, {Reference{1, 0}});
  EXPECT_THAT(marked(bent, &Point::knee), ElementsAre(2));
  std::vector<Point> straight{point("a", 1, 1), point("a", 2, 0.5), point("a", 4, 0.25)};
  mark_best(straight, {Reference{1, 0}});
  EXPECT_THAT(marked(straight, &Point::knee), ElementsAre(1));
}

TEST(Compare, TimesAtTheSameErrorAreNeverExtrapolated) {
  const std::vector<Point> p{point("a", 1, 0.1), point("a", 10, 0.001)};
  const std::vector<const Point*> curve{&p[0], &p[1]};
  EXPECT_NEAR(time_at(curve, 0.01), std::sqrt(10.0), 1e-12);
  EXPECT_NEAR(time_at(curve, 0.1), 1, 1e-12);
  EXPECT_TRUE(std::isnan(time_at(curve, 0.2)));
  EXPECT_TRUE(std::isnan(time_at(curve, 1e-4)));
}

TEST(Compare, ErrorsOfKnobsAddUp) {
  TwoKnobs k;
  compare(k.plan, nullptr, k.results);
  const Reference& ref = k.results.references[0];
  EXPECT_NEAR(ref.value, 3, 1e-9);  // though no run comes near to it: 4.5 and 4.56 are the nearest
  // Of both limits, and as there was no joint run, the product of the changes by h and t.
  EXPECT_NEAR(ref.uncertainty, 1.25 * (0.5 + 0.3125) + 1 * 1.25 / 5.25, 1e-6);
  EXPECT_THAT(ref.how,
              testing::AllOf(HasSubstr("h: extrapolated at an observed order of 1"), HasSubstr("t: extrapolated at an observed order of 2")));
  ASSERT_EQ(k.results.shares.size(), 2u);
  EXPECT_NEAR(k.results.shares[0].error, 1.0 / 3, 1e-9);
  EXPECT_NEAR(k.results.shares[1].error, 1.25 / 3, 1e-9);
  EXPECT_NEAR(k.results.points[0].error, 2.25 / 3, 1e-9);  // as it is
  EXPECT_EQ(k.results.points[0].cancel, "");
  const std::string said = testing::PrintToString(findings(k.results));
  EXPECT_THAT(said, HasSubstr("h 33.3 % (44 %), t 41.7 % (56 %)"));
}

// Runs that differ more and more have no limit: the finest is not free of errors because all are compared with it.
TEST(Compare, ALadderWithoutALimitHidesNothing) {
  TwoKnobs k;
  std::size_t at = 0;
  for (const double q : {810.0, 690.0, 810.0, 1183.0, 810.4, 810.0, 809.5}) k.results.runs[at++].values = {q};
  compare(k.plan, nullptr, k.results);
  const std::string said = testing::PrintToString(findings(k.results));
  EXPECT_THAT(said, HasSubstr("its runs tell no limit"));
  EXPECT_THAT(said, testing::Not(HasSubstr("(100 %)")));
  EXPECT_THAT(said, HasSubstr("no run is known to be better than another"));
  EXPECT_EQ(recommended_yaml(k.results), "");
}

// q = 3 + 2 h - 5 t^2: at h = t = 1/2 the knobs cancel, but each of them moves the value by as much as before.
TEST(Compare, ErrorsThatCancelMakeNoRunBetter) {
  TwoKnobs k;
  const auto q = [](double h, double t) { return 3 + 2 * h - 5 * t * t; };
  std::size_t at = 0;
  for (auto [h, t] : {std::pair{0.5, 0.5}, {1.0, 0.5}, {0.5, 0.5}, {0.25, 0.5}, {0.5, 1.0}, {0.5, 0.5}, {0.5, 0.25}})
    k.results.runs[at++].values = {q(h, t)};
  compare(k.plan, nullptr, k.results);
  EXPECT_NEAR(k.results.references[0].value, 3, 1e-9);
  const Point& base = k.results.points[0];
  EXPECT_NEAR(base.value, 2.75, 1e-12);                      // 8 % off
  EXPECT_NEAR(base.error, std::hypot(1.0, 1.25) / 3, 1e-9);  // though not by merit
  EXPECT_EQ(base.cancel, "h +33.3 % and t -41.7 %");
  EXPECT_FALSE(base.best && base.hollow);
  EXPECT_THAT(text_report(k.results), HasSubstr("(h +33.3 % and t -41.7 % cancel)"));
  EXPECT_THAT(testing::PrintToString(findings(k.results)), HasSubstr("that the value is near is luck"));
  // Of combinations the same: along the curve, and from its limit to the reference.
  TwoKnobs all;
  all.results.runs.clear(), all.plan = {};
  all.results.study.one_at_a_time = false;
  for (double t : {1.0, 0.5, 0.25}) {
    all.plan.curves.push_back({fmt::format("t={}", t), 0, 0, {}});
    for (double h : {1.0, 0.5, 0.25}) {
      all.plan.curves.back().runs.push_back(all.run(h, t));
      all.results.runs.back().values = {q(h, t)};
    }
  }
  compare(all.plan, nullptr, all.results);
  EXPECT_NEAR(all.results.references[0].value, 3, 1e-9);
  EXPECT_NEAR(all.results.points[4].error, std::hypot(1.0, 1.25) / 3, 1e-9);
  EXPECT_EQ(all.results.points[4].cancel, "h +33.3 % and t -41.7 %");
  // Against a value that is given the error is what it is.
  k.results.study.quantities[0].reference = 3;
  compare(k.plan, nullptr, k.results);
  EXPECT_NEAR(k.results.points[0].error, 0.25 / 3, 1e-12);
}

// q = 3 + 2 h + 5 t^2 + 4 h t: a run with both knobs finer, h = 1/4 and t = 1/4, shows what the sum of the knobs misses.
TEST(Compare, InteractionOfKnobsIsMeasured) {
  const auto q = [](double h, double t) { return 3 + 2 * h + 5 * t * t + 4 * h * t; };
  TwoKnobs k;
  std::size_t at = 0;
  for (auto [h, t] : {std::pair{0.5, 0.5}, {1.0, 0.5}, {0.5, 0.5}, {0.25, 0.5}, {0.5, 1.0}, {0.5, 0.5}, {0.5, 0.25}})
    k.results.runs[at++].values = {q(h, t)};
  const std::vector<OnCurve> steps = joint_steps(k.plan, k.results);
  ASSERT_EQ(steps.size(), 2u);
  EXPECT_EQ(steps[0].step, 2u);
  EXPECT_EQ(steps[1].step, 2u);
  k.plan.refined.push_back({k.run(0.25, 0.25), steps});
  k.results.runs.back().values = {q(0.25, 0.25)};
  const double missed = interaction(k.plan, k.results, 0);
  compare(k.plan, nullptr, k.results);
  const Reference& ref = k.results.references[0];
  EXPECT_GT(missed, std::abs(ref.value - 3));  // the truth is 3: the sum of the knobs misses it by the interaction
  EXPECT_GT(ref.uncertainty, std::abs(ref.value - 3));
  EXPECT_EQ(k.results.points.back().curve, "knobs together");
}

TEST(Compare, FailuresAreCrossesAndNoPartOfTheLimit) {
  TwoKnobs k;
  RunResult& coarse = k.results.runs[k.plan.curves[0].runs[0]];
  coarse.code = 5, coarse.message = "no solution", coarse.values = {NAN};
  compare(k.plan, nullptr, k.results);
  EXPECT_THAT(k.results.references[0].how, HasSubstr("h: the finest run: a limit needs three"));
  EXPECT_THAT(points_csv(k.results), HasSubstr(",failed,no solution,"));
  const std::string svg = figure_svg(k.results);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_THAT(svg, HasSubstr(">failed</text>"));
  EXPECT_THAT(text_report(k.results), HasSubstr("failed: no solution"));
}

TEST(Compare, AnOverResolvedRunStandsInWhereThereIsNoLimit) {
  TwoKnobs k;
  for (std::size_t i : k.plan.curves[0].runs) k.results.runs[i].values[0] = i % 2 ? 4 : 5;  // goes to and fro
  EXPECT_TRUE(needs_over_resolved(k.plan, k.results));
  RunResult over;
  over.label = "fine", over.values = {3.01};
  compare(k.plan, &over, k.results);
  EXPECT_EQ(k.results.references[0].value, 3.01);
  EXPECT_THAT(k.results.references[0].how, HasSubstr("over-resolved run (fine)"));
  TwoKnobs good;
  EXPECT_FALSE(needs_over_resolved(good.plan, good.results));
}

TEST(Compare, EqualMeshesAreOneStep) {
  TwoKnobs k;
  const auto& runs = k.plan.curves[0].runs;
  k.results.runs[runs[0]] = k.results.runs[runs[1]];
  compare(k.plan, nullptr, k.results);
  ASSERT_EQ(k.results.notes.size(), 1u);
  EXPECT_THAT(k.results.notes[0], HasSubstr("they count as one step"));
  EXPECT_THAT(k.results.references[0].how, HasSubstr("h: the finest run: a limit needs three"));
}

// q = 3 + 2 h + 5 t^2 again, in all combinations of three sizes: the limit of the limits.
TEST(Compare, OfCombinationsTheLimitOfLimitsCounts) {
  TwoKnobs k;
  k.results.runs.clear(), k.plan = {};
  k.results.study.one_at_a_time = false;
  for (double t : {1.0, 0.5, 0.25}) {
    k.plan.curves.push_back({fmt::format("t={}", t), 0, 0, {}});
    for (double h : {1.0, 0.5, 0.25}) k.plan.curves.back().runs.push_back(k.run(h, t));
  }
  compare(k.plan, nullptr, k.results);
  EXPECT_NEAR(k.results.references[0].value, 3, 1e-9);
  EXPECT_THAT(k.results.references[0].how, HasSubstr("h: extrapolated at an observed order of 1; then t: extrapolated at an observed order of 2"));
  k.results.study.ladders[1].sizes.clear();  // alternatives: the first is what all are compared with
  compare(k.plan, nullptr, k.results);
  EXPECT_NEAR(k.results.references[0].value, 8, 1e-9);
  EXPECT_THAT(k.results.references[0].how, HasSubstr("of the curve 't=1'"));
}

// Two equal runs: an empty frame with numbers from 1 to 10 stood there.
TEST(Figure, SaysWhereThereIsNothingToCompare) {
  Results r;
  r.study.quantities.resize(1), r.study.quantities[0].name = "work";
  r.references = {{0, 0, 1, false, ""}};
  r.points = {point("runs", 1, 0), point("runs", 2, 0)};
  for (Point& p : r.points) p.reference = true;
  const std::string svg = figure_svg(r);
  EXPECT_THAT(svg, HasSubstr(">no run to compare with the reference<"));
  EXPECT_THAT(svg, testing::Not(HasSubstr("CPU seconds")));
}

TEST(Figure, ShowsCurvesFrontAndWhatIsBelowTheReference) {
  Results r;
  r.study.quantities.resize(2), r.study.quantities[0].name = "p<q", r.study.quantities[1].name = "other";
  r.references = {{1, 0.02, 1, true, ""}, {1, 0, 1, true, ""}};
  r.points = {point("a<b", 1, 0.1), point("a<b", 4, 0.01), point("c", 2, 0.2), point("c", 3, NAN), point("c", 3, 1, 1)};
  r.points[1].hollow = true;
  r.points[3].failed = true, r.points[3].why = "too \"hard\"";
  mark_best(r.points, r.references);
  const std::string svg = figure_svg(r);
  EXPECT_EQ(count(svg, "a<b"), 0u);
  EXPECT_EQ(count(svg, "a&lt;b: "), 2u);  // what a pointer shows
  EXPECT_EQ(count(svg, ">a&lt;b</text>"), 1u);
  for (const char* word :
       {">Pareto front<", ">knee<", ">failed<", ">below the reference's uncertainty<", ">other<", ">CPU seconds<", ">relative error<"})
    EXPECT_THAT(svg, HasSubstr(word));
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
  const std::string page = page_html(r);
  EXPECT_THAT(page, HasSubstr("<svg"));
  EXPECT_EQ(count(page, "http"), 1u);  // the namespace: nothing is loaded
}

// The reference tells none of them apart, and a run that took no time by the clock does not stretch the axis over decades.
TEST(Figure, DrawsNoFrontBelowWhatIsKnown) {
  Results r;
  r.study.quantities.resize(1), r.study.quantities[0].name = "q";
  r.references = {{1, 0.5, 1, true, ""}};
  r.points = {point("h", 0, 0.4), point("h", 1, 0.2)};
  for (Point& p : r.points) p.hollow = true;
  mark_best(r.points, r.references);
  const std::string svg = figure_svg(r);
  EXPECT_EQ(count(svg, ">Pareto front<"), 0u);
  EXPECT_EQ(count(svg, ">knee<"), 0u);
  EXPECT_EQ(count(svg, ">10⁻⁶<"), 0u);
  EXPECT_THAT(svg, HasSubstr(">10⁻³<"));
}

TEST(Study, UnknownUncertaintyIsNotNone) {
  Results r;
  r.study.quantities.resize(1), r.study.quantities[0].name = "q", r.study.methods.resize(1);
  r.references = {{1, NAN, 1, true, "the finest run: a limit needs three"}};
  EXPECT_THAT(findings(r).at(0), testing::Not(HasSubstr("known to 0 %")));
}

TEST(Figure, PixelsAreThoseOfTheSheet) {
  const std::string path = (std::filesystem::temp_directory_path() / ("mortise_canvas_" + std::to_string(getpid()) + ".png")).string();
  PixelCanvas c(40, 20, 2);
  c.shape({{10, 5}, {20, 5}, {20, 15}, {10, 15}}, {255, 0, 0}, 1, nullptr, "");
  c.line({{25, 10}, {38, 10}}, {{0, 0, 255}, 2, 1, {4, 4}});
  c.write(path);
  const render::Image i = render::read_png(path);
  std::filesystem::remove(path);
  ASSERT_EQ(i.width, 80);
  ASSERT_EQ(i.height, 40);
  const auto is = [&](int x, int y, int r, int g, int b) { return i.at(x, y)[0] == r && i.at(x, y)[1] == g && i.at(x, y)[2] == b; };
  EXPECT_TRUE(is(30, 20, 255, 0, 0));
  EXPECT_TRUE(is(18, 20, 255, 255, 255));
  EXPECT_TRUE(is(54, 20, 0, 0, 255));
  EXPECT_TRUE(is(61, 20, 255, 255, 255));  // between two dashes
}

TEST(Figure, AxesHaveTicks) {
  const auto labels = [](const Axis& a) {
    std::vector<std::string> out;
    for (const Axis::Tick& t : a.ticks())
      if (!t.label.empty()) out.push_back(t.label);
    return out;
  };
  EXPECT_THAT(labels(Axis({1e-6, 1}, 0, 1)), ElementsAre("10⁻⁶", "10⁻⁵", "10⁻⁴", "10⁻³", "10⁻²", "10⁻¹", "1"));
  EXPECT_THAT(labels(Axis({2e-3, 1}, 0, 1)), ElementsAre("0.01", "0.1", "1"));
  EXPECT_THAT(labels(Axis({1, 20}, 0, 1)), ElementsAre("1", "2", "5", "10", "20"));
  EXPECT_DOUBLE_EQ(Axis({1, 100}, 0, 232).at(10), 116);
}

TEST(Study, RunsABenchmarkMethodByMethod) {
  Study s;
  s.benchmark = "barrier", s.set = {"methods=gmcp_consistent,ipc_classic"}, s.methods.emplace_back();
  s.ladders = {ladder_of_flag("effects.pressure_load.0.pressure=1000,2000")};
  s.quantities = {quantity_of_flag("p/kappa=1: gap (worst sample)")};
  const std::string folder = (std::filesystem::temp_directory_path() / ("mortise_bench_study_" + std::to_string(getpid()))).string();
  Results r;
  for (bool again : {false, true}) {
    const StudyFolder mine(folder);
    r = run_study(s, {folder, "cpu", 1}, {});
    ASSERT_EQ(r.points.size(), 4u);
    EXPECT_EQ(r.points[0].curve, "gmcp_consistent");
    EXPECT_LT(r.points[0].error, 1e-8);
    EXPECT_EQ(r.points[2].curve, "ipc_classic");
    EXPECT_GT(r.points[2].error, 1e-2);
    EXPECT_GT(r.points[2].seconds, 0);
    EXPECT_EQ(r.runs[0].before, again);
  }
  EXPECT_THROW(StudyFolder("/dev/null"), Error);
  s.quantities = {quantity_of_flag("gpa")};
  EXPECT_THROW(run_study(s, {folder, "cpu", 1}, {}), Error);
  std::filesystem::remove_all(folder);
}

TEST(Study, ProfilesLieOverTheExactCurve) {
  const std::vector<bench::Panel> panels{{"one", {{"coarse", {{0, 1}, {0.5, 0.5}, {3, 1}}}}}, {"two", {{"coarse", {{1, 0}}}, {"fine", {{1, 0.2}}}}}};
  const std::string svg = bench::profiles_svg(
      panels, [](double x) { return 1 - x; }, "title", "r", "p", 1, 1);
  EXPECT_EQ(count(svg, "class=\"exact\""), 2u);
  EXPECT_EQ(count(svg, "<circle"), 4u + 3u);  // a dot beyond the end of the axis is left out; one per series explains it
  EXPECT_EQ(count(svg, ">two</text>"), 1u);
  // The curve falls from the upper left to the lower right corner of the first panel: pixels grow along both axes.
  EXPECT_NE(svg.find("points=\"56.0,64.0 "), std::string::npos);
  EXPECT_NE(svg.find("388.0,264.0 \""), std::string::npos);
}

// Knob 0 leaves 0.8 at the base, then 0.4, 0.2 at twice and four times the time; knob 1 0.1, then 0.05 at 1.5 times.
TEST(Greedy, TakesWhatTakesAwayMostPerSecond) {
  const std::vector<Knob> knobs{{0.8, {0.4, 0.2}, {2, 4}}, {0.1, {0.05}, {1.5}}};
  auto move = best_move(knobs, {kBase, kBase}, 100);
  ASSERT_TRUE(move);
  EXPECT_EQ(move->knob, 0u);
  EXPECT_EQ(move->step, 0u);  // log(0.9/0.5)/log 2 = 0.85 against log(0.9/0.3)/log 4 = 0.79
  EXPECT_NEAR(move->error, 0.5, 1e-12);
  move = best_move(knobs, {1, kBase}, 100);
  ASSERT_TRUE(move);
  EXPECT_EQ(move->knob, 1u);
  EXPECT_NEAR(move->cost, 6, 1e-12);
  EXPECT_FALSE(best_move(knobs, {1, 0}, 100));      // nothing is finer
  EXPECT_FALSE(best_move(knobs, {1, kBase}, 5.9));  // it would not fit
  EXPECT_FALSE(best_move({{0.1, {NAN}, {NAN}}}, {kBase}, 100));
  // What is cheaper and better is taken first, whatever else there is.
  EXPECT_EQ(best_move({{0.8, {0.1}, {2}}, {0.1, {0.09}, {0.9}}}, {kBase, kBase}, 100)->knob, 1u);
}
