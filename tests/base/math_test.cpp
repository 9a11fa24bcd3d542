#include "base/math.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

using namespace mortise;

namespace {

// Distance of x from the exact value (80-bit, of which 11 bits more than x has) in units of x's last place.
double ulps(double x, long double exact) {
  const double up = std::nextafter(std::fabs(x), INFINITY);
  return static_cast<double>(std::fabs(x - exact) / (static_cast<long double>(up) - std::fabs(x)));
}

}  // namespace

TEST(Math, LnIsWithinOneUnitInTheLastPlace) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(0, 1), exponent(-300, 300);
  double worst = 0;
  for (int i = 0; i < 1'000'000; ++i) {
    const double x = i % 3 == 0   ? unit(random)
                     : i % 3 == 1 ? 1 + (unit(random) - 0.5) * std::pow(10, -8 * unit(random))
                                  : std::pow(10, exponent(random));
    if (x == 1) continue;
    worst = std::max(worst, ulps(ln(x), std::log(static_cast<long double>(x))));
  }
  EXPECT_LT(worst, 1);
  std::printf("ln: %.3f ulp\n", worst);
}

TEST(Math, LnAtItsEnds) {
  EXPECT_EQ(ln(1), 0);
  EXPECT_EQ(ln(0), -INFINITY);
  EXPECT_EQ(ln(INFINITY), INFINITY);
  EXPECT_TRUE(std::isnan(ln(-1)));
  EXPECT_TRUE(std::isnan(ln(NAN)));
  EXPECT_LT(ulps(ln(5e-324), std::log(static_cast<long double>(5e-324))), 1);
  EXPECT_LT(ulps(ln(1.7976931348623157e308), std::log(static_cast<long double>(1.7976931348623157e308))), 1);
  for (int k = -1000; k <= 1000; k += 50) EXPECT_LT(ulps(ln(std::ldexp(1.0, k)), k == 0 ? 0 : k * std::log(2.0L)), k == 0 ? 1e-300 : 1) << k;
}

TEST(Math, Ln1pIsWithinOneUnitInTheLastPlace) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> unit(0, 1);
  double worst = 0;
  for (int i = 0; i < 1'000'000; ++i) {
    const double y = i % 2 == 0 ? (i % 4 == 0 ? 1 : -0.999) * std::pow(10, -18 * unit(random)) : 1e3 * unit(random);
    worst = std::max(worst, ulps(ln1p(y), std::log1p(static_cast<long double>(y))));
  }
  EXPECT_LT(worst, 1.5);
  EXPECT_EQ(ln1p(0), 0);
  EXPECT_EQ(ln1p(1e-300), 1e-300);
  std::printf("ln1p: %.3f ulp\n", worst);
}
