#include "audit/fitted_swing.h"

#include <algorithm>
#include <numbers>

#include "audit/tuning.h"

namespace mortise::audit {

void FittedSwing::fit(double r, double v, double a) {
  for (double* sum : {&rr, &rv, &vv, &ra, &va, &aa}) *sum *= tuning::kForgets;
  rr += r * r, rv += r * v, vv += v * v, ra += r * a, va += v * a, aa += a * a, ++changes;
  double kappa, c;
  if (follows(kappa, c)) return;
  rr = r * r, rv = r * v, vv = v * v, ra = r * a, va = v * a, aa = a * a, changes = 1;
}

bool FittedSwing::follows(double& kappa, double& c) const {
  kappa = rr > 0 ? std::max(-ra / rr, 0.0) : 0, c = 0;
  double part = -kappa * ra;
  const double apart = rr * vv - rv * rv, k = (rv * va - vv * ra) / apart, d = (rv * ra - rr * va) / apart;
  if (part < tuning::kFits * aa && apart > tuning::kApart * rr * vv && k > 0 && d > 0) kappa = k, c = d, part = -k * ra - d * va;
  return part > tuning::kFits * aa;
}

double FittedSwing::swing(double a_0, double a_1, double kink, double h) {
  double kappa, c;
  if (!follows(kappa, c) || changes < 2 || std::max(std::sqrt(kappa), c) * h > 2 * std::numbers::pi) {
    rest();
    return 0;
  }
  rate = (std::isnan(rate) ? kink / 2 : rate) - kink;  // by half of it beside the mean of both
  // The midpoint rule, which damps nothing.
  const int n = std::clamp(static_cast<int>(std::ceil(tuning::kPerRadian * std::sqrt(kappa) * h)), 4, 200);
  const double dt = h / n, with = 1 + c * dt / 2 + kappa * dt * dt / 4;
  for (int i = 0; i < n; ++i) {
    const double a = a_0 + (a_1 - a_0) * (i + 0.5) / n, before = rate;
    rate = ((2 - with) * before + (a - kappa * e) * dt) / with;
    e += dt / 2 * (before + rate);
  }
  return -kappa * e - c * rate;
}

}  // namespace mortise::audit
