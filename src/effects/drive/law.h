#pragma once
// What acts about the coordinate theta of a joint in a step of length h that began at theta_n; x = theta - theta_n is the way and
//     v = pace x + drift
// the rate, as the scene's integrator has it (effects/integrator.h): with backward Euler pace = 1/h and drift = 0, with BDF2 a0/h and what the step
// before says.
//
// A motor wants the torque a - K x, and gives what it can:
//     pd       a = kp (target - theta_n) - kd drift,  K = kp + kd pace:        kp (target - theta) - kd v, all at the end of the step
//     effort   a = the given torque,       K = 0
//     tau(x) = max(-most(-v), min(most(v), a - K x)),     most(v) = effort clamp((velocity - v) / (kRamp velocity), 0, 1):
// no more than `effort` either way, and none that would drive the joint beyond `velocity`; a joint that is pushed beyond it is not pushed further,
// and braked as the law wants. tau is continuous, piecewise linear and never increases, so
//     E(x) = - int_0^x tau                              (trapezoids between the kinks: exact)
// is convex and once continuously differentiable. Bearings add, with D viscous damping and F dry friction, e = creep h, and s from the last step what
// is left of x + s there, e at most: what is held rests (as in friction/anchors.h), by the law of friction/law.h:
//     D v^2 / (2 pace)     and     F (f0(|x + s|) - e/3),
// a spring in the joint with its ease at theta_0, and a rotor of inertia J (already times the square of its gear), whose acceleration is
// pace (v - v_hat), v_hat from the rates before (with backward Euler v_n),
//     S (theta_n + x - theta_0)^2 / 2     and     J (v - v_hat)^2 / 2.
// What of it is held, and comes back: that spring, the motion of the rotor, and a motor of mode pd, which as long as its target stays is a spring
// too,
//     S (theta - theta_0)^2 / 2 + J v^2 / 2 + U(target - theta),     U(y) = int_0^y min(effort, kp s) ds.
// Units: theta rad, torques N m, kp and S N m/rad, kd and D N m s/rad, J kg m^2; of a slide m, N, N/m, N s/m, kg.
#include <cmath>

#include "base/types.h"
#include "effects/drive/tuning.h"
#include "effects/friction/law.h"

namespace mortise::effects::drive {

using tuning::kRamp;

MORTISE_HD inline double clamp01(double t) { return t < 0 ? 0.0 : t > 1 ? 1.0 : t; }

// U: of a spring of stiffness kp that never pulls with more than `effort`.
MORTISE_HD inline double limited_spring(double kp, double effort, double y) {
  const double pull = kp * std::fabs(y);
  return pull <= effort ? 0.5 * pull * std::fabs(y) : effort * (std::fabs(y) - 0.5 * effort / kp);
}

struct Law {
  double a = 0, K = 0;
  double kp = 0, aim = 0;  // of mode pd; target - theta_n
  double effort = INFINITY, velocity = INFINITY;
  double pace = 1, drift = 0, h = 1;
  double damping = 0, dry = 0, creep = tuning::kCreep, stick = 0;  // dry: F; stick: s
  double stiffness = 0, stretch = 0;                               // S; theta_n - theta_0
  double armature = 0, rate = 0;                                   // J; v_hat
  double left = 0;  // what a law of finite steps leaves out, where that is mended, against the motion [N m]

  MORTISE_HD double rate_of(double x) const { return pace * x + drift; }
  MORTISE_HD double effort_limit(double v) const { return velocity < INFINITY ? effort * clamp01((velocity - v) / (kRamp * velocity)) : effort; }
  MORTISE_HD double motor(double x) const {
    const double v = rate_of(x), hi = effort_limit(v), lo = -effort_limit(-v), wanted = a - K * x;
    return wanted > hi ? hi : wanted < lo ? lo : wanted;
  }
  // - d tau / dx
  MORTISE_HD double motor_falls(double x) const {
    const double v = rate_of(x), hi = effort_limit(v), lo = -effort_limit(-v), wanted = a - K * x;
    if (wanted <= hi && wanted >= lo) return K;
    const double rate = wanted > hi ? v : -v;
    return rate > (1 - kRamp) * velocity && rate < velocity ? effort * pace / (kRamp * velocity) : 0;
  }
  MORTISE_HD double motor_energy(double x) const {
    double kink[9] = {};
    int n = 0;
    const auto add = [&](double at) {
      if (!(at * x > 0 && std::fabs(at) < std::fabs(x))) return;
      int i = n++;
      for (; i > 0 && std::fabs(kink[i - 1]) > std::fabs(at); --i) kink[i] = kink[i - 1];
      kink[i] = at;
    };
    if (velocity < INFINITY) {
      const double slope = effort * pace / (kRamp * velocity), at_rest = effort / kRamp;  // most = at_rest - slope v / pace on the ramp
      for (int side = -1; side <= 1; side += 2) {
        add((side * velocity - drift) / pace), add((side * (1 - kRamp) * velocity - drift) / pace);
        if (K != slope) add((a - side * at_rest + slope * drift / pace) / (K - slope));
      }
    }
    if (K > 0) {
      add(a / K);
      if (effort < INFINITY) add((a - effort) / K), add((a + effort) / K);
    }
    double sum = 0, from = 0, tau = motor(0);
    for (int i = 0; i <= n; ++i) {
      const double to = i < n ? kink[i] : x, there = motor(to);
      sum += 0.5 * (tau + there) * (to - from);
      from = to, tau = there;
    }
    return -sum;
  }

  // Of bearing, spring and rotor, against the motion [N m].
  MORTISE_HD double drag(double x) const {
    const double f = friction::f1(std::fabs(x + stick), creep * h);
    const double bearing = damping * rate_of(x) + left + (x + stick < 0 ? -1 : 1) * dry * f;
    return stiffness == 0 && armature == 0 ? bearing : bearing + stiffness * (stretch + x) + armature * pace * (rate_of(x) - rate);
  }
  MORTISE_HD double energy_of(double x) const {
    const double e = creep * h, v = rate_of(x);
    const double all = motor_energy(x) + 0.5 * damping * v * v / pace + left * x + dry * (friction::f0(std::fabs(x + stick), e) - e / 3);
    if (stiffness == 0 && armature == 0) return all;
    const double s = stretch + x;
    return all + 0.5 * stiffness * s * s + 0.5 * armature * (v - rate) * (v - rate);
  }
  MORTISE_HD double stored(double x) const {
    const double s = stretch + x, v = rate_of(x);
    return 0.5 * stiffness * s * s + 0.5 * armature * v * v + limited_spring(kp, effort, aim - x);
  }
  // Of first_of(x) the part that does that [N m].
  MORTISE_HD double storing(double x) const {
    const double pull = kp * (aim - x), most = pull < -effort ? -effort : pull > effort ? effort : pull;
    return stiffness * (stretch + x) + armature * pace * (rate_of(x) - rate) - most;
  }
  MORTISE_HD double first_of(double x) const { return drag(x) - motor(x); }
  MORTISE_HD double second_of(double x) const {
    const double all = motor_falls(x) + damping * pace + dry * friction::f1_rises(std::fabs(x + stick), creep * h);
    return stiffness == 0 && armature == 0 ? all : all + stiffness + armature * pace * pace;
  }
};

// The same of the angle itself, as hinges want it.
struct At {
  double begin = 0;  // theta_n
  Law law;
  MORTISE_HD double energy(double theta) const { return law.energy_of(theta - begin); }
  MORTISE_HD double first(double theta) const { return law.first_of(theta - begin); }
  MORTISE_HD double second(double theta) const { return law.second_of(theta - begin); }
  MORTISE_HD double stored(double theta) const { return law.stored(theta - begin); }
  MORTISE_HD double storing(double theta) const { return law.storing(theta - begin); }
  MORTISE_HD double up(double) const { return INFINITY; }
  MORTISE_HD double down(double) const { return INFINITY; }
};

}  // namespace mortise::effects::drive
