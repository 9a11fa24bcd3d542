#pragma once
// Quadratic faces seen from a slave triangle.
#include <cmath>

#include "effects/mortar_contact/clip.h"
#include "effects/mortar_contact/view.h"

namespace mortise::effects::mortar {

// A face in the frame of a slave triangle: barycentrics N1, N2 and height [m] of its nodes.
struct Sheet {
  FaceNodes on;
  Vec3 c[6];
  MORTISE_HD Vec3 at(const double b[3]) const {
    double w[6];
    on.shape(b, w);
    Vec3 x = Vec3::Zero();
    for (int k = 0; k < on.count; ++k) x += w[k] * c[k];
    return x;
  }
};

MORTISE_HD inline Sheet sheet_of(const MortarView& s, const SlavePlane& plane, Index triangle, View<const Vec3> y) {
  Sheet out;
  out.on = s.nodes_of(triangle);
  for (int k = 0; k < out.on.count; ++k) {
    double N[3];
    const double height = project(plane, y[out.on.point[k]], N);
    out.c[k] = Vec3(N[1], N[2], height);
  }
  return out;
}

// Moves b to the point of the face exactly above or below x and returns that point. Quarters get b nearly right, so that Newton needs two
// or three steps.
MORTISE_HD inline Vec3 slide(const Sheet& face, const Vec3& x, double b[3]) {
  for (int step = 0;; ++step) {
    const Vec3 at = face.at(b);
    const double u = at[0] - x[0], v = at[1] - x[1];
    if (step == 5 || std::abs(u) + std::abs(v) < 1e-14) return at;
    double d1[6], d2[6];
    face.on.slope(b, d1, d2);
    Vec3 x1 = Vec3::Zero(), x2 = Vec3::Zero();
    for (int k = 0; k < face.on.count; ++k) x1 += d1[k] * face.c[k], x2 += d2[k] * face.c[k];
    const double det = x1[0] * x2[1] - x1[1] * x2[0];
    if (det == 0) return at;
    b[1] += (v * x2[0] - u * x2[1]) / det;
    b[2] += (u * x1[1] - v * x1[0]) / det;
    b[0] = 1 - b[1] - b[2];
  }
}

}  // namespace mortise::effects::mortar
