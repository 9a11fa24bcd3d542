// What a budget makes of the parts that were found.
#include <gmock/gmock.h>

#include <cmath>

#include "study/error_budget.h"

using namespace mortise::study;
using testing::HasSubstr;

namespace {

QuantityBudget of_mesh(double error, double hidden, double value = 1) {
  QuantityBudget budget;
  ErrorPart mesh{kMeshPart, error, ""};
  mesh.hidden = hidden;
  budget.parts = {mesh, {kSolutionPart, 1e-6, ""}};
  budget.judge(value);
  return budget;
}

TEST(Budget, APartIsReliedOnWhereItIsSmall) {
  const QuantityBudget b = of_mesh(-0.02, 0);
  EXPECT_TRUE(b.complete());
  EXPECT_DOUBLE_EQ(b.parts[0].error, -0.02);
  EXPECT_NEAR(b.sum(), -0.02 + 1e-6, 1e-15);
  EXPECT_NEAR(b.share(), 0.02 - 1e-6, 1e-15);
}

// The difference of what is too stiff and what is too soft says nothing of either.
TEST(Budget, WhatHidesCountsTogether) {
  const QuantityBudget b = of_mesh(-0.001, 0.06);
  EXPECT_FALSE(b.complete());
  EXPECT_TRUE(std::isnan(b.parts[0].error));
  EXPECT_THAT(b.parts[0].why_not, HasSubstr(std::string(kNotReliable) + ": elements are too stiff in shear and too soft in what changes volumes"));
  EXPECT_DOUBLE_EQ(b.parts[0].found, -0.06) << "grades go by it";
  EXPECT_NEAR(b.share(), 0.06 - 1e-6, 1e-15);
}

TEST(Budget, LittleThatHidesIsTold) {
  const QuantityBudget b = of_mesh(-0.001, 0.009);
  EXPECT_TRUE(b.complete());
  EXPECT_DOUBLE_EQ(b.parts[0].error, -0.009);
}

TEST(Budget, ACoarseMeshIsNotReliedOn) {
  const QuantityBudget b = of_mesh(0.5, 0);
  EXPECT_THAT(b.parts[0].why_not, HasSubstr("the mesh is too coarse for it (50 % of the number was found"));
  EXPECT_DOUBLE_EQ(b.parts[0].found, 0.5);
}

// Beside what it is large against a number that should be zero has a share, too.
TEST(Budget, OfNothingTheShareIsThatOfItsScale) {
  QuantityBudget b;
  b.parts = {{kSolutionPart, 1e-6, ""}};
  b.parts[0].found = NAN;
  b.judge(0);
  EXPECT_TRUE(std::isnan(b.share()));
  b.scale = 1;
  EXPECT_GT(b.share(), 0);
}

}  // namespace
