#include "run/quadratic_stress.h"

#include <cmath>

#include "geometry/quadratic.h"

namespace mortise::run {
namespace {

using Nodes = std::array<Vec3, 10>;

struct Slopes {
  Mat3 rest = Mat3::Zero(), moved = Mat3::Zero();  // dX, and d(X + u), by the barycentrics
};

Slopes slopes(const Nodes& rest, const Nodes& u, int point) {
  double l[4];
  geometry::tet_point(point, l);
  Slopes out;
  for (int k = 0; k < 10; ++k) {
    const Vec3 slope = geometry::tet_slope(k, l);
    out.rest += rest[k] * slope.transpose(), out.moved += (rest[k] + u[k]) * slope.transpose();
  }
  return out;
}

// The points lie on the way from the middle to the corners.
CornerStress at_corners(const Mat3 (&S)[geometry::kTetPoints]) {
  Stress at[geometry::kTetPoints], mean = Stress::Zero();
  for (int g = 0; g < geometry::kTetPoints; ++g) {
    at[g] << S[g](0, 0), S[g](1, 1), S[g](2, 2), S[g](0, 1), S[g](1, 2), S[g](2, 0);
    mean += at[g] / geometry::kTetPoints;
  }
  double l[4];
  geometry::tet_point(0, l);
  const double beyond = 0.75 / (l[0] - 0.25);
  CornerStress out;
  for (int k = 0; k < 4; ++k) out[k] = mean + beyond * (at[k] - mean);
  return out;
}

}  // namespace

CornerStress stress_of_quadratic(const Nodes& rest, const Nodes& u, const Isotropic& of) {
  Mat3 G[geometry::kTetPoints], S[geometry::kTetPoints];
  double J[geometry::kTetPoints], mean_J = 0;
  for (int g = 0; g < geometry::kTetPoints; ++g) {
    const Slopes at = slopes(rest, u, g);
    const Mat3 F = at.moved * at.rest.inverse();
    G[g] = 0.5 * (F.transpose() * F - Mat3::Identity());
    J[g] = F.determinant();
    mean_J += J[g] / geometry::kTetPoints;
  }
  const double mu = of.E / (2 * (1 + of.nu)), lambda = of.E * of.nu / ((1 + of.nu) * (1 - 2 * of.nu));
  for (int g = 0; g < geometry::kTetPoints; ++g) S[g] = lambda * std::log(of.averaged ? mean_J : J[g]) * Mat3::Identity() + 2 * mu * G[g];
  return at_corners(S);
}

CornerStress linear_stress_of_quadratic(const Nodes& rest, const Nodes& u, const Isotropic& of) {
  Mat3 e[geometry::kTetPoints], S[geometry::kTetPoints];
  double mean = 0;
  for (int g = 0; g < geometry::kTetPoints; ++g) {
    const Slopes at = slopes(rest, u, g);
    const Mat3 H = (at.moved - at.rest) * at.rest.inverse();
    e[g] = 0.5 * (H + H.transpose());
    mean += e[g].trace() / geometry::kTetPoints;
  }
  const double mu = of.E / (2 * (1 + of.nu)), lambda = of.E * of.nu / ((1 + of.nu) * (1 - 2 * of.nu));
  for (int g = 0; g < geometry::kTetPoints; ++g) S[g] = lambda * (of.averaged ? mean : e[g].trace()) * Mat3::Identity() + 2 * mu * e[g];
  return at_corners(S);
}

}  // namespace mortise::run
