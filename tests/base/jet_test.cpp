// Derivatives that numbers carry along.
#include "base/jet.h"

#include <gtest/gtest.h>

using namespace mortise;

namespace {

template <class T>
T program(const T& x, const T& y) {
  T out = x * y - 2 / (1 + x);
  out += root(y) * (x - 3);
  out *= smaller(x, y);
  out -= larger(x, T(1.5));
  return x < y ? out / (x + 1) : -out;
}

}  // namespace

TEST(Jet, CarriesDerivativesOfWhateverIsComputed) {
  for (const auto& [x, y] : {std::pair{0.7, 2.1}, {2.3, 1.2}, {4.0, 0.3}}) {
    const Jet<2> found = program(Jet<2>::variable(x, 0), Jet<2>::variable(y, 1));
    EXPECT_EQ(found.a, program(x, y)) << "the bits of the same program with numbers";
    const double h = 1e-5;
    EXPECT_NEAR(found.d[0], (program(x + h, y) - program(x - h, y)) / (2 * h), 1e-8);
    EXPECT_NEAR(found.d[1], (program(x, y + h) - program(x, y - h)) / (2 * h), 1e-8);
  }
}

TEST(Jet, RootsOfNothingHaveNoDerivative) {
  const Jet<1> r = root(Jet<1>::variable(0, 0));
  EXPECT_EQ(r.a, 0);
  EXPECT_EQ(r.d[0], 0);
}
