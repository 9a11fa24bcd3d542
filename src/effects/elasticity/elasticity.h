#pragma once
// Hyperelastic energy of one tetrahedron; of a linear one, E = V Psi(F) [J], with V the rest volume [m^3] and the deformation gradient
//     F = Ds Dm^-1,   Ds = [x1 - x0, x2 - x0, x3 - x0],   i.e.  F = sum_a x_a g_a^T,
// where g_1, g_2, g_3 are the rows of Dm^-1 [1/m] and g_0 = -(g_1 + g_2 + g_3). Psi [Pa] is an energy density with first
// Piola-Kirchhoff stress P = dPsi/dF [Pa]; then dE/dx_a = V P g_a [N] and d^2E/dx_a dx_b = V (d^2 Psi/dF^2)[g_a, g_b] [N/m].
// mu, lambda [Pa] are the Lame parameters of linear elasticity; every material below matches them at small strain.
#include "base/math.h"
#include "effects/contact/barrier.h"
#include "geometry/quadratic.h"
#include "linalg/isotropic.h"
#include "model/input.h"

namespace mortise::effects::elasticity {

using model::MaterialModel;

// G = F - I keeps the digits of small strains: every density below is written so that nothing cancels as G -> 0.
// J - 1 = tr G + (sum of the principal 2x2 minors of G) + det G.
MORTISE_HD inline double minors(const Mat3& G) {
  return G(0, 0) * G(1, 1) - G(0, 1) * G(1, 0) + G(1, 1) * G(2, 2) - G(1, 2) * G(2, 1) + G(0, 0) * G(2, 2) - G(0, 2) * G(2, 0);
}
MORTISE_HD inline double det3(const Mat3& A) { return A.col(0).dot(A.col(1).cross(A.col(2))); }
MORTISE_HD inline double volume_change(const Mat3& G) { return G(0, 0) + G(1, 1) + G(2, 2) + minors(G) + det3(G); }

// dJ/dF
MORTISE_HD inline Mat3 cofactor(const Mat3& F) {
  Mat3 C;
  C.col(0) = F.col(1).cross(F.col(2));
  C.col(1) = F.col(2).cross(F.col(0));
  C.col(2) = F.col(0).cross(F.col(1));
  return C;
}

// ---- linear: Psi = mu |eps|^2 + lambda/2 (tr eps)^2, eps = sym(F) - I; not invariant under rotation ----------------------

MORTISE_HD inline Mat3 small_strain(const Mat3& F) {
  Mat3 e = 0.5 * (F + F.transpose());
  e.diagonal() -= Vec3(1, 1, 1);
  return e;
}
MORTISE_HD inline double linear_density(const Mat3& F, double mu, double lambda) {
  const Mat3 eps = small_strain(F);
  const double tr = eps(0, 0) + eps(1, 1) + eps(2, 2);
  return mu * eps.squaredNorm() + 0.5 * lambda * tr * tr;
}
// P = 2 mu eps + lambda tr(eps) I
MORTISE_HD inline Mat3 linear_stress(const Mat3& F, double mu, double lambda) {
  const Mat3 eps = small_strain(F);
  Mat3 P = 2 * mu * eps;
  P.diagonal() += lambda * (eps(0, 0) + eps(1, 1) + eps(2, 2)) * Vec3(1, 1, 1);
  return P;
}
// (d^2 Psi/dF^2)[g_a, g_b] = mu (g_a . g_b I + g_b g_a^T) + lambda g_a g_b^T; positive semi-definite as it stands
MORTISE_HD inline Mat3 linear_block(const Vec3& ga, const Vec3& gb, double mu, double lambda) {
  Mat3 H = mu * gb * ga.transpose() + lambda * ga * gb.transpose();
  H.diagonal() += mu * ga.dot(gb) * Vec3(1, 1, 1);
  return H;
}

// ---- corotated: Psi = mu |F - R|^2 + lambda/2 (J - 1)^2 ("fixed corotated", Stomakhin et al. 2012), R = U V^T ------------

MORTISE_HD inline double corotated_density(const Mat3& F, double mu, double lambda) {
  const linalg::Svd3 d = linalg::svd3(F);
  Mat3 G = F;
  G.diagonal() -= Vec3(1, 1, 1);
  const double j1 = volume_change(G);
  return mu * (F - d.U * d.V.transpose()).squaredNorm() + 0.5 * lambda * j1 * j1;
}
// P = 2 mu (F - R) + lambda (J - 1) dJ/dF
MORTISE_HD inline Mat3 corotated_stress(const Mat3& F, double mu, double lambda) {
  const linalg::Svd3 d = linalg::svd3(F);
  Mat3 G = F;
  G.diagonal() -= Vec3(1, 1, 1);
  return 2 * mu * (F - d.U * d.V.transpose()) + lambda * volume_change(G) * cofactor(F);
}
// psi_i = 2 mu (s_i - 1) + lambda (J - 1) c_i with c_i = s_j s_k, hence (k the third axis)
//   twist_ij = 2 mu (1 - 2 / (s_i + s_j)) + lambda (J - 1) s_k
//   flip_ij  = 2 mu - lambda (J - 1) s_k
//   psi_ii   = 2 mu + lambda c_i^2,   psi_ij = lambda (c_i c_j + (J - 1) s_k)
// The twist is singular at s_i + s_j = 0, where R jumps: there it is very negative, but finite, so that none of it can be kept.
MORTISE_HD inline linalg::IsotropicModes corotated_modes(const Mat3& F, double mu, double lambda) {
  const linalg::Svd3 d = linalg::svd3(F);
  const Vec3& s = d.s;
  const double j1 = s[0] * s[1] * s[2] - 1;
  linalg::IsotropicModes m;
  m.U = d.U, m.V = d.V;
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const double ci = s[j] * s[k], cj = s[k] * s[i], ck = s[i] * s[j];
    m.twist[k] = 2 * mu * (1 - 2 / (s[i] + s[j] > 1e-9 ? s[i] + s[j] : 1e-9)) + lambda * j1 * s[k];
    m.flip[k] = 2 * mu - lambda * j1 * s[k];
    m.stretch(k, k) = 2 * mu + lambda * ck * ck;
    m.stretch(i, j) = m.stretch(j, i) = lambda * (ci * cj + j1 * s[k]);
  }
  return m;
}

// ---- stable neo-Hookean (Smith, de Goes, Kim 2018, eq. 14) ---------------------------------------------------------------
//   Psi = m/2 (I_C - 3) - m/2 ln(I_C + 1) + l/2 (J - alpha)^2 + const,   I_C = |F|^2,   alpha = 1 + 3 m / (4 l)
// with m = 4/3 mu, l = lambda + 5/6 mu (their section 3.4), so that small strains see mu and lambda. The constant makes Psi(I) = 0.
// The same function of Green's strain E = (F^T F - I)/2 and of J > 0, with E2 the sum of its principal 2x2 minors, is
//   Psi = 3/4 m (tr E - (J - 1)) + m/2 (y - ln(1 + y)) + l/2 (J - 1)^2,     y = tr E / 2,
//   J - 1 = d / (J + 1),     d = J^2 - 1 = 2 tr E + 4 E2 + 8 det E,     tr E - (J - 1) = (tr E (J - 1) - 4 E2 - 8 det E) / (J + 1),
// which is of second order in E: free of cancellation near rest however far the body has turned. With G = F - I instead, rounding was as that of the
// modulus itself in bodies that had turned, and line searches ended in it.

MORTISE_HD inline double neo_hookean_mu(double mu) { return 4.0 / 3.0 * mu; }
MORTISE_HD inline double neo_hookean_lambda(double mu, double lambda) { return lambda + 5.0 / 6.0 * mu; }

// y - ln(1 + y); by its series where the difference would lose digits.
MORTISE_HD inline double minus_log1p(double y) {
  if (y > 0.02 || y < -0.02) return y - ln1p(y);
  double sum = 0, power = y * y;
  for (int n = 2; n < 12; ++n, power *= -y) sum += power / n;
  return sum;
}

MORTISE_HD inline double neo_hookean_density(const Mat3& F, double mu, double lambda) {
  const double m = neo_hookean_mu(mu), l = neo_hookean_lambda(mu, lambda);
  Mat3 E = F.transpose() * F;
  E.diagonal() -= Vec3(1, 1, 1);
  E *= 0.5;
  const double t = E(0, 0) + E(1, 1) + E(2, 2), higher = 4 * minors(E) + 8 * det3(E), J = det3(F);
  double j1 = J - 1, bend = t - j1;
  if (J > 0) {
    j1 = (2 * t + higher) / (J + 1);
    bend = (t * j1 - higher) / (J + 1);
  }
  return 0.75 * m * bend + 0.5 * m * minus_log1p(0.5 * t) + 0.5 * l * j1 * j1;
}
// P = 3/4 m (F - dJ/dF) + m/4 y/(1 + y) F + l (J - 1) dJ/dF
MORTISE_HD inline Mat3 neo_hookean_stress(const Mat3& F, double mu, double lambda) {
  const double m = neo_hookean_mu(mu), l = neo_hookean_lambda(mu, lambda);
  Mat3 G = F;
  G.diagonal() -= Vec3(1, 1, 1);
  const double y = 0.25 * (2 * (G(0, 0) + G(1, 1) + G(2, 2)) + G.squaredNorm());
  const Mat3 C = cofactor(F);
  return 0.75 * m * (F - C) + (0.25 * m * y / (1 + y)) * F + (l * volume_change(G)) * C;
}
// With r = 1 / (I_C + 1), b = l (J - alpha): psi_i = m (1 - r) s_i + b c_i, c_i = s_j s_k, hence
//   twist_ij = m (1 - r) + b s_k,   flip_ij = m (1 - r) - b s_k
//   psi_ii   = m (1 - r) + 2 m r^2 s_i^2 + l c_i^2,   psi_ij = 2 m r^2 s_i s_j + l c_i c_j + b s_k
MORTISE_HD inline linalg::IsotropicModes neo_hookean_modes(const Mat3& F, double mu, double lambda) {
  const double m = neo_hookean_mu(mu), l = neo_hookean_lambda(mu, lambda);
  const linalg::Svd3 d = linalg::svd3(F);
  const Vec3& s = d.s;
  const double r = 1 / (s.squaredNorm() + 1), a = m * (1 - r);
  const double b = l * (s[0] * s[1] * s[2] - 1) - 0.75 * m;
  linalg::IsotropicModes w;
  w.U = d.U, w.V = d.V;
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const double ci = s[j] * s[k], cj = s[k] * s[i], ck = s[i] * s[j];
    w.twist[k] = a + b * s[k];
    w.flip[k] = a - b * s[k];
    w.stretch(k, k) = a + 2 * m * r * r * s[k] * s[k] + l * ck * ck;
    w.stretch(i, j) = w.stretch(j, i) = 2 * m * r * r * s[i] * s[j] + l * ci * cj + b * s[k];
  }
  return w;
}

// The same without modes, all of its negative curvature included: with F' the change of F,
//     P = a F + b C,   C = dJ/dF,   a = m (1 - r),   da = 2 m r^2 F : F',   db = l C : F',   C' g_a = (F (g_b x g_a)) x u  for F' = u g_b^T,
// hence  d^2 Psi / dx_a dx_b = a g_a . g_b I + 2 m r^2 (F g_a)(F g_b)^T + l (C g_a)(C g_b)^T + b [F (g_b x g_a)]_x.
// A density U(J) besides adds U' to b and U'' to l. Adds to hess the upper triangle of 3x3 pieces of n nodes, times `volume`.
MORTISE_HD inline void add_neo_hookean_exact(const Mat3& F, double mu, double lambda, double first, double second, double volume, int n,
                                             const Vec3* g, Mat3* hess) {
  const double m = neo_hookean_mu(mu), r = 1 / (F.squaredNorm() + 1);
  const Mat3 C = cofactor(F);
  Mat3 G = F;
  G.diagonal() -= Vec3(1, 1, 1);
  const double l = neo_hookean_lambda(mu, lambda), a = volume * m * (1 - r), d = 2 * volume * m * r * r;
  const double b = volume * (l * volume_change(G) - 0.75 * m + first), c = volume * (l + second);
  for (int i = 0, place = 0; i < n; ++i) {
    const Vec3 f = d * (F * g[i]), s = c * (C * g[i]);
    for (int j = i; j < n; ++j, ++place) {
      Mat3& H = hess[place];
      const Vec3 w = b * (F * g[j].cross(g[i]));
      H += f * (F * g[j]).transpose() + s * (C * g[j]).transpose();
      H.diagonal() += a * g[i].dot(g[j]) * Vec3(1, 1, 1);
      H(0, 1) -= w[2], H(0, 2) += w[1], H(1, 0) += w[2], H(1, 2) -= w[0], H(2, 0) -= w[1], H(2, 1) += w[0];
    }
  }
}

// ---- change of volume ----------------------------------------------------------------------------------------------------
// The part lambda/2 theta^2 of the energy, theta = J - 1 (linear: tr eps), may act on the mean of theta over many points instead of at each
// (README.md); the rest is the law with lambda = 0. Points then feel the pressure p = lambda <theta> [Pa]: P += p dtheta/dF.

MORTISE_HD inline double dilation(MaterialModel model, const Mat3& F) {
  Mat3 G = F;
  G.diagonal() -= Vec3(1, 1, 1);
  return model == MaterialModel::linear ? G(0, 0) + G(1, 1) + G(2, 2) : volume_change(G);
}
MORTISE_HD inline Mat3 dilation_slope(MaterialModel model, const Mat3& F) {
  return model == MaterialModel::linear ? Mat3(Mat3::Identity()) : cofactor(F);
}

// A density U(J) adds to the second derivative, with c_i = s_j s_k = dJ/ds_i:
//     twist_ij += U' s_k,   flip_ij -= U' s_k,   psi_ii += U'' c_i^2,   psi_ij += U'' c_i c_j + U' s_k.
MORTISE_HD inline void add_volumetric(linalg::IsotropicModes& m, const Mat3& F, double first, double second) {
  const Vec3 s = (m.U.transpose() * F * m.V).diagonal(), c(s[1] * s[2], s[2] * s[0], s[0] * s[1]);
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    m.twist[k] += first * s[k];
    m.flip[k] -= first * s[k];
    m.stretch(k, k) += second * c[k] * c[k];
    m.stretch(i, j) += second * c[i] * c[j] + first * s[k];
    m.stretch(j, i) = m.stretch(i, j);
  }
}

// ---- guard against inversion ---------------------------------------------------------------------------------------------
// The laws above are finite at J = det F <= 0 and would let elements turn inside out. Below J_0 = 0.1 they get
//     Psi_guard = 2 mu b(J - J_1)/J_0,   b the barrier of contact with range J_0 - J_1,
// which is C2 at J_0, leaves J > J_0 alone, and is infinite at J_1 = 1e-6: flatter elements have no meaning any more.

inline constexpr double kGuarded = 0.1, kFlattest = 1e-6;

MORTISE_HD inline double guard_density(double J, double mu) {
  return J > kFlattest ? 2 * mu / kGuarded * barrier::value(J - kFlattest, kGuarded - kFlattest) : INFINITY;
}
MORTISE_HD inline double guard_first(double J, double mu) { return 2 * mu / kGuarded * barrier::first(J - kFlattest, kGuarded - kFlattest); }
MORTISE_HD inline double guard_second(double J, double mu) { return 2 * mu / kGuarded * barrier::second(J - kFlattest, kGuarded - kFlattest); }

MORTISE_HD inline void add_guard(linalg::IsotropicModes& m, const Mat3& F, double mu) {
  const double J = det3(F);
  if (J >= kGuarded) return;
  add_volumetric(m, F, guard_first(J, mu), guard_second(J, mu));
}

// ---- any material --------------------------------------------------------------------------------------------------------

// The laws alone, without guard.
MORTISE_HD inline double law_density(MaterialModel model, const Mat3& F, double mu, double lambda) {
  if (model == MaterialModel::linear) return linear_density(F, mu, lambda);
  return model == MaterialModel::corotated ? corotated_density(F, mu, lambda) : neo_hookean_density(F, mu, lambda);
}
MORTISE_HD inline Mat3 law_stress(MaterialModel model, const Mat3& F, double mu, double lambda) {
  if (model == MaterialModel::linear) return linear_stress(F, mu, lambda);
  return model == MaterialModel::corotated ? corotated_stress(F, mu, lambda) : neo_hookean_stress(F, mu, lambda);
}

// Infinite at det F <= 1e-6.
MORTISE_HD inline double density(MaterialModel model, const Mat3& F, double mu, double lambda) {
  const double guard = guard_density(det3(F), mu);
  return guard < INFINITY ? guard + law_density(model, F, mu, lambda) : guard;
}
MORTISE_HD inline Mat3 stress(MaterialModel model, const Mat3& F, double mu, double lambda) {
  const Mat3 P = law_stress(model, F, mu, lambda);
  const double J = det3(F);
  return J < kGuarded ? P + guard_first(J, mu) * cofactor(F) : P;
}
// The modes of a nonlinear law under a pressure of the mean, and of the guard; of the linear law, whose second derivative is constant, of the guard
// alone.
MORTISE_HD inline linalg::IsotropicModes modes(MaterialModel model, const Mat3& F, double mu, double lambda, double pressure = 0) {
  linalg::IsotropicModes m;
  if (model == MaterialModel::linear) {
    const linalg::Svd3 d = linalg::svd3(F);
    m = {d.U, d.V, Vec3::Zero(), Vec3::Zero(), Mat3::Zero()};
  } else {
    m = model == MaterialModel::corotated ? corotated_modes(F, mu, lambda) : neo_hookean_modes(F, mu, lambda);
    if (pressure != 0) add_volumetric(m, F, pressure, 0);
  }
  add_guard(m, F, mu);
  return m;
}
// Cauchy stress P F^T / J [Pa]. Linear elasticity does not tell the two apart: P itself, and the pressure of the guard.
MORTISE_HD inline Mat3 cauchy_stress(MaterialModel model, const Mat3& F, double mu, double lambda, double pressure = 0) {
  const double J = det3(F), floor = 1e-12;  // a squashed element reports a huge but finite stress
  if (model == MaterialModel::linear) {
    Mat3 P = linear_stress(F, mu, lambda);
    P.diagonal() += (pressure + (J < kGuarded ? guard_first(J, mu) : 0)) * Vec3(1, 1, 1);
    return P;
  }
  Mat3 P = stress(model, F, mu, lambda);
  if (pressure != 0) P += pressure * cofactor(F);
  return P * F.transpose() / (std::abs(J) > floor ? J : (J < 0 ? -floor : floor));
}

// One point of integration and the volume that it stands for: all of a linear tetrahedron, a share of a quadratic one.
struct Element {
  Mat3 dm_inverse;
  double volume, mu, lambda;
  MaterialModel model;
  double pressure = 0;  // of the mean change of volume [Pa]
};

MORTISE_HD inline Vec3 shape_gradient(const Mat3& dm_inverse, int a) {
  if (a > 0) return dm_inverse.row(a - 1).transpose();
  return -(dm_inverse.row(0) + dm_inverse.row(1) + dm_inverse.row(2)).transpose();
}
MORTISE_HD inline Mat3 deformation_gradient(const Mat3& dm_inverse, const Vec3& x0, const Vec3& x1, const Vec3& x2, const Vec3& x3) {
  Mat3 Ds;
  Ds.col(0) = x1 - x0, Ds.col(1) = x2 - x0, Ds.col(2) = x3 - x0;
  return Ds * dm_inverse;
}
// Without that of the mean change of volume.
MORTISE_HD inline double energy(const Element& e, const Mat3& F) { return e.volume * density(e.model, F, e.mu, e.lambda); }

// V P
MORTISE_HD inline Mat3 volume_stress(const Element& e, const Mat3& F) {
  Mat3 P = stress(e.model, F, e.mu, e.lambda);
  if (e.pressure != 0) P += e.pressure * dilation_slope(e.model, F);
  return e.volume * P;
}

// grad[4]: dE/dx_a [N].
MORTISE_HD inline void gradient(const Element& e, const Mat3& F, Vec3* grad) {
  const Mat3 P = volume_stress(e, F);
  for (int a = 1; a < 4; ++a) grad[a] = P * shape_gradient(e.dm_inverse, a);
  grad[0] = -(grad[1] + grad[2] + grad[3]);
}

// Adds to hess the upper triangle of 3x3 pieces of n nodes with shape gradients g, row by row [N/m], with the share
// `concave` of its negative curvature. g is overwritten.
MORTISE_HD inline void add_hessian(const Element& e, const Mat3& F, double concave, int n, Vec3* g, Mat3* hess) {
  if (e.model == MaterialModel::linear) {
    for (int a = 0, place = 0; a < n; ++a)
      for (int b = a; b < n; ++b) hess[place++] += e.volume * linear_block(g[a], g[b], e.mu, e.lambda);
    if (det3(F) >= kGuarded) return;
  } else if (e.model == MaterialModel::neo_hookean && concave >= 1) {
    const double J = det3(F), first = J < kGuarded ? guard_first(J, e.mu) : 0, second = J < kGuarded ? guard_second(J, e.mu) : 0;
    add_neo_hookean_exact(F, e.mu, e.lambda, e.pressure + first, second, e.volume, n, g, hess);
    return;
  }
  linalg::IsotropicModes m = modes(e.model, F, e.mu, e.lambda, e.pressure);
  linalg::scale_concave(m, concave);
  for (int a = 0; a < n; ++a) g[a] = m.V.transpose() * g[a];
  for (int a = 0, place = 0; a < n; ++a)
    for (int b = a; b < n; ++b) hess[place++] += e.volume * linalg::hessian_block(m, g[a], g[b]);
}

// hess[10], overwritten.
MORTISE_HD inline void hessian(const Element& e, const Mat3& F, double concave, Mat3* hess) {
  Vec3 g[4];
  for (int a = 0; a < 4; ++a) g[a] = shape_gradient(e.dm_inverse, a);
  for (int i = 0; i < 10; ++i) hess[i] = Mat3::Zero();
  add_hessian(e, F, concave, 4, g, hess);
}

// ---- quadratic tetrahedra ------------------------------------------------------------------------------------------------
// E = sum over four points p of V_p Psi(F_p), with F = sum_a x_a g_a^T, g_a = J^-T dN_a/dl at the point and J = dX/dl at rest; or with lambda = 0 in
// Psi, and V lambda/2 <theta>^2 with the mean <theta> = sum_p V_p/V theta_p.

MORTISE_HD inline void quadratic_gradients(const Mat3& dm_inverse, int point, Vec3 g[10]) {
  double l[4];
  geometry::tet_point(point, l);
  for (int a = 0; a < 10; ++a) g[a] = dm_inverse.transpose() * geometry::tet_slope(a, l);
}
// Counted from x_0, because sum_a g_a = 0 holds to rounding only.
MORTISE_HD inline Mat3 quadratic_deformation(const Vec3 g[10], const Vec3 x[10]) {
  Mat3 F = Mat3::Zero();
  for (int a = 1; a < 10; ++a) F += (x[a] - x[0]) * g[a].transpose();
  return F;
}
MORTISE_HD inline void add_quadratic_gradient(const Element& e, const Mat3& F, const Vec3 g[10], Vec3 grad[10]) {
  const Mat3 P = volume_stress(e, F);
  Vec3 rest = Vec3::Zero();
  for (int a = 1; a < 10; ++a) {
    const Vec3 f = P * g[a];
    grad[a] += f;
    rest += f;
  }
  grad[0] -= rest;
}

}  // namespace mortise::effects::elasticity
