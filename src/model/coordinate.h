#pragma once
// The coordinate of a joint as a function of the blocks of its two bodies: the angle of a hinge (model/hinge.h), or the way of a slide,
//
//     s = U . d / U . U,     U = A_t u,   d = p_c - p_t - A_t X        c: the body that slides; X: its centre at rest, from that of t
//
// (in the world U = u, and d is counted from the centre at rest): how far it has gone along the axis of t, which is as strained as t. With N = U . d
// and D = U . U exactly
//
//     dN/dp_c = U,  dN/dp_t = -U,  dN/da_k = u_k d - X_k U,     d2N: u_k I of (p_c, a_k), -u_k I of (p_t, a_k), -(u_k X_l + u_l X_k) I of (a_k, a_l)
//     dD/da_k = 2 u_k U,     d2D: 2 u_k u_l I of (a_k, a_l)
//     ds = (dN - s dD) / D,     d2s = (d2N - s d2D - ds dD^T - dD ds^T) / D:
//
// forces on both bodies without sum or moment.
#include "model/hinge.h"

namespace mortise::model {

struct Coordinate {
  bool slides = false;
  Hinge hinge{};
  // Of a slide:
  Index slider = -1, carrier = -1;  // first blocks (p) of c and t; -1: the world
  Vec3 u, X;                        // in the world X is the centre at rest
  double at_rest = 0, before = 0;   // the coordinate at rest; at the last accepted state, from which turns are counted
  bool carried_freely = false;      // t moves, and is no obstacle that others move
  MORTISE_HD Index any_block() const { return slides ? slider : hinge.child; }
};
inline constexpr int kCoordinateBlocks = kHingeBlocks;  // a slide leaves one unused

// What it depends on: directions of a hinge; d (as c2) and U (as c3) of a slide. change: of a way dq instead of positions.
MORTISE_HD inline HingeDirections reading(const Coordinate& c, device::View<const Vec3> q, bool change = false) {
  if (!c.slides) return directions(c.hinge, q, change);
  HingeDirections r{q[c.slider], Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  if (c.carrier < 0) {
    if (!change) r.c2 -= c.X, r.c3 = c.u;
    return r;
  }
  r.c2 -= q[c.carrier];
  for (int k = 0; k < 3; ++k) r.c2 -= c.X[k] * q[c.carrier + 1 + k], r.c3 += c.u[k] * q[c.carrier + 1 + k];
  return r;
}

MORTISE_HD inline double coordinate(const Coordinate& c, const HingeDirections& r) {
  return c.slides ? c.at_rest + r.c2.dot(r.c3) / r.c3.dot(r.c3) : unwrapped(c.at_rest + hinge_angle(r), c.before);
}

// Its rate where what it depends on has the rate w: of atan2(s, k) it is (k s' - s k') / (k^2 + s^2).
MORTISE_HD inline double coordinate_rate(const Coordinate& c, const HingeDirections& r, const HingeDirections& w) {
  if (c.slides) {
    const double D = r.c3.dot(r.c3), s = r.c2.dot(r.c3) / D;
    return (w.c2.dot(r.c3) + r.c2.dot(w.c3) - 2 * s * r.c3.dot(w.c3)) / D;
  }
  const double s = sine(r), k = cosine(r);
  const double s1 = w.c2.dot(r.t3) - w.c3.dot(r.t2) + r.c2.dot(w.t3) - r.c3.dot(w.t2);
  const double k1 = w.c2.dot(r.t2) + w.c3.dot(r.t3) + r.c2.dot(w.t2) + r.c3.dot(w.t3);
  return (k * s1 - s * k1) / (k * k + s * s);
}

// Gradient and Hessian of E of the coordinate, as hinge_stencil. Negative curvature of a slide is of t alone and of t with c: none where t is given.
MORTISE_HD inline void coordinate_stencil(const Coordinate& c, const HingeDirections& r, double e1, double e2, double concave, Index* block,
                                          Vec3* grad, Mat3* hess) {
  if (!c.slides) return hinge_stencil(c.hinge, r, e1, e2, concave, block, grad, hess);
  const double D = r.c3.dot(r.c3), s = r.c2.dot(r.c3) / D;
  // c, t, a1, a2, a3, unused
  Vec3 g[kCoordinateBlocks], stretch[kCoordinateBlocks];  // ds, dD
  for (int b = 0; b < kCoordinateBlocks; ++b) {
    const bool used = b == 0 || (b < 5 && c.carrier >= 0), column = used && b >= 2;
    block[b] = !used ? -1 : b == 0 ? c.slider : c.carrier + b - 1;
    stretch[b] = column ? Vec3(2 * c.u[b - 2] * r.c3) : Vec3(Vec3::Zero());
    const Vec3 dN = column ? Vec3(c.u[b - 2] * r.c2 - c.X[b - 2] * r.c3) : b == 0 ? r.c3 : used ? Vec3(-r.c3) : Vec3(Vec3::Zero());
    g[b] = (dN - s * stretch[b]) / D;
    grad[b] = e1 * g[b];
  }
  if (!hess) return;
  const double k = e1 / D;
  linalg::MatN<kCoordinateBlocks> S;  // e1 d2s = S I - k (ds dD^T + dD ds^T)
  for (int a = 0; a < kCoordinateBlocks; ++a)
    for (int b = 0; b < kCoordinateBlocks; ++b) S(a, b) = 0;
  for (int i = 0; i < 3 && c.carrier >= 0; ++i) {
    S(0, 2 + i) = S(2 + i, 0) = k * c.u[i], S(1, 2 + i) = S(2 + i, 1) = -k * c.u[i];
    for (int l = 0; l < 3; ++l) S(2 + i, 2 + l) = -k * (c.u[i] * c.X[l] + c.u[l] * c.X[i] + 2 * s * c.u[i] * c.u[l]);
  }
  const double share = c.carried_freely ? concave : 1;
  if (c.carried_freely) {
    linalg::MatN<kCoordinateBlocks> convex = S;
    linalg::project_psd<kCoordinateBlocks>(convex);
    for (int a = 0; a < kCoordinateBlocks; ++a)
      for (int b = 0; b < kCoordinateBlocks; ++b) S(a, b) = convex(a, b) + share * (S(a, b) - convex(a, b));
  }
  // -k (g h^T + h g^T) = |k| / 2 [(w g - h/w)(w g - h/w)^T - (w g + h/w)(w g + h/w)^T] for k > 0; a small w leaves most to h, where t is stiff.
  constexpr double kAlong = 0.125;
  const double sign = k < 0 ? -1 : 1, half = 0.5 * sign * k;
  for (int a = 0, place = 0; a < kCoordinateBlocks; ++a)
    for (int b = a; b < kCoordinateBlocks; ++b, ++place) {
      const Vec3 ga = kAlong * g[a], gb = kAlong * g[b], ha = sign / kAlong * stretch[a], hb = sign / kAlong * stretch[b];
      hess[place] = e2 * g[a] * g[b].transpose() + S(a, b) * Mat3::Identity();
      hess[place] += half * ((ga - ha) * (gb - hb).transpose() - share * ((ga + ha) * (gb + hb).transpose()));
    }
}

// How far one may go along the change w before the coordinate x has grown by `up` or fallen by `down`.
MORTISE_HD inline double coordinate_way(const Coordinate& c, const HingeDirections& r, const HingeDirections& w, double x, double up, double down) {
  if (!c.slides) {
    const double most_up = kFarthest - (x - c.before), most_down = kFarthest + (x - c.before);
    return hinge_way(r, w, up < most_up ? up : most_up, down < most_down ? down : most_down);
  }
  // N - (s + up) D and its likeness are quadratic along the way.
  const double D = r.c3.dot(r.c3), first = w.c2.dot(r.c3) + r.c2.dot(w.c3), second = w.c2.dot(w.c3);
  const double D1 = 2 * r.c3.dot(w.c3), D2 = w.c3.dot(w.c3), high = x - c.at_rest + up, low = x - c.at_rest - down;
  double alpha = 2;
  if (up < INFINITY) alpha = first_root(-up * D, first - high * D1, second - high * D2);
  if (down < INFINITY) {
    const double a = first_root(-down * D, low * D1 - first, low * D2 - second);
    if (a < alpha) alpha = a;
  }
  return alpha;
}

}  // namespace mortise::model
