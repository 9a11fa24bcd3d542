// What ladders tend to, and how well that is known.
#include "study/limit.h"

#include <gmock/gmock.h>

#include <cmath>

using namespace mortise::study;

namespace {

std::vector<double> along(const std::vector<double>& h, const std::function<double(double)>& of) {
  std::vector<double> out;
  for (double size : h) out.push_back(of(size));
  return out;
}

}  // namespace

// Ladders are seldom even: a limit that takes them for even is 138 % off where 35 % is true.
TEST(Limit, OfUnevenLaddersIsExact) {
  for (const std::vector<double>& h : {std::vector<double>{1, 0.5, 0.25}, {4, 3, 1}, {8, 2, 1.5, 1.25}}) {
    const Limit limit = limit_of(h, along(h, [](double s) { return 2 + std::pow(s, 1.5); }));
    EXPECT_TRUE(limit.extrapolated);
    EXPECT_NEAR(limit.value, 2, 1e-10);
    EXPECT_NEAR(limit.order, 1.5, 1e-9);
    EXPECT_EQ(limit.how, "extrapolated at an observed order of 1.5");
  }
  EXPECT_FALSE(limit_of({4, 2, 1}, {1, 2, 1.5}).extrapolated);  // oscillates
  EXPECT_EQ(limit_of({4, 2, 1}, {1, 2, 4}).value, 4);           // diverges
  EXPECT_FALSE(limit_of({4, 2, 1}, {1, 2, 2.9}).extrapolated);  // hardly converges
  EXPECT_EQ(limit_of({2, 1}, {1, 2}).value, 2);
  EXPECT_FALSE(limit_of({}, {3, 2.5, 2.25}).extrapolated);
}

// The true limit is 2 in all; a second term of another order makes the extrapolation wrong by less than the uncertainty says.
TEST(Limit, UncertaintyHoldsTheTruth) {
  for (double second : {0.3, -0.3, 1.0})
    for (const std::vector<double>& h : {std::vector<double>{1, 0.5, 0.25}, {1, 0.5, 0.25, 0.125}, {1, 0.7, 0.5, 0.3, 0.2}}) {
      const std::vector<double> q = along(h, [&](double s) { return 2 + std::pow(s, 1.5) + second * std::pow(s, 2.5); });
      const Limit limit = limit_of(h, q);
      ASSERT_TRUE(limit.extrapolated);
      EXPECT_LT(std::abs(limit.value - 2), limit.uncertainty) << second << " " << h.size();
      EXPECT_LE(limit.uncertainty, 1.25 * std::abs(limit.value - q.back()) * (1 + 1e-12));
    }
  // A fourth run makes it better known.
  const auto q = [](double s) { return 2 + s + 0.2 * s * s; };
  EXPECT_LT(limit_of({1, 0.5, 0.25, 0.125}, along({1, 0.5, 0.25, 0.125}, q)).uncertainty,
            0.3 * limit_of({0.5, 0.25, 0.125}, along({0.5, 0.25, 0.125}, q)).uncertainty);
  EXPECT_DOUBLE_EQ(limit_of({4, 2, 1}, {1, 2, 1.5}).uncertainty, 1.5);  // three times the last difference
  EXPECT_DOUBLE_EQ(limit_of({4, 2, 1}, {1, 2, 1.9}).uncertainty, 1);    // near by chance
  EXPECT_TRUE(std::isnan(limit_of({1}, {1}).uncertainty));
  EXPECT_EQ(limit_of({4, 2, 1}, {7, 7, 7}).uncertainty, 0);
}

// Two equal neighbours make no limit where the ladder has just jumped: the next steps of the first went on to 7.679 and 8.319.
TEST(Limit, IsNoBetterKnownThanTheLadderJumps) {
  EXPECT_NEAR(limit_of({16, 8, 4, 2, 1}, {6.685, 6.685, 6.240, 7.2556, 7.2557}).uncertainty, 1.0156, 1e-9);
  EXPECT_NEAR(limit_of({8, 4, 2, 1}, {5, 6, 6.001, 6.001}).uncertainty, 1, 1e-9);
  EXPECT_NEAR(limit_of({16, 8, 4, 2, 1}, {1.8, 1.2, 1.01, 1.0003, 1.0002}).uncertainty, 0.0097, 1e-9) << "that it came from";
}

TEST(Limit, LaddersHaveSizes) {
  EXPECT_THAT(ladder_sizes({"2 mm", "1500 um", "1 mm"}), testing::Pointwise(testing::DoubleNear(1e-15), {2e-3, 1.5e-3, 1e-3}));
  EXPECT_THAT(ladder_sizes({"2", "4", "10"}), testing::Pointwise(testing::DoubleNear(1e-15), {0.5, 0.25, 0.1}));
  for (const std::vector<std::string>& none : {std::vector<std::string>{"a", "b"}, {"1 mm", "2 s"}, {"1", "3", "2"}, {"[1]", "[2]"}, {"1", "1"}})
    EXPECT_TRUE(ladder_sizes(none).empty());
}

TEST(Limit, LaddersThatAreNoneAreRefused) {
  EXPECT_THAT(not_a_ladder({"1 mm", "2 mm"}), testing::HasSubstr("from coarse to fine"));
  EXPECT_THAT(not_a_ladder({"1", "3", "2"}), testing::HasSubstr("up and down"));
  EXPECT_THAT(not_a_ladder({"1 mm", "1 mm"}), testing::HasSubstr("stands in it twice"));
  for (const std::vector<std::string>& fine :
       {std::vector<std::string>{"2 mm", "1 mm"}, {"1", "2"}, {"direct", "cg"}, {"1 MPa", "10 MPa"}, {"5 mm"}, {"[1, 2]", "[2, 4]"}})
    EXPECT_EQ(not_a_ladder(fine), "");
}
