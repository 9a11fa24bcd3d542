#pragma once
// The coordinate of a joint as a function of the blocks of its two bodies: the angle of a hinge (model/hinge.h), or the way of a slide,
//
//     s = U . d,     U = A_t u,   d = p_c - p_t - A_t X        c: the body that slides; X: its centre at rest, from that of t
//
// (in the world U = u, and d is counted from the centre at rest). With c tied not to turn against t, and to stay on the line along U, that is how far
// it has gone. Exactly
//
//     ds/dp_c = U,  ds/dp_t = -U,  ds/da_k = u_k d - X_k U,     d2s: u_k I of (p_c, a_k), -u_k I of (p_t, a_k), -(u_k X_l + u_l X_k) I of (a_k, a_l):
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
  return c.slides ? c.at_rest + r.c2.dot(r.c3) : unwrapped(c.at_rest + hinge_angle(r), c.before);
}

// Its rate where what it depends on has the rate w: of atan2(s, k) it is (k s' - s k') / (k^2 + s^2).
MORTISE_HD inline double coordinate_rate(const Coordinate& c, const HingeDirections& r, const HingeDirections& w) {
  if (c.slides) return w.c2.dot(r.c3) + r.c2.dot(w.c3);
  const double s = sine(r), k = cosine(r);
  const double s1 = w.c2.dot(r.t3) - w.c3.dot(r.t2) + r.c2.dot(w.t3) - r.c3.dot(w.t2);
  const double k1 = w.c2.dot(r.t2) + w.c3.dot(r.t3) + r.c2.dot(w.t2) + r.c3.dot(w.t3);
  return (k * s1 - s * k1) / (k * k + s * s);
}

// Gradient and Hessian of E of the coordinate, as hinge_stencil. Negative curvature of a slide is of t alone and of t with c: none where t is given.
MORTISE_HD inline void coordinate_stencil(const Coordinate& c, const HingeDirections& r, double e1, double e2, double concave, Index* block,
                                          Vec3* grad, Mat3* hess) {
  if (!c.slides) return hinge_stencil(c.hinge, r, e1, e2, concave, block, grad, hess);
  // c, t, a1, a2, a3, unused
  Vec3 g[kCoordinateBlocks];
  for (int b = 0; b < kCoordinateBlocks; ++b) {
    const bool used = b == 0 || (b < 5 && c.carrier >= 0);
    block[b] = !used ? -1 : b == 0 ? c.slider : c.carrier + b - 1;
    g[b] = !used ? Vec3(Vec3::Zero()) : b == 0 ? r.c3 : b == 1 ? Vec3(-r.c3) : Vec3(c.u[b - 2] * r.c2 - c.X[b - 2] * r.c3);
    grad[b] = e1 * g[b];
  }
  if (!hess) return;
  linalg::MatN<kCoordinateBlocks> S;  // of e1 d2s, where it is not as it is
  if (c.carried_freely) {
    for (int a = 0; a < kCoordinateBlocks; ++a)
      for (int b = 0; b < kCoordinateBlocks; ++b) S(a, b) = 0;
    for (int k = 0; k < 3; ++k) {
      S(0, 2 + k) = S(2 + k, 0) = e1 * c.u[k], S(1, 2 + k) = S(2 + k, 1) = -e1 * c.u[k];
      for (int l = 0; l < 3; ++l) S(2 + k, 2 + l) = -e1 * (c.u[k] * c.X[l] + c.u[l] * c.X[k]);
    }
    linalg::MatN<kCoordinateBlocks> convex = S;
    linalg::project_psd<kCoordinateBlocks>(convex);
    for (int a = 0; a < kCoordinateBlocks; ++a)
      for (int b = 0; b < kCoordinateBlocks; ++b) S(a, b) = convex(a, b) + concave * (S(a, b) - convex(a, b));
  }
  for (int a = 0, place = 0; a < kCoordinateBlocks; ++a)
    for (int b = a; b < kCoordinateBlocks; ++b, ++place) {
      if (c.carried_freely) {
        hess[place] = e2 * g[a] * g[b].transpose() + S(a, b) * Mat3::Identity();
        continue;
      }
      double same = 0;  // of d2s
      if (c.carrier >= 0 && b >= 2 && b < 5) same = a == 0 ? c.u[b - 2] : a == 1 ? -c.u[b - 2] : -(c.u[a - 2] * c.X[b - 2] + c.u[b - 2] * c.X[a - 2]);
      hess[place] = e2 * g[a] * g[b].transpose() + (e1 * same) * Mat3::Identity();
    }
}

// How far one may go along the change w before the coordinate x has grown by `up` or fallen by `down`.
MORTISE_HD inline double coordinate_way(const Coordinate& c, const HingeDirections& r, const HingeDirections& w, double x, double up, double down) {
  if (!c.slides) {
    const double most_up = kFarthest - (x - c.before), most_down = kFarthest + (x - c.before);
    return hinge_way(r, w, up < most_up ? up : most_up, down < most_down ? down : most_down);
  }
  const double first = w.c2.dot(r.c3) + r.c2.dot(w.c3), second = w.c2.dot(w.c3);
  double alpha = 2;
  if (up < INFINITY) alpha = first_root(-up, first, second);
  if (down < INFINITY) {
    const double a = first_root(-down, -first, -second);
    if (a < alpha) alpha = a;
  }
  return alpha;
}

}  // namespace mortise::model
