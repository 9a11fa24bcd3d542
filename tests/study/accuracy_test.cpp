// Which levels are chosen of knobs whose errors are known.
#include "study/accuracy.h"

#include <gtest/gtest.h>

#include <cmath>

#include "study/accuracy_model.h"

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
  EXPECT_EQ(far.levels, (Levels{2, 2}));
  EXPECT_TRUE(choose_levels(climbs, {1}, 1, {0, 0}).reached);
}

TEST(Accuracy, GoalsAreStrict) {
  EXPECT_NEAR(goal_of_flag("peak=2%").share, 0.02, 1e-15);
  EXPECT_EQ(goal_of_flag("a=b=0.5 %").quantity, "a=b");
  for (const char* wrong : {"peak", "peak=", "=1%", "peak=1", "peak=x%", "peak=-1%", "peak=0%", "peak=60%", "peak=nan%", "peak=1e-9%", "peak=1 2%"})
    EXPECT_THROW(goal_of_flag(wrong), Error) << wrong;
}

}  // namespace
}  // namespace mortise::study
