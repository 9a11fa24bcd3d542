#pragma once
// Gauss rules on a triangle with 1, 3, 6 and 7 points, exact for polynomials of degree 1, 2, 4 and 5 (Dunavant 1985). Weights add
// up to 1.
#include "base/hd.h"

namespace mortise::geometry {

struct TrianglePoint {
  double b[3];  // barycentrics
  double weight;
};

// One orbit of three points (a, a, 1 - 2a).
MORTISE_HD inline TrianglePoint triangle_orbit(double a, double weight, int i) {
  TrianglePoint p{{a, a, a}, weight};
  p.b[i] = 1 - 2 * a;
  return p;
}

// Point i of the rule with n points.
MORTISE_HD inline TrianglePoint triangle_point(int n, int i) {
  constexpr double third = 1.0 / 3;
  if (n == 1) return {{third, third, third}, 1};
  if (n == 3) return triangle_orbit(1.0 / 6, third, i);
  if (n == 6)
    return i < 3 ? triangle_orbit(0.44594849091596488632, 0.22338158967801146570, i)
                 : triangle_orbit(0.091576213509770743460, 0.10995174365532186764, i - 3);
  if (i == 6) return {{third, third, third}, 0.225};
  return i < 3 ? triangle_orbit(0.10128650732345633880, 0.12593918054482715260, i)
               : triangle_orbit(0.47014206410511508977, 0.13239415278850618074, i - 3);
}

}  // namespace mortise::geometry
