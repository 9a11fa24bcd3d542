#pragma once
// The angle of a hinge. At rest A = I in every stiff body, so that with the axis u and two directions e2, e3 (right-handed with it, unit) the body c
// turns against t by
//
//     theta = atan2(s, k),    s = c2 . t3 - c3 . t2,    k = c2 . t2 + c3 . t3,        c_i = A_c e_i,  t_i = A_t e_i  (in the world t_i = e_i)
//
// of rigid bodies on an exact hinge the angle, of strained ones that of the turn which fits both directions best. In complex vectors C = c2 + i c3,
// T = t2 + i t3 it is arg z, z = k + i s = conj(C) . T. Derivatives, with d = (c2, c3, t2, t3) and r^2 = s^2 + k^2:
//
//     grad theta = (k grad s - s grad k) / r^2
//     Hess theta = (k Hess s - s Hess k) / r^2 + [2 s k (grad k grad k^T - grad s grad s^T) + (s^2 - k^2)(grad s grad k^T + grad k grad s^T)] / r^4
//
// theta does not change when all directions turn together, so that a torque on c and its reaction on t add up to nothing; nor when c2 and c3 are
// strained alike, so that at rest a torque only turns its bodies and strains none.
#include "base/angle.h"
#include "linalg/small.h"
#include "linalg/stencils.h"

namespace mortise::model {

struct Hinge {
  Index child, parent;  // first columns (a1) of the two bodies; parent: -1 is the world
  Vec3 e2, e3;
};
inline constexpr int kHingeBlocks = 6;  // the columns of both

// Directions e2, e3 of the axis u.
inline Hinge hinge_about(const Vec3& u, Index child, Index parent) {
  const Vec3 e2 = linalg::any_perpendicular(u);
  return {child, parent, e2, u.cross(e2)};
}

struct HingeDirections {
  Vec3 c2, c3, t2, t3;
};
MORTISE_HD inline HingeDirections directions(const Hinge& h, device::View<const Vec3> q, bool change = false) {
  HingeDirections d{Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  for (int i = 0; i < 3; ++i) d.c2 += h.e2[i] * q[h.child + i], d.c3 += h.e3[i] * q[h.child + i];
  if (h.parent >= 0) {
    for (int i = 0; i < 3; ++i) d.t2 += h.e2[i] * q[h.parent + i], d.t3 += h.e3[i] * q[h.parent + i];
  } else if (!change) {
    d.t2 = h.e2, d.t3 = h.e3;
  }
  return d;
}

MORTISE_HD inline double sine(const HingeDirections& d) { return d.c2.dot(d.t3) - d.c3.dot(d.t2); }
MORTISE_HD inline double cosine(const HingeDirections& d) { return d.c2.dot(d.t2) + d.c3.dot(d.t3); }
MORTISE_HD inline double hinge_angle(const HingeDirections& d) { return angle_of(cosine(d), sine(d)); }  // in (-pi, pi]

// The angle that is nearest to `near` among those of the same position.
MORTISE_HD inline double unwrapped(double angle, double near) {
  constexpr double kTurn = 6.283185307179586;
  return near + (angle - near) - kTurn * std::floor((angle - near) / kTurn + 0.5);
}

// Gradient and Hessian of E(theta) with E' = e1, E'' = e2 >= 0 and the share `concave` of the negative curvature; blocks as directions() reads them.
// hess: null where none is wanted.
MORTISE_HD inline void hinge_stencil(const Hinge& h, const HingeDirections& d, double e1, double e2, double concave, Index* block, Vec3* grad,
                                     Mat3* hess) {
  using Vec12 = linalg::VecN<12>;
  using Mat12 = linalg::MatN<12>;
  const double s = sine(d), k = cosine(d), r2 = s * s + k * k;
  Vec12 ds, dk;
  for (int i = 0; i < 3; ++i) {
    ds[i] = d.t3[i], ds[3 + i] = -d.t2[i], ds[6 + i] = -d.c3[i], ds[9 + i] = d.c2[i];
    dk[i] = d.t2[i], dk[3 + i] = d.t3[i], dk[6 + i] = d.c2[i], dk[9 + i] = d.c3[i];
  }
  if (h.parent < 0)
    for (int i = 6; i < 12; ++i) ds[i] = dk[i] = 0;
  Vec12 g;
  for (int i = 0; i < 12; ++i) g[i] = (k * ds[i] - s * dk[i]) / r2;
  // Weights of the bodies' columns in the four directions.
  const auto weight = [&](int b, int direction) { return direction / 2 != b / 3 ? 0.0 : (direction % 2 == 0 ? h.e2 : h.e3)[b % 3]; };
  for (int b = 0; b < kHingeBlocks; ++b) {
    block[b] = b < 3 ? h.child + b : h.parent < 0 ? -1 : h.parent + b - 3;
    const int first = 6 * (b / 3);
    for (int i = 0; i < 3; ++i) grad[b][i] = e1 * (h.e2[b % 3] * g[first + i] + h.e3[b % 3] * g[first + 3 + i]);
  }
  if (!hess) return;
  Mat12 H;
  const double both = 2 * s * k / (r2 * r2), mixed = (s * s - k * k) / (r2 * r2);
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j) H(i, j) = e1 * (both * (dk[i] * dk[j] - ds[i] * ds[j]) + mixed * (ds[i] * dk[j] + dk[i] * ds[j]));
  // k: c2 with t2, c3 with t3; s: c2 with t3, c3 with t2 and a minus.
  if (h.parent >= 0)
    for (int i = 0; i < 3; ++i) {
      const double of_k = -e1 * s / r2, of_s = e1 * k / r2;
      H(i, 6 + i) += of_k, H(6 + i, i) += of_k, H(3 + i, 9 + i) += of_k, H(9 + i, 3 + i) += of_k;
      H(i, 9 + i) += of_s, H(9 + i, i) += of_s, H(3 + i, 6 + i) -= of_s, H(6 + i, 3 + i) -= of_s;
    }
  Mat12 convex = H;
  linalg::project_psd<12>(convex);
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j) H(i, j) = convex(i, j) + concave * (H(i, j) - convex(i, j)) + e2 * g[i] * g[j];
  for (int a = 0, place = 0; a < kHingeBlocks; ++a)
    for (int b = a; b < kHingeBlocks; ++b, ++place) {
      Mat3 piece = Mat3::Zero();
      for (int p = 0; p < 4; ++p)
        for (int q = 0; q < 4; ++q) {
          const double w = weight(a, p) * weight(b, q);
          if (w == 0) continue;
          for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) piece(i, j) += w * H(3 * p + i, 3 * q + j);
        }
      hess[place] = piece;
    }
}

// The least alpha in (0, 1] at which f = c0 + c1 alpha + c2 alpha^2, c0 <= 0, is no longer negative; above 1 if there is none.
MORTISE_HD inline double first_root(double c0, double c1, double c2) {
  constexpr double kNone = 2;
  if (!(c0 < 0)) return 0;
  if (c1 <= 0 && c2 <= 0) return kNone;
  const double disc = c1 * c1 - 4 * c2 * c0;
  if (disc < 0) return kNone;
  // Both forms of the solution, each where nothing cancels; of two positive ones the smaller.
  const double root = std::sqrt(disc);
  if (c2 > 0) return c1 > 0 ? -2 * c0 / (c1 + root) : (root - c1) / (2 * c2);
  return -2 * c0 / (c1 + root);
}

// How far one may go along the change `w` of the directions d before the angle has turned by `up` > 0 or by -`down` < 0, each at most kFarthest: up
// to the rays at those angles, which the quadratic z(alpha) crosses.
inline constexpr double kFarthest = 2.9;  // [rad]: short of a half turn, behind which an angle is its own opposite
MORTISE_HD inline double hinge_way(const HingeDirections& d, const HingeDirections& w, double up, double down) {
  const double k0 = cosine(d), s0 = sine(d);
  const double k1 = w.c2.dot(d.t2) + w.c3.dot(d.t3) + d.c2.dot(w.t2) + d.c3.dot(w.t3),
               s1 = w.c2.dot(d.t3) - w.c3.dot(d.t2) + d.c2.dot(w.t3) - d.c3.dot(w.t2);
  const double k2 = cosine(w), s2 = sine(w);
  // z conj(z0)
  const double x[3] = {k0 * k0 + s0 * s0, k1 * k0 + s1 * s0, k2 * k0 + s2 * s0}, y[3] = {0, s1 * k0 - k1 * s0, s2 * k0 - k2 * s0};
  double alpha = 2;
  for (int side = -1; side <= 1; side += 2) {
    const double wanted = side > 0 ? up : down, turn = wanted < kFarthest ? wanted : kFarthest;
    const Turn ray = turn_by(turn);
    const double a = first_root(-ray.sin * x[0], side * ray.cos * y[1] - ray.sin * x[1], side * ray.cos * y[2] - ray.sin * x[2]);
    if (a < alpha) alpha = a;
  }
  return alpha;
}

}  // namespace mortise::model
