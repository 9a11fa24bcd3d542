#include "base/angle.h"

#include <gtest/gtest.h>

using namespace mortise;

TEST(Angle, TurnsAndAngles) {
  for (int i = -3200; i <= 3200; ++i) {
    const double a = i * 1e-3;
    const Turn t = turn_by(a);
    EXPECT_NEAR(t.cos, std::cos(a), 2e-15) << a;
    EXPECT_NEAR(t.sin, std::sin(a), 2e-15) << a;
    for (double size : {1e-150, 0.3, 7.0, 1e150}) {
      const double k = size * std::cos(a), s = size * std::sin(a);
      EXPECT_NEAR(angle_of(k, s), std::atan2(s, k), 2e-15) << a;
    }
  }
  for (double tiny : {1e-300, 1e-17, 1e-9, 1e-4}) {
    EXPECT_NEAR(angle_of(1, tiny), std::atan(tiny), 4e-16 * tiny);
    EXPECT_NEAR(turn_by(tiny).sin, std::sin(tiny), 4e-16 * tiny);
  }
  EXPECT_EQ(angle_of(0, 0), 0);
  EXPECT_NEAR(angle_of(-1, 0), M_PI, 1e-15);
  EXPECT_NEAR(angle_of(0, -2), -M_PI / 2, 1e-15);
  EXPECT_TRUE(std::isnan(angle_of(NAN, 1)) || std::isnan(angle_of(1, NAN)));
}
