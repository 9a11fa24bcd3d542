#include "linalg/cg.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>
#include <utility>

#include "base/error.h"
#include "device/graph.h"
#include "linalg/env_sums.h"

namespace mortise::linalg {
namespace {

constexpr double kSure = 0.5;  // of the iterations that are expected: a block too many costs as much as ten looks

enum Status : Index { active, claimed, ended };

struct EnvState {
  Index status = claimed;
  CgEnd end = CgEnd::iteration_limit;
  Index iterations = 0, restarts = 0, limit = 0;
  double relative = 0, absolute = 0, target2 = 0;  // tolerances; square of the residual aimed at
  double rhs2 = 0, rr = 0;                         // b.b; r.r of the recurrence, at a restart and at the end the true one
  double restart_rr = 0;                           // true r.r at the last restart
  double rz = 0, alpha = 0, beta = 0;
};

}  // namespace

struct CgState {
  explicit CgState(const std::vector<Index>& env_rows);

  Index rows, envs;
  EnvSums sums;
  Buffer<Index> env_of_row;
  Buffer<Vec3> solution, residual, direction, product;  // x, r, p, and by turns A p and z = M^-1 r
  Buffer<EnvState> states;

  Index expected = 0;  // iterations of the last solve

  device::Graph block;
  std::vector<const void*> recorded;  // the memory that the recorded block uses

  void prepare(const Preconditioner& M, View<const Vec3> b);
  void begin(const BlockMatrix& A, const Preconditioner& M, View<const Vec3> b);
  void iterate(const RowProduct& product_of, const Preconditioner& M);
  void record(const BlockMatrix& A, const Preconditioner& M, Index iterations);
  void finish(const BlockMatrix& A, View<const Vec3> b);
};

CgState::CgState(const std::vector<Index>& env_rows)
    : rows(env_rows.back()),
      envs(static_cast<Index>(env_rows.size()) - 1),
      sums(env_rows),
      solution(rows),
      residual(rows),
      direction(rows),
      product(rows) {
  std::vector<Index> env(rows);
  for (Index e = 0; e < envs; ++e) std::fill(env.begin() + env_rows[e], env.begin() + env_rows[e + 1], e);
  env_of_row.upload(env);
  residual.zero();  // M is applied to all rows, those of environments that end before they begin too
}

// Targets. Environments in which the preconditioner met a bad pivot end here.
void CgState::prepare(const Preconditioner& M, View<const Vec3> b) {
  const View<const Index> bad = M.bad_rows();
  const View<EnvState> state = states.view();
  sums(
      "cg.targets", [=] MORTISE_HD(Index i) -> Vec2 { return Vec2(b[i].squaredNorm(), 1.0 * bad[i]); },
      [=] MORTISE_HD(Index e, const Vec2& s) {
        EnvState& t = state[e];
        t.rhs2 = s[0];
        const double target = t.relative * std::sqrt(t.rhs2);
        t.target2 = target > t.absolute ? target * target : t.absolute * t.absolute;
        if (s[1] > 0) t.status = ended, t.end = CgEnd::not_positive_definite;
      });
}

// For every environment that claims convergence (all of them at first): r = b - A x; ends it if r is small enough, otherwise
// (re)starts with p = z = M^-1 r.
void CgState::begin(const BlockMatrix& A, const Preconditioner& M, View<const Vec3> b) {
  const RowProduct product_of = row_product(A);
  const View<const Vec3> x = std::as_const(solution).view();
  const View<Vec3> r = residual.view(), p = direction.view(), z = product.view();
  const View<const Index> env = env_of_row.view();
  const View<EnvState> state = states.view();
  product_of(
      "cg.begin", rows, x, [=] MORTISE_HD(Index i) { return state[env[i]].status == claimed ? i : Index{-1}; },
      [=] MORTISE_HD(Index i, const Vec3& Ax) { r[i] = b[i] - Ax; });
  M.apply(r, z);
  const auto dots = [=] MORTISE_HD(Index i) -> Vec2 {
    if (state[env[i]].status != claimed) return Vec2::Zero();
    p[i] = z[i];
    return Vec2(r[i].dot(z[i]), r[i].squaredNorm());
  };
  sums("cg.dots", dots, [=] MORTISE_HD(Index e, const Vec2& s) {
    EnvState& t = state[e];
    if (t.status != claimed) return;
    const bool first = t.iterations == 0;
    t.rz = s[0], t.rr = s[1];
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
void CgState::iterate(const RowProduct& product_of, const Preconditioner& M) {
  const View<Vec3> x = solution.view(), r = residual.view(), p = direction.view(), q = product.view(), z = q;
  const View<const Vec3> p_now = p;
  const View<const Index> env = env_of_row.view();
  const View<EnvState> state = states.view();
  product_of(
      "cg.multiply", rows, p_now, [=] MORTISE_HD(Index i) { return state[env[i]].status == active ? i : Index{-1}; },
      [=] MORTISE_HD(Index i, const Vec3& Ap) { q[i] = Ap; });
  const auto curvature = [=] MORTISE_HD(Index i) -> Vec2 {
    if (state[env[i]].status != active) return Vec2::Zero();
    return Vec2(p[i].dot(q[i]), 0);
  };
  sums("cg.dots", curvature, [=] MORTISE_HD(Index e, const Vec2& s) {
    EnvState& t = state[e];
    if (t.status != active) return;
    if (t.iterations >= t.limit)
      t.status = ended, t.end = CgEnd::iteration_limit;
    else if (!(s[0] > 0))
      t.status = ended, t.end = CgEnd::not_positive_definite;
    else
      t.alpha = t.rz / s[0];
  });
  device::parallel_for("cg.step", rows, [=] MORTISE_HD(Index i) {
    const EnvState& t = state[env[i]];
    if (t.status != active) return;
    x[i] += t.alpha * p[i];
    r[i] -= t.alpha * q[i];
  });
  M.apply(r, z);
  const auto sizes = [=] MORTISE_HD(Index i) -> Vec2 {
    if (state[env[i]].status != active) return Vec2::Zero();
    return Vec2(r[i].dot(z[i]), r[i].squaredNorm());
  };
  sums("cg.dots", sizes, [=] MORTISE_HD(Index e, const Vec2& s) {
    EnvState& t = state[e];
    if (t.status != active) return;
    t.beta = s[0] / t.rz;
    t.rz = s[0], t.rr = s[1];
    ++t.iterations;
    if (t.rr <= t.target2) t.status = claimed;
  });
  device::parallel_for("cg.direction", rows, [=] MORTISE_HD(Index i) {
    const EnvState& t = state[env[i]];
    if (t.status == active) p[i] = z[i] + t.beta * p[i];
  });
}

void CgState::record(const BlockMatrix& A, const Preconditioner& M, Index iterations) {
  const RowProduct product_of = row_product(A);
  std::vector<const void*> now = M.memory();
  now.insert(now.end(), {product_of.start.p, product_of.col.p, product_of.source.p, product_of.value.p, states.view().p, &M,
                         reinterpret_cast<const void*>(static_cast<std::uintptr_t>(iterations))});
  if (now == recorded) return;
  block.record([this, product_of, &M, iterations] {
    for (Index i = 0; i < iterations; ++i) iterate(product_of, M);
  });
  recorded = std::move(now);
}

// True residuals of all environments.
void CgState::finish(const BlockMatrix& A, View<const Vec3> b) {
  const RowProduct product_of = row_product(A);
  const View<const Vec3> x = std::as_const(solution).view();
  const View<Vec3> r = residual.view();
  const View<EnvState> state = states.view();
  product_of(
      "cg.finish", rows, x, [] MORTISE_HD(Index i) { return i; }, [=] MORTISE_HD(Index i, const Vec3& Ax) { r[i] = b[i] - Ax; });
  sums(
      "cg.dots", [=] MORTISE_HD(Index i) -> Vec2 { return Vec2(r[i].squaredNorm(), 0); },
      [=] MORTISE_HD(Index e, const Vec2& s) { state[e].rr = s[0]; });
}

ConjugateGradients::ConjugateGradients(const std::vector<Index>& env_rows) : state_(std::make_unique<CgState>(env_rows)) {}
ConjugateGradients::~ConjugateGradients() = default;

CgResult ConjugateGradients::solve(const BlockMatrix& A, const Preconditioner& M, View<const Vec3> b, View<Vec3> x,
                                   const std::vector<double>& relative, const CgOptions& options) {
  CgState& cg = *state_;
  const std::size_t envs = static_cast<std::size_t>(cg.envs);
  if (A.rows != cg.rows || relative.size() != envs || b.n != A.rows || x.n != A.rows ||
      (!options.absolute.empty() && options.absolute.size() != envs))
    throw Error(Exit::internal, "conjugate gradients: sizes do not match");
  std::vector<EnvState> state(envs);
  for (std::size_t e = 0; e < envs; ++e) {
    state[e].relative = relative[e], state[e].limit = options.max_iterations;
    if (!options.absolute.empty()) state[e].absolute = options.absolute[e];
    if (!options.only.empty() && !options.only[e]) state[e].status = ended, state[e].end = CgEnd::converged;
  }
  cg.states.upload(state);
  // What is recorded works on a vector of its own: callers' come and go.
  const std::size_t bytes = static_cast<std::size_t>(x.n) * sizeof(Vec3);
  device::copy(cg.solution.view().p, x.p, bytes);
  cg.prepare(M, b);
  cg.record(A, M, options.check_every);
  const auto any = [&](Index status) { return std::any_of(state.begin(), state.end(), [&](const EnvState& s) { return s.status == status; }); };
  // What claims convergence is looked at before the host asks once as many iterations are done as the last solve took, where that was too early twice
  // as many, ...: begin() leaves those that go on as they are.
  const auto sure = static_cast<Index>(kSure * options.expected);
  Index done = 0, expected = options.expected > 0 ? options.expected : cg.expected;
  bool told = false;  // x is the present solution, and then() knows it
  device::Fetch own, &fetch = options.fetch ? *options.fetch : own;
  const auto look = [&](bool hopeful) {
    static_assert(std::is_trivially_copyable_v<EnvState> && sizeof(EnvState) % sizeof(double) == 0);
    const auto words = reinterpret_cast<const double*>(cg.states.view().p);
    fetch.add(View<const double>{words, static_cast<Index>(envs * (sizeof(EnvState) / sizeof(double)))},
              [&](const std::vector<double>& bits) { std::memcpy(static_cast<void*>(state.data()), bits.data(), envs * sizeof(EnvState)); });
    told = hopeful && options.then;
    if (told) {
      device::copy(x.p, cg.solution.view().p, bytes);
      options.then(fetch);
    }
    fetch.now("cg");
  };
  const auto go_on = [&] {
    do {
      cg.block.replay("cg.block");
      done += options.check_every;
    } while (done < sure);
    const bool hopeful = done >= expected;
    if (hopeful) cg.begin(A, M, b), expected = 2 * done;
    look(hopeful);
  };
  cg.begin(A, M, b);
  go_on();  // nothing is hardly ever left to do
  while (any(active) || any(claimed)) {
    if (!any(claimed)) {
      go_on();
      continue;
    }
    cg.begin(A, M, b);
    look(!any(active));
  }
  if (!told) {
    device::copy(x.p, cg.solution.view().p, bytes);
    if (options.then) {
      options.then(fetch);
      fetch.now("after cg");
    }
  }
  // begin() has left the true residuals of those that converged.
  if (std::any_of(state.begin(), state.end(), [](const EnvState& s) { return s.end != CgEnd::converged && s.end != CgEnd::stagnated; })) {
    cg.finish(A, b);
    state = cg.states.download();
  }
  CgResult out;
  for (const EnvState& s : state) out.env.push_back({s.end, s.iterations, s.restarts, std::sqrt(s.rr), std::sqrt(s.rhs2)});
  cg.expected = out.iterations();
  return out;
}

}  // namespace mortise::linalg
