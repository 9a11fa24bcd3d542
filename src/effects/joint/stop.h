#pragma once
// Stops of a joint whose coordinate x has to stay above `low` and below `high`: a barrier that begins at the range w before either,
//
//     E = M w [b((x - low) / w) + b((high - x) / w)],     b(t) = -(t - 1)^2 ln t  (t < 1),  0 (t >= 1),
//
// twice continuously differentiable, without bound at the stops. Its force is M phi(t) with phi = -b' = 2 (t - 1) ln t + (t - 1)^2 / t: 1.2 M where
// half of the range is left. M [N m], of slides [N].
#include <cmath>

#include "base/math.h"
#include "base/types.h"
#include "effects/joint/tuning.h"

namespace mortise::effects::stop {

MORTISE_HD inline double b(double t) { return t < 1 ? -(t - 1) * (t - 1) * ln(t) : 0; }
MORTISE_HD inline double phi(double t) { return t < 1 ? 2 * (t - 1) * ln(t) + (t - 1) * (t - 1) / t : 0; }
MORTISE_HD inline double phi_falls(double t) { return t < 1 ? -2 * ln(t) - 4 * (t - 1) / t + (t - 1) * (t - 1) / (t * t) : 0; }  // b'' = -phi'

struct Stops {
  double low, high, range, strength;
  MORTISE_HD double up(double x) const { return (1 - joint::tuning::kKeep) * (high - x); }
  MORTISE_HD double down(double x) const { return (1 - joint::tuning::kKeep) * (x - low); }
  MORTISE_HD double energy(double x) const {
    if (!(x > low && x < high)) return INFINITY;
    return strength * range * (b((x - low) / range) + b((high - x) / range));
  }
  MORTISE_HD double first(double x) const { return strength * (phi((high - x) / range) - phi((x - low) / range)); }
  MORTISE_HD double second(double x) const { return strength / range * (phi_falls((high - x) / range) + phi_falls((x - low) / range)); }
};

}  // namespace mortise::effects::stop
