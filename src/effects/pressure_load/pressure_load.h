#pragma once
// Dead load on surface triangles: the force follows neither the motion nor the rotation of the surface. A triangle of rest area
// A [m^2] and outward rest normal n under pressure p [Pa] and traction s [Pa] (force per rest area) carries
//     F = A (s - p n)  [N],  a third of it at each of its vertices.
// Of a triangle that is loaded in part (loaded_part.h) A is that part's area, and its mean barycentrics are in the place of the thirds.
// A quadratic face loads its six nodes with int N_a (s - p n) dA: nothing at the corners and a third at every middle, if it is plane.
// With the force f_b [N] on block b the potential is E = -sum_b f_b . (q_b - rest_b), its gradient -f_b; there is no Hessian.
#include "geometry/quadratic.h"
#include "geometry/triangle_rule.h"

namespace mortise::effects::pressure_load {

// f_b = p pushed + factor pulled, with `pushed` = -sum w A n / 3 [m^2] and `pulled` = sum w A s / 3 [N].
struct BlockLoad {
  Index block, load;
  Vec3 pushed, pulled;
};
struct Strength {
  double pressure;  // [Pa]
  double factor;    // of the traction
};
MORTISE_HD inline Vec3 force(const BlockLoad& s, const Strength& now) { return now.pressure * s.pushed + now.factor * s.pulled; }
MORTISE_HD inline double energy(const Vec3& f, const Vec3& q, const Vec3& rest) { return -f.dot(q - rest); }

// int N_a dA [m^2] and int N_a n dA [m^2] over the triangle with corners b (barycentrics of the quarter) in one quarter of the quadratic
// face with nodes x. n dA = x_1 x x_2 dl1 dl2 has degree 4 with N_a; six points integrate that exactly. The quarter has a fourth of the area
// 1/2 of the reference triangle, and the triangle the share det(b) of that.
struct QuarterLoad {
  double area[6];
  Vec3 directed[6];
};
inline QuarterLoad quarter_load(const Vec3 x[6], int quarter, const Mat3& b) {
  QuarterLoad out;
  for (int k = 0; k < 6; ++k) out.area[k] = 0, out.directed[k] = Vec3::Zero();
  const double share = b.determinant();
  for (int i = 0; i < 6; ++i) {
    const geometry::TrianglePoint p = geometry::triangle_point(6, i);
    const Vec3 at = b * Vec3(p.b[0], p.b[1], p.b[2]);
    double l[3], N[6], d1[6], d2[6];
    geometry::quarter_place(quarter, at.data(), l);
    geometry::triangle_shape(l, N);
    geometry::triangle_slope(l, d1, d2);
    Vec3 x1 = Vec3::Zero(), x2 = Vec3::Zero();
    for (int k = 0; k < 6; ++k) x1 += d1[k] * x[k], x2 += d2[k] * x[k];
    const Vec3 dA = share * p.weight / 8 * x1.cross(x2);
    for (int k = 0; k < 6; ++k) out.area[k] += N[k] * dA.norm(), out.directed[k] += N[k] * dA;
  }
  return out;
}

}  // namespace mortise::effects::pressure_load
