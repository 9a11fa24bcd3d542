#include "linalg/cg.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "linalg/env_sums.h"

namespace mortise::linalg {
namespace {

constexpr Index kCheckEvery = 8;  // iterations between two looks at the environments' states from the host

enum Status : Index { active, claimed, ended };

struct EnvState {
  Index status = active;
  CgEnd end = CgEnd::iteration_limit;
  Index iterations = 0, restarts = 0;
  double relative = 0, target2 = 0;  // tolerance; square of the residual aimed at
  double rhs2 = 0, rr = 0;           // b.b; r.r of the recurrence, at a restart and at the end the true one
  double restart_rr = 0;             // true r.r at the last restart
  double rz = 0, alpha = 0, beta = 0;
};

// Inverse of a symmetric positive definite A = L L^T as L^-T L^-1, which stays positive definite in rounding. False when a
// pivot is not positive.
MORTISE_HD inline bool spd_inverse(const Mat3& A, Mat3& out) {
  const double d0 = A(0, 0);
  if (!(d0 > 0)) return false;
  const double l00 = std::sqrt(d0), l10 = A(0, 1) / l00, l20 = A(0, 2) / l00;
  const double d1 = A(1, 1) - l10 * l10;
  if (!(d1 > 0)) return false;
  const double l11 = std::sqrt(d1), l21 = (A(1, 2) - l20 * l10) / l11;
  const double d2 = A(2, 2) - l20 * l20 - l21 * l21;
  if (!(d2 > 0)) return false;
  const double l22 = std::sqrt(d2);
  Mat3 M = Mat3::Zero();  // L^-1
  M(0, 0) = 1 / l00, M(1, 1) = 1 / l11, M(2, 2) = 1 / l22;
  M(1, 0) = -l10 * M(0, 0) / l11;
  M(2, 1) = -l21 * M(1, 1) / l22;
  M(2, 0) = -(l20 * M(0, 0) + l21 * M(1, 0)) / l22;
  out = M.transpose() * M;
  return true;
}

struct Cg {
  const BlockMatrix& A;
  View<const Vec3> b;
  View<Vec3> x;
  EnvSums sums;
  Index envs, max_iterations;
  Buffer<Vec3> residual, direction, product;
  Buffer<Mat3> inverse;
  Buffer<Index> env_of_row;
  Buffer<EnvState> states;

  void prepare(const std::vector<Index>& env_rows, const std::vector<double>& relative, double absolute);
  void begin();
  void iterate();
  void finish();
};

// Preconditioner, targets. Environments whose diagonal blocks are not all positive definite end here.
void Cg::prepare(const std::vector<Index>& env_rows, const std::vector<double>& relative, double absolute) {
  std::vector<Index> env(A.rows);
  std::vector<EnvState> initial(envs);
  for (Index e = 0; e < envs; ++e) {
    std::fill(env.begin() + env_rows[e], env.begin() + env_rows[e + 1], e);
    initial[e].relative = relative[e];
    initial[e].status = claimed;
  }
  env_of_row.upload(env);
  states.upload(initial);
  residual.resize(A.rows), direction.resize(A.rows), product.resize(A.rows), inverse.resize(A.rows);

  const View<const Index> diagonal = A.row_start.view();
  const View<const Mat3> value = A.value.view();
  const View<Mat3> inv = inverse.view();
  const View<const Vec3> rhs = b;
  const View<const Vec2> s = sums("cg.precondition", [=] MORTISE_HD(Index i) -> Vec2 {
    const bool good = spd_inverse(value[diagonal[i]], inv[i]);
    return Vec2(rhs[i].squaredNorm(), good ? 0.0 : 1.0);
  });
  const View<EnvState> state = states.view();
  device::parallel_for("cg.env", envs, [=] MORTISE_HD(Index e) {
    EnvState& env_state = state[e];
    env_state.rhs2 = s[e][0];
    const double target = env_state.relative * std::sqrt(s[e][0]);
    env_state.target2 = target > absolute ? target * target : absolute * absolute;
    if (s[e][1] > 0) env_state.status = ended, env_state.end = CgEnd::not_positive_definite;
  });
}

// For every environment that claims convergence (all of them at first): r = b - A x; ends it if r is small enough, otherwise
// (re)starts with p = z = M^-1 r.
void Cg::begin() {
  const RowProduct rows = row_product(A);
  const View<const Vec3> rhs = b, x_now = x;
  const View<Vec3> r = residual.view(), p = direction.view();
  const View<const Mat3> inv = inverse.view();
  const View<const Index> env = env_of_row.view();
  const View<EnvState> state = states.view();
  const View<const Vec2> s = sums("cg.begin", [=] MORTISE_HD(Index i) -> Vec2 {
    if (state[env[i]].status != claimed) return Vec2::Zero();
    const Vec3 ri = rhs[i] - rows(i, x_now);
    const Vec3 z = inv[i] * ri;
    r[i] = ri, p[i] = z;
    return Vec2(ri.dot(z), ri.squaredNorm());
  });
  device::parallel_for("cg.env", envs, [=] MORTISE_HD(Index e) {
    EnvState& t = state[e];
    if (t.status != claimed) return;
    const bool first = t.iterations == 0;
    t.rz = s[e][0], t.rr = s[e][1];
    if (t.rr <= t.target2) {
      t.status = ended, t.end = CgEnd::converged;
    } else if (!first && t.rr > 0.25 * t.restart_rr) {  // less than half the residual gone since the last restart
      t.status = ended, t.end = CgEnd::stagnated;
    } else if (!(t.rr < HUGE_VAL)) {
      t.status = ended, t.end = CgEnd::not_positive_definite;
    } else {
      t.status = active, t.restart_rr = t.rr, t.restarts += first ? 0 : 1;
    }
  });
}

// alpha = r.z / p.Ap;  x += alpha p;  r -= alpha Ap;  z = M^-1 r;  beta = r.z / (r.z)_old;  p = z + beta p
void Cg::iterate() {
  const RowProduct rows = row_product(A);
  const View<Vec3> r = residual.view(), p = direction.view(), q = product.view(), x_now = x;
  const View<const Mat3> inv = inverse.view();
  const View<const Index> env = env_of_row.view();
  const View<EnvState> state = states.view();
  const Index limit = max_iterations;
  const View<const Vec3> p_now = p;
  View<const Vec2> s = sums("cg.multiply", [=] MORTISE_HD(Index i) -> Vec2 {
    if (state[env[i]].status != active) return Vec2::Zero();
    const Vec3 qi = rows(i, p_now);
    q[i] = qi;
    return Vec2(p[i].dot(qi), 0);
  });
  device::parallel_for("cg.env", envs, [=] MORTISE_HD(Index e) {
    EnvState& t = state[e];
    if (t.status != active) return;
    if (t.iterations >= limit)
      t.status = ended, t.end = CgEnd::iteration_limit;
    else if (!(s[e][0] > 0))
      t.status = ended, t.end = CgEnd::not_positive_definite;
    else
      t.alpha = t.rz / s[e][0];
  });
  s = sums("cg.step", [=] MORTISE_HD(Index i) -> Vec2 {
    const EnvState& t = state[env[i]];
    if (t.status != active) return Vec2::Zero();
    x_now[i] += t.alpha * p[i];
    const Vec3 ri = r[i] - t.alpha * q[i];
    const Vec3 z = inv[i] * ri;
    r[i] = ri, q[i] = z;
    return Vec2(ri.dot(z), ri.squaredNorm());
  });
  device::parallel_for("cg.env", envs, [=] MORTISE_HD(Index e) {
    EnvState& t = state[e];
    if (t.status != active) return;
    t.beta = s[e][0] / t.rz;
    t.rz = s[e][0], t.rr = s[e][1];
    ++t.iterations;
    if (t.rr <= t.target2) t.status = claimed;
  });
  device::parallel_for("cg.direction", A.rows, [=] MORTISE_HD(Index i) {
    const EnvState& t = state[env[i]];
    if (t.status == active) p[i] = q[i] + t.beta * p[i];
  });
}

// True residuals of all environments.
void Cg::finish() {
  const RowProduct rows = row_product(A);
  const View<const Vec3> rhs = b, x_now = x;
  const View<EnvState> state = states.view();
  const View<const Vec2> s =
      sums("cg.finish", [=] MORTISE_HD(Index i) -> Vec2 { return Vec2((rhs[i] - rows(i, x_now)).squaredNorm(), 0); });
  device::parallel_for("cg.env", envs, [=] MORTISE_HD(Index e) { state[e].rr = s[e][0]; });
}

}  // namespace

CgResult conjugate_gradients(const BlockMatrix& A, View<const Vec3> b, View<Vec3> x, const std::vector<Index>& env_rows,
                             const std::vector<double>& relative, const CgOptions& options) {
  const Index envs = static_cast<Index>(env_rows.size()) - 1;
  if (envs < 0 || env_rows.front() != 0 || env_rows.back() != A.rows || static_cast<Index>(relative.size()) != envs || b.n != A.rows ||
      x.n != A.rows)
    throw Error(Exit::internal, "conjugate gradients: sizes do not match");
  Cg cg{A, b, x, EnvSums(env_rows), envs, options.max_iterations, {}, {}, {}, {}, {}, {}};
  cg.prepare(env_rows, relative, options.absolute);
  std::vector<EnvState> state;
  const auto any = [&](Index status) {
    return std::any_of(state.begin(), state.end(), [&](const EnvState& s) { return s.status == status; });
  };
  do {
    cg.begin();
    state = cg.states.download();
    while (any(active) && !any(claimed)) {
      for (Index i = 0; i < kCheckEvery; ++i) cg.iterate();
      state = cg.states.download();
    }
  } while (any(claimed));
  cg.finish();
  CgResult out;
  for (const EnvState& s : cg.states.download()) out.env.push_back({s.end, s.iterations, s.restarts, std::sqrt(s.rr), std::sqrt(s.rhs2)});
  return out;
}

}  // namespace mortise::linalg
