#pragma once
// One contact stencil: k b(d) or, for edge pairs, k m(c) b(d), as a function of four points x, with gradient and Hessian.
//
// The distance is d = |r|, r = sum_i w_i x_i = d n (geometry/collide/distance.h: w'_j are the derivatives of w by the free
// parameters of the closest point, e_j = sum_i w'_j,i x_i are tangents with e_j . n = 0). Then
//     grad = b' w (x) n
//     Hess = b'' (w(x)n)(w(x)n)^T + (b'/d) [ w w^T (x) (I - n n^T) - B G^-1 B^T ],     B_j = w'_j (x) r + w (x) e_j.
// With orthonormal tangents t_j = sum_l e_l (R^-1)_lj and u_j = sum_l w'_l (R^-1)_lj (QR of the e_l), B R^-1 = w(x)t_j + d
// u_j(x)n, the terms w w^T (x) t_j t_j^T cancel, and the second part becomes, with beta = -b' >= 0,
//     beta sum_j [ (w(x)t_j)(u_j(x)n)^T + (u_j(x)n)(w(x)t_j)^T + d (u_j(x)n)(u_j(x)n)^T ]  -  beta/d sum_free w w^T (x) t t^T,
// where the last sum runs over the tangents that no parameter covers (0 for faces and crossing edges, 1 for a point on an edge, 2
// for two points). Turning the t_j in their plane so that u_1 . u_2 = 0 leaves orthogonal 2x2 problems
//     beta [ 0  p ; p  q ],   p = |w| |u_j|,  q = d |u_j|^2,   eigenvalues beta (q/2 +- sqrt(q^2/4 + p^2)),
// so the whole Hessian is a sum of at most 5 rank-one terms with known signs. Dropping the negative ones projects the second part
// exactly, without an eigenvalue solver.
#include "base/types.h"
#include "effects/contact/barrier.h"
#include "geometry/collide/distance.h"

namespace mortise::effects::contact {

using geometry::Closest;

// Distance, unit normal and the rotated tangent frame of a classified pair.
struct Frame {
  int free = 0;
  double w[4];
  double d = 0;
  Vec3 n;
  Vec3 t[2];       // the first `free` belong to u
  double u[2][4];  // [1/m]
};

// Cosine and sine of half the angle of (p, q), an angle in (-pi, pi]; the one without cancellation from 2 cos^2 = 1 + p/h or 2 sin^2 = 1 - p/h.
MORTISE_HD inline void half_angle(double p, double q, double& cs, double& sn) {
  const double h = std::sqrt(p * p + q * q);
  cs = 1, sn = 0;
  if (!(h > 0)) return;
  if (p >= 0) {
    cs = std::sqrt(0.5 * (1 + p / h));
    sn = q / (2 * h * cs);
  } else {
    sn = std::sqrt(0.5 * (1 - p / h));
    cs = q / (2 * h * sn);
    if (cs < 0) cs = -cs, sn = -sn;
  }
}

MORTISE_HD inline Frame frame(const Closest& c, const Vec3 x[4]) {
  Frame f;
  f.free = c.free;
  for (int i = 0; i < 4; ++i) f.w[i] = c.w[i], f.u[0][i] = f.u[1][i] = 0;
  const Vec3 r = geometry::combine(c.w, x);
  if (c.free == 2) {
    const Vec3 e1 = geometry::combine(c.dw[0], x), e2 = geometry::combine(c.dw[1], x);
    // n from the tangents: exact direction however small d is.
    f.n = e1.cross(e2);
    f.n /= f.n.norm();
    f.d = f.n.dot(r);
    if (f.d < 0) f.n = -f.n, f.d = -f.d;
    const double r11 = e1.norm();
    f.t[0] = e1 / r11;
    f.t[1] = f.n.cross(f.t[0]);
    const double r12 = f.t[0].dot(e2), r22 = f.t[1].dot(e2);
    double a = 0, b = 0, g = 0;  // u_1.u_1, u_1.u_2, u_2.u_2
    for (int i = 0; i < 4; ++i) {
      f.u[0][i] = c.dw[0][i] / r11;
      f.u[1][i] = (c.dw[1][i] - r12 * f.u[0][i]) / r22;
      a += f.u[0][i] * f.u[0][i], b += f.u[0][i] * f.u[1][i], g += f.u[1][i] * f.u[1][i];
    }
    double cs, sn;
    half_angle(a - g, 2 * b, cs, sn);
    for (int i = 0; i < 4; ++i) {
      const double u1 = f.u[0][i], u2 = f.u[1][i];
      f.u[0][i] = cs * u1 + sn * u2;
      f.u[1][i] = cs * u2 - sn * u1;
    }
    const Vec3 t1 = f.t[0], t2 = f.t[1];
    f.t[0] = cs * t1 + sn * t2;
    f.t[1] = cs * t2 - sn * t1;
    return f;
  }
  f.d = r.norm();
  f.n = r / f.d;
  if (c.free == 1) {
    const Vec3 e = geometry::combine(c.dw[0], x);
    const double length = e.norm();
    f.t[0] = e / length;
    for (int i = 0; i < 4; ++i) f.u[0][i] = c.dw[0][i] / length;
  } else {
    // any direction across n
    const double ax = std::abs(f.n[0]), ay = std::abs(f.n[1]), az = std::abs(f.n[2]);
    const Vec3 axis = ax <= ay && ax <= az ? Vec3::UnitX() : ay <= az ? Vec3::UnitY() : Vec3::UnitZ();
    f.t[0] = f.n.cross(axis);
    f.t[0] /= f.t[0].norm();
  }
  f.t[1] = f.n.cross(f.t[0]);
  return f;
}

// Rank-one terms of scale * Hess b(d): add(c, v) is called with v a 3-vector per point, H += c v v^T.
template <class Add>
MORTISE_HD inline void barrier_hessian(const Frame& f, double scale, double b1, double b2, Add& add) {
  Vec3 v[4];
  for (int i = 0; i < 4; ++i) v[i] = f.w[i] * f.n;
  add(scale * b2, v);
  double ww = 0;
  for (int i = 0; i < 4; ++i) ww += f.w[i] * f.w[i];
  const double w = std::sqrt(ww), beta = -b1;
  for (int j = 0; j < 2; ++j) {
    if (j >= f.free) {
      for (int i = 0; i < 4; ++i) v[i] = f.w[i] * f.t[j];
      add(-scale * beta / f.d, v);
      continue;
    }
    double uu = 0;
    for (int i = 0; i < 4; ++i) uu += f.u[j][i] * f.u[j][i];
    const double u = std::sqrt(uu), p = w * u, q = f.d * uu;
    const double plus = q / 2 + std::sqrt(q * q / 4 + p * p);
    for (int sign = 0; sign < 2; ++sign) {
      const double mu = sign == 0 ? plus : -p * p / plus;
      const double length = std::sqrt(p * p + mu * mu);  // eigenvector (p, mu) in the basis w(x)t/|w|, u(x)n/|u|
      for (int i = 0; i < 4; ++i) v[i] = (p / (w * length) * f.w[i]) * f.t[j] + (mu / (u * length) * f.u[j][i]) * f.n;
      add(scale * beta * mu, v);
    }
  }
}

// Mollifier of nearly parallel edges x = {a0, a1, b0, b1} (Li et al. 2020, eq. 24): s = c/eps, c = |X|^2, X = u x v, u = a1-a0,
// v = b1-b0,  m = s (2 - s) for s < 1. Rank-one terms of Hess (m b):
//     m Hess b  +  (m'/eps) b' (gc gd^T + gd gc^T)  +  (m''/eps^2) b gc gc^T  +  (m'/eps) b Hess c,
//     gc_u = 2 v x X,  gc_v = 2 X x u,  gd = w (x) n,
//     Hess c = 2 sum_i grad X_i grad X_i^T + 2 X . d2X;  the last part is |X| times four squares in a frame across X.
struct Mollifier {
  double m = 1, m1 = 0, m2 = 0;  // m and its derivatives by c
  Vec3 u = Vec3::Zero(), v = Vec3::Zero(), X = Vec3::Zero();
};

MORTISE_HD inline Mollifier mollifier(const Vec3 x[4], double eps) {
  Mollifier k;
  k.u = x[1] - x[0], k.v = x[3] - x[2];
  k.X = k.u.cross(k.v);
  const double s = k.X.squaredNorm() / eps;
  if (s < 1) k.m = s * (2 - s), k.m1 = 2 * (1 - s) / eps, k.m2 = -2 / (eps * eps);
  return k;
}

MORTISE_HD inline void spread(const Vec3& a, const Vec3& b, Vec3 v[4]) { v[0] = -a, v[1] = a, v[2] = -b, v[3] = b; }

template <class Add>
MORTISE_HD inline void mollifier_hessian(const Frame& f, const Mollifier& k, double scale, double b, double b1, Add& add) {
  Vec3 gc[4], v[4];
  spread(2 * k.v.cross(k.X), 2 * k.X.cross(k.u), gc);
  add(scale * k.m2 * b, gc);
  double cc = 0, dd = 0;
  for (int i = 0; i < 4; ++i) cc += gc[i].squaredNorm(), dd += f.w[i] * f.w[i];
  const double lc = std::sqrt(cc), ld = std::sqrt(dd);
  if (lc > 0) {  // p q^T + q p^T = |p||q|/2 [ (p^+q^)(p^+q^)^T - (p^-q^)(p^-q^)^T ]
    const double half = scale * k.m1 * b1 * lc * ld / 2;
    for (int i = 0; i < 4; ++i) v[i] = gc[i] / lc + f.w[i] / ld * f.n;
    add(half, v);
    for (int i = 0; i < 4; ++i) v[i] = gc[i] / lc - f.w[i] / ld * f.n;
    add(-half, v);
  }
  const double h = scale * k.m1 * b;
  for (int i = 0; i < 3; ++i) {
    const Vec3 axis = Vec3::Unit(i);
    spread(k.v.cross(axis), axis.cross(k.u), v);
    add(2 * h, v);
  }
  const double length = k.X.norm();
  if (!(length > 0)) return;
  // X . (du x dv) = |X| [ (du.t1)(dv.t2) - (du.t2)(dv.t1) ],  t1 x t2 = X/|X|,  and 4 ab = (a+b)^2 - (a-b)^2
  const Vec3 t1 = k.u / k.u.norm(), t2 = (k.X / length).cross(t1);
  spread(t1, t2, v), add(h * length, v);
  spread(t1, -t2, v), add(-h * length, v);
  spread(t2, t1, v), add(-h * length, v);
  spread(t2, -t1, v), add(h * length, v);
}

// Value of scale * [m] b(d); gradient per point. eps > 0 asks for the mollifier. add(c, v) receives the Hessian's rank-one terms
// when `hessian`. The frame used is returned through f.
template <class Add>
MORTISE_HD inline double evaluate(const Closest& c, const Vec3 x[4], double d_hat, double scale, double eps, bool hessian, Frame& f, Vec3 grad[4],
                                  Add& add) {
  f = frame(c, x);
  const double b = barrier::value(f.d, d_hat), b1 = barrier::first(f.d, d_hat);
  Mollifier k;
  if (eps > 0) k = mollifier(x, eps);
  for (int i = 0; i < 4; ++i) grad[i] = (scale * k.m * b1 * f.w[i]) * f.n;
  if (k.m1 > 0) {
    Vec3 gc[4];
    spread(2 * k.v.cross(k.X), 2 * k.X.cross(k.u), gc);
    for (int i = 0; i < 4; ++i) grad[i] += (scale * k.m1 * b) * gc[i];
  }
  if (hessian) {
    barrier_hessian(f, scale * k.m, b1, barrier::second(f.d, d_hat), add);
    if (k.m1 > 0) mollifier_hessian(f, k, scale, b, b1, add);
  }
  return scale * k.m * b;
}

}  // namespace mortise::effects::contact
