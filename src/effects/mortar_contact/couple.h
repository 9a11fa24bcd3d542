#pragma once
// A slave and a master triangle as the program that takes samples sees them: what they are to each other, in variables that may carry derivatives,
// and how those move with the corners of both.
#include "effects/mortar_contact/neighbours.h"

namespace mortise::effects::mortar {

// What a slave and a master triangle are to each other: for every corner k of the master its barycentrics L_k1, L_k2 and its height [m], then the
// slave's corners (l, 0) and (a, b) in axes of its own [m], c = -n . n_master, and how the slave is bent over its sides.
inline constexpr int kOfCorner = 3, kLength = 9, kAlong = 10, kAcross = 11, kCosine = 12, kBend = 13, kVariables = 16;
// A kernel with all of their derivatives at once has polygons that no GPU's registers or caches hold; the CPU likes few rounds.
inline constexpr int kTogether = 4, kRounds = (kVariables + kTogether - 1) / kTogether;
using J = Jet<kTogether>;

// A slave and a master triangle, and how the variables move with their corners.
struct Couple {
  const Patch& p;
  const Facing& f;
  Frame slave, master;
  Vec3 t1, t2;  // the slave's axes
  double l, a, b;

  MORTISE_HD Couple(const Patch& patch, const Facing& facing, const Vec3 corner[3])
      : p(patch), f(facing), slave(patch.plane.e1, patch.plane.e2), master(corner[1] - corner[0], corner[2] - corner[0]) {
    l = p.plane.e1.norm(), t1 = p.plane.e1 / l, t2 = slave.n.cross(t1);
    a = p.plane.e2.dot(t1), b = p.plane.e2.dot(t2);
  }

  // The variables, of which those of a round carry derivatives.
  MORTISE_HD J variable(double value, int i, int round) const {
    const int at = i - round * kTogether;
    return at >= 0 && at < kTogether ? J::variable(value, at) : J(value);
  }
  MORTISE_HD void see(int round, SlaveOf<J>& s, FacingOf<J>& over) const {
    s.slave = p.slave, s.support = p.support, s.reach = p.reach;
    for (int k = 0; k < 3; ++k) s.bend[k] = variable(p.bend[k], kBend + k, round);
    const J x1 = variable(l, kLength, round), x2 = variable(a, kAlong, round), y2 = variable(b, kAcross, round);
    const J zero = 0.0;
    s.y[0] = Vec3Of<J>(zero, zero, zero), s.y[1] = Vec3Of<J>(x1, zero, zero), s.y[2] = Vec3Of<J>(x2, y2, zero);
    s.area = 0.5 * (x1 * y2);
    s.area.a = p.area;
    for (int k = 0; k < 3; ++k) {
      for (int i = 1; i < 3; ++i) over.L[k][i] = variable(f.L[k][i], kOfCorner * k + i - 1, round);
      over.L[k][0] = 1 - over.L[k][1] - over.L[k][2];
      over.L[k][0].a = f.L[k][0];
      over.height[k] = variable(f.height[k], kOfCorner * k + 2, round);
    }
    over.cosine = variable(f.cosine, kCosine, round);
  }

  // z_i of a round, 0 of others.
  MORTISE_HD static double of_round(const double* z, int i, int round) {
    const int at = i - round * kTogether;
    return at >= 0 && at < kTogether ? z[at] : 0.0;
  }
  // Adds sum_i z_i d(variable i) to `on` and `under`, by places of the slave's and the master's corners. What it is bent by is others'.
  MORTISE_HD void pull(const double* z, int round, Vec3 on[3], Vec3 under[3]) const {
    const auto of = [&](int i) { return of_round(z, i, round); };
    Vec3 e1 = Vec3::Zero(), e2 = Vec3::Zero();  // by sides of the slave
    for (int k = 0; k < 3; ++k) {
      // x_k = sum_a L_ka y_a + h n:  dL_ki = g_i . (dx_k - sum_a L_ka dy_a - h dn),  dh = n . (dx_k - sum_a L_ka dy_a)
      const Vec3 t = of(kOfCorner * k) * slave.g[0] + of(kOfCorner * k + 1) * slave.g[1], v = t + of(kOfCorner * k + 2) * slave.n;
      under[k] += v;
      for (int i = 0; i < 3; ++i) on[i] -= f.L[k][i] * v;
      e1 += f.height[k] * t.dot(slave.g[0]) * slave.n, e2 += f.height[k] * t.dot(slave.g[1]) * slave.n;
    }
    // l = |e1|, e2 = a t1 + b t2
    e1 += of(kLength) * t1 + (of(kAlong) * b - of(kAcross) * a) / l * t2;
    e2 += of(kAlong) * t1 + of(kAcross) * t2;
    // dc = -dn . n_m - n . dn_m
    const double c = of(kCosine);
    e1 += c * slave.g[0].dot(master.n) * slave.n, e2 += c * slave.g[1].dot(master.n) * slave.n;
    const Vec3 E1 = c * master.g[0].dot(slave.n) * master.n, E2 = c * master.g[1].dot(slave.n) * master.n;
    under[1] += E1, under[2] += E2, under[0] -= E1 + E2;
    on[1] += e1, on[2] += e2, on[0] -= e1 + e2;
  }
};

}  // namespace mortise::effects::mortar
