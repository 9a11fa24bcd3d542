#pragma once
// Gaits: one of the two hinges of a leg takes its foot along a D beside where it stands in the scene. With period T, duty D, stride S, clearance h,
// depth d, phase p, begin t_0, ramp t_r, the share s of the cycle and the part r of the full step at the time t are
//
//     s = frac(p + D/2 + (t - t_0)/T),     v = clamp((t - t_0)/t_r, 0, 1),  r = v^2 (3 - 2 v)
//     on the ground   (s < D)   u = s/D:             x = S (1/2 - u),                        z = -d sin(pi u)
//     in the air      (else)    u = (s - D)/(1 - D): x = S (u - sin(2 pi u)/(2 pi) - 1/2),   z = h (1 - cos(2 pi u))/2
//
// the cycloid lifts and lands without velocity. r x along `forward` and r z along `up` are added to the place of the foot. In the plane across the
// hinges, as complex numbers that the upper hinge turns by e^(i theta), with thigh p_1 (hip to knee), shank p_2 (knee to foot) as they stand and the
// way w of the foot:
//
//     |p_1 + p_2 e^(i l)| = |p_1 + p_2 + w|            (the law of cosines; the knee stays bent the way it is)
//     e^(i k) = (p_1 + p_2 + w) / (p_1 + p_2 e^(i l))
//
// k and l are how far the upper and the lower hinge turn from where they stand.
#include <complex>

#include "base/param_table.h"
#include "base/params.h"

namespace mortise::model {
class Model;
}

namespace mortise::effects::drive {

extern const ParamTable gait_table;

class Gait {
 public:
  // Of the drive of `joint`, one of the two hinges that the block names. Throws Error(Exit::scene).
  Gait(const Params& block, const model::Model& model, Index joint);
  double operator()(double t) const;  // [rad]

 private:
  using Complex = std::complex<double>;
  Complex way(double s, double r) const;
  double turn(const Complex& way) const;
  void check(const Params& block) const;

  double period_, duty_, stride_, clearance_, depth_, phase_, begin_, ramp_;
  Complex forward_, up_, thigh_, shank_;  // the first two of unit length, the others [m]
  double bend_;                           // from thigh to shank as they stand [rad]
  double stands_, sense_;                 // of the joint: its angle in the scene [rad], and +1 or -1 where it is counted the other way
  bool upper_;
};

}  // namespace mortise::effects::drive
