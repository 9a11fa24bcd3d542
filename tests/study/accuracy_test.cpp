// Which levels are chosen of knobs whose errors are known.
#include "study/accuracy.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "engine/effect_tables.h"
#include "scene/scene.h"
#include "study/accuracy_budget.h"
#include "study/error_budget.h"

namespace mortise::study {
namespace {

// q = 1 + c h^p, three runs.
Climb knob(double c, double p, double ratio, double dearer) {
  Climb out;
  out.ratio = ratio, out.dearer = dearer, out.finest = 10;
  for (int level : {0, -2, -1}) {
    const double h = std::pow(ratio, level);
    out.add({level, h, {1 + c * std::pow(h, p)}, std::pow(h, -dearer)});
  }
  return out;
}

TEST(Accuracy, ErrorsOfLevelsFollowTheOrderThatWasSeen) {
  const Climb k = knob(0.1, 2, 0.5, 3);
  EXPECT_NEAR(k.limit(0).value, 1, 1e-9);
  EXPECT_NEAR(k.left(0, 0), -0.1, 1e-9);
  EXPECT_NEAR(k.value(0, 2), 1 + 0.1 / 16, 1e-9);
  EXPECT_NEAR(k.cost(1), 8, 1e-6);
  EXPECT_GE(k.error(0, 2), 0.1 / 16);
  EXPECT_LE(k.error(0, 2), 1.3 * 0.1 / 16);
  EXPECT_NEAR(k.error(0, -1), 0.4, 1e-9);
}

TEST(Accuracy, TwoRunsAreAGuessAndOneIsNothing) {
  Climb k;
  k.rungs = {{0, 1, {1.0}, 1}};
  EXPECT_TRUE(std::isinf(k.error(0, 0)));
  k.add({-1, 2, {1.1}, 0.2});
  EXPECT_GE(k.error(0, 0), 0.3 - 1e-12);
  k.rungs[0].values[0] = 1.0;  // a knob that changes nothing leaves nothing
  EXPECT_EQ(k.error(0, 0), 0);
}

TEST(Accuracy, CancellingErrorsMakeNoRunBetter) {
  const std::vector<Climb> both{knob(0.1, 1, 0.5, 1), knob(-0.1, 1, 0.5, 1)};
  EXPECT_GE(estimate(both, 0, {0, 0}), 0.1 * std::sqrt(2.0));
  EXPECT_GE(estimate({both[0], both[0]}, 0, {0, 0}), 0.2 - 1e-9);
}

TEST(Accuracy, TheCheapKnobGoesFirstAndNoneTooFar) {
  const std::vector<Climb> climbs{knob(0.02, 1, 0.5, 4), knob(0.02, 1, 0.5, 0.2)};
  const Chosen near = choose_levels(climbs, {0.045}, 1, {0, 0});
  EXPECT_TRUE(near.reached);
  EXPECT_EQ(near.levels[0], 0);
  const Chosen far = choose_levels(climbs, {1e-6}, 1, {0, 0});
  EXPECT_FALSE(far.reached);
  EXPECT_EQ(far.levels, (Levels{0, 2})) << "the other waits until the new run was looked at";
  EXPECT_TRUE(choose_levels(climbs, {1}, 1, {0, 0}).reached);
}

TEST(Accuracy, WhatLeavesLittleIsNotRefinedForIt) {
  // Differences grow: no order is seen, and the next level that runs have told is no better than this one.
  Climb unsettled;
  unsettled.ratio = 0.5, unsettled.dearer = 1, unsettled.finest = 10;
  for (const auto& [level, value] : {std::pair{-1, 1.0}, {0, 1.1}, {1, 1.2}})
    unsettled.add({level, std::pow(0.5, level), {value}, std::pow(2, level)});
  const std::vector<Climb> climbs{knob(0.001, 1, 0.5, 0.1), unsettled};
  EXPECT_EQ(choose_levels(climbs, {0.01}, 1, {0, 0}).levels, (Levels{0, 2})) << "over the level that is no better";
  EXPECT_EQ(choose_levels(climbs, {0.01}, 1, {0, 0}, 3).levels, (Levels{0, 0})) << "too dear, and the other is not worth it";
  EXPECT_FALSE(settles(climbs, 0, 0.01));
  EXPECT_TRUE(settles(climbs, 0, 10)) << "what scatters by next to nothing";
}

TEST(Accuracy, LaddersGoOnWhereOtherKnobsWereMoved) {
  const Climb k = knob(0.1, 2, 0.5, 3), moved = k.around(1, {2 + 0.1 / 4});
  EXPECT_NEAR(moved.limit(0).value, 2, 1e-9);
  EXPECT_NEAR(moved.left(0, 0), -0.1 / 4, 1e-9);
  EXPECT_NEAR(moved.left(0, -1), -0.1, 1e-9);
  EXPECT_NEAR(moved.cost(-1), 1.0 / 8, 1e-6);
}

TEST(Accuracy, StepsEndWhereTheSceneDoes) {
  AutoKnob k{"time step", 0.5, 1, false, false, {}};
  k.steps = 30, k.end = 0.03;
  EXPECT_EQ(k.settings(-2), (Settings{{"time.step", "0.00375"}, {"time.steps", "8"}}));
  EXPECT_EQ(k.label(-2), "time step x 3.75");
  EXPECT_NEAR(k.size(-2), 3.75, 1e-12);
  EXPECT_EQ(k.settings(1), (Settings{{"time.step", "0.0005"}, {"time.steps", "60"}}));
  EXPECT_TRUE(k.settings(0).empty());
  EXPECT_EQ(k.size(-9), k.size(-5)) << "one step is the least";
}

TEST(Accuracy, WhatScattersIsNoBetterThanItScatters) {
  const auto uncertainty = [](std::vector<double> values) {
    Climb k;
    for (int i = 0; i < 3; ++i) k.add({i - 2, std::pow(2, 0.5 * (2 - i)), {values[static_cast<std::size_t>(i)]}, 1});
    return k.error(0, 0);
  };
  EXPECT_NEAR(uncertainty({1.1, 0.98, 1.0}), 0.125, 1e-12) << "up and down";
  EXPECT_NEAR(uncertainty({1.1, 1.005, 1.0}), 0.125, 1e-12) << "order 8, faster than methods converge: a coarse mesh's luck";
  EXPECT_NEAR(uncertainty({1.0, 1.1, 1.25}), 0.45, 1e-12) << "differences grow";
}

TEST(Accuracy, SaysWhatHasNotSettled) {
  EXPECT_TRUE(knob(0.1, 1, 0.5, 1).settles(0));
  Climb k = knob(0.1, 1, 0.5, 1);
  k.rungs[0].values[0] = 0.9;
  EXPECT_FALSE(k.settles(0));
  for (Rung& r : k.rungs) r.values[0] = 1;
  EXPECT_TRUE(k.settles(0)) << "a knob that changes nothing";
  Climb coarse = climbs_of_budgets({{"mesh", 0.7, 3.5, true, false, {}}}, {{INFINITY, 0}})[0];
  coarse.rungs = {{0, 1, {1.0}, 1}};
  EXPECT_FALSE(coarse.settles(0));
}

TEST(Accuracy, BudgetsOfOneRunChooseTheCheapKnob) {
  AutoKnob mesh{"mesh", 0.7, 3.5, true, false, {}}, layer{"layer", 0.5, 0.3, false, true, {}};
  ASSERT_TRUE(budgets_tell({mesh, layer}));
  ASSERT_FALSE(budgets_tell({mesh, {"time step", 0.5, 1, false, false, {}}}));
  auto both = climbs_of_budgets({mesh, layer}, {{0.04, 0.08}});
  for (Climb& c : both) c.finest = 10, c.rungs = {{0, 1, {1.0}, 1}};
  EXPECT_NEAR(estimate(both, 0, {0, 0}), 0.12, 1e-12);
  EXPECT_NEAR(estimate(both, 0, {0, 2}), 0.06, 1e-12);
  EXPECT_EQ(choose_levels(both, {0.07}, 1, {0, 0}).levels, (Levels{0, 2}));
  auto alone = climbs_of_budgets({mesh}, {{0.04, 0.08}});
  alone[0].finest = 10, alone[0].rungs = {{0, 1, {1.0}, 1}};
  EXPECT_NEAR(estimate(alone, 0, {1}), 0.04 * std::pow(0.7, 1.5) + 0.08 * 0.7, 1e-12) << "the layer follows the mesh";
  auto coarse = climbs_of_budgets({mesh, layer}, {{INFINITY, 0}});
  for (Climb& c : coarse) c.finest = 10, c.rungs = {{0, 1, {1.0}, 1}};
  EXPECT_FALSE(std::isfinite(estimate(coarse, 0, {2, 2}))) << "what cannot be told of a mesh is never small enough";
}

TEST(Accuracy, ReadsBudgetsOfCertificates) {
  const std::string file = (std::filesystem::temp_directory_path() / ("mortise_budget_" + std::to_string(getpid()) + ".json")).string();
  std::vector<Quantity> force(1), other(1);
  force[0].name = "force", other[0].name = "other";
  const auto read = [&](const std::string& mesh, const std::string& why_not, const std::string& none = "") {
    std::ofstream(file) << R"({"error_budget": [{"quantity": "force", "why_not": ")" << none << R"(", "parts": [{"source": ")" << kMeshPart
                        << R"(", "error": )" << mesh << R"(, "why_not": ")" << why_not << R"("}, {"source": ")" << kGapPart
                        << R"(", "error": 0.5, "why_not": ""}]}]})";
    return goal_budgets(file, force);
  };
  EXPECT_EQ(read("-0.25", "")->at(0).mesh, -0.25);
  EXPECT_EQ(read("-0.25", "")->at(0).gap, 0.5);
  EXPECT_EQ(read("null", std::string(kNotReliable) + ": too coarse")->at(0).mesh, INFINITY);
  EXPECT_FALSE(read("null", "'pad' has quadratic elements"));
  EXPECT_FALSE(read("-0.25", "", "no gradient"));
  EXPECT_FALSE(goal_budgets(file, other));
  std::filesystem::remove(file);
  EXPECT_FALSE(goal_budgets(file, force));
}

TEST(Accuracy, AMeshThatIsTooCoarseIsNotReliedOn) {
  const auto judged = [](double error) {
    QuantityBudget b;
    b.parts = {{kMeshPart, error, ""}, {kGapPart, 5, ""}};
    b.judge(-10);
    return b;
  };
  EXPECT_EQ(judged(0.99).parts[0].error, 0.99);
  EXPECT_TRUE(judged(0.99).complete());
  for (double error : {1.01, -1.01}) {
    const QuantityBudget b = judged(error);
    EXPECT_TRUE(std::isnan(b.parts[0].error));
    EXPECT_TRUE(b.parts[0].why_not.starts_with(kNotReliable)) << b.parts[0].why_not;
    EXPECT_EQ(b.sum(), 5) << "the gap's part has no such bound";
    EXPECT_FALSE(b.complete());
  }
}

TEST(Accuracy, PressuresWantALayerThatFitsTheMesh) {
  const std::string file = (std::filesystem::temp_directory_path() / ("mortise_knobs_" + std::to_string(getpid()) + ".yaml")).string();
  std::ofstream(file) << "mortise: 1\nname: press\ntime: {mode: static, steps: 1}\nmaterials: {gel: {model: linear, youngs_modulus: 1e5, "
                         "poisson_ratio: 0.3, density: 1e3}}\n"
                         "bodies:\n  pad: {type: soft, shape: {box: {size: [1, 1, 1], edge_length: 0.2}}, material: gel}\n"
                         "  ball: {type: stiff, shape: {sphere: {radius: 1, edge_length: 0.1}}, material: gel, position: [0, 0, 2]}\n"
                         "effects:\n  elasticity: {}\n  pin: [{body: pad, where: {side: z_min}}, {body: ball, where: {side: all}}]\n"
                         "  mortar_contact: {pairs: [{slave: pad, master: ball}]}\n";
  const auto knobs = [&](const std::vector<std::string>& set, bool pressures) {
    Quantity q;
    q.value = pressures ? "contact_pressure" : "supports/ball_z";
    return auto_knobs(scene::read_scene(file, set, engine::effect_tables()).root, {q});
  };
  const std::string layer = "effects.mortar_contact.";
  EXPECT_EQ(knobs({}, false).size(), 1U);
  const auto fits = knobs({}, true);
  ASSERT_EQ(fits.size(), 2U);
  EXPECT_EQ(fits[1].settings(0), (Settings{{layer + "d_hat", "0.01"}})) << "a twentieth of the soft body's edge";
  EXPECT_EQ(knobs({layer + "d_hat=0.004"}, true)[1].settings(0), fits[1].settings(0));
  EXPECT_TRUE(knobs({layer + "d_hat=0.02"}, true)[1].settings(0).empty()) << "thick enough as it is";
  EXPECT_TRUE(knobs({layer + "d_hat=0.004", layer + "stiffness=1e5"}, true)[1].settings(0).empty()) << "the scene's choice";
  const auto one = joined(fits);
  ASSERT_EQ(one.size(), 1U);
  EXPECT_EQ(one[0].name, "mesh and layer");
  EXPECT_EQ(one[0].settings(0), fits[1].settings(0));
  EXPECT_EQ(one[0].settings(2).size(), 3U);
  Quantity largest;
  largest.value = "supports/ball_z", largest.when = "largest";
  EXPECT_EQ(auto_knobs(scene::read_scene(file, {}, engine::effect_tables()).root, {largest}).back().name, "load steps")
      << "of the way, not of its end";
  EXPECT_NEAR(std::stod(one[0].settings(2)[2].second), 0.005, 1e-9) << "both in proportion";
  std::filesystem::remove(file);
}

TEST(Accuracy, GoalsAreStrict) {
  EXPECT_NEAR(goal_of_flag("peak=2%").share, 0.02, 1e-15);
  EXPECT_EQ(goal_of_flag("a=b=0.5 %").quantity, "a=b");
  for (const char* wrong : {"peak", "peak=", "=1%", "peak=1", "peak=x%", "peak=-1%", "peak=0%", "peak=60%", "peak=nan%", "peak=1e-9%", "peak=1 2%"})
    EXPECT_THROW(goal_of_flag(wrong), Error) << wrong;
}

}  // namespace
}  // namespace mortise::study
