#pragma once
// A swing beside the one that was integrated. Of a coordinate x with r and r' its place and rate as seen from what carries it or drives it after a
// target, and its acceleration a, in every state,
//
//     a = -kappa r - c r' + what it stands in,
//
// kappa and c fitted to the changes of the last states (each weighs kForgets of the one after); c is 0 where that follows, too. Of what ends a step
// of length h at x_1 the motion between is x_0 + (x_1 - x_0) t/h, which the forces there do not follow; what it should be beside it is
//
//     e'' + c e' + kappa e = a - x'',     x'' = sum over the states of delta(t) (x_1 - 2 x_0 + x_-1) / h,
//
// whatever drives it, and whatever integrates it; its acceleration is a* = a - kappa e - c e'. Where the fit leaves more than 1 - kFits of the
// changes' square, as where a load sets in, it begins with the last of them, and until there are two e is 0: it does not swing.
// Nor does what would swing more than once in a step, or be damped by as much, as rounding does.
#include <cmath>

namespace mortise::audit {

struct FittedSwing {
  double rr = 0, rv = 0, vv = 0, ra = 0, va = 0, aa = 0;  // sums of r r, r r', r' r', r a, r' a and a a over the changes so far
  double changes = 0;                                     // so many
  double e = 0, rate = NAN;                               // e and e'; NaN: it does not swing

  void fit(double r, double v, double a);  // by how much they changed in the step
  // Over that step, in which a went from a_0 to a_1 and before which x changed its rate by kink; gives a* - a in its end.
  double swing(double a_0, double a_1, double kink, double h);
  bool follows(double& kappa, double& c) const;
  void rest() { e = 0, rate = NAN; }
};

}  // namespace mortise::audit
