#include "solver/linear_whole.h"

#include <cmath>
#include <optional>

#include "solver/kernels.h"
#include "solver/tuning.h"

namespace mortise::solver {
namespace {

// D^-1/2 per row [1/sqrt(N/m)].
device::Buffer<double> row_weights(const linalg::BlockMatrix& A) {
  device::Buffer<double> out(A.rows);
  const device::View<double> w = out.view();
  const device::View<const Index> start = A.row_start.view();
  const device::View<const Mat3> value = A.value.view();
  device::parallel_for("solver.row_weights", A.rows, [=] MORTISE_HD(Index i) {
    const double stiffness = value[start[i]].trace() / 3;
    w[i] = stiffness > 0 ? 1 / std::sqrt(stiffness) : 1;
  });
  return out;
}

void weigh(device::View<const double> w, device::View<const Vec3> in, device::View<Vec3> out) {
  device::parallel_for("solver.weigh", in.n, [=] MORTISE_HD(Index i) { out[i] = w[i] * in[i]; });
}

void unweigh(device::View<const double> w, device::View<const Vec3> in, device::View<Vec3> out) {
  device::parallel_for("solver.unweigh", in.n, [=] MORTISE_HD(Index i) { out[i] = in[i] / w[i]; });
}

void copy_of(const EnvMask& whose, const std::vector<Index>& env_rows, device::View<const Vec3> from, device::View<Vec3> to) {
  for (std::size_t e = 0; e < whose.size(); ++e)
    if (whose[e]) device::copy(to.p + env_rows[e], from.p + env_rows[e], (env_rows[e + 1] - env_rows[e]) * sizeof(Vec3));
}

}  // namespace

linalg::GmresResult solve_whole(const model::Model& model, const LinearSystem& s, const Start& start, const std::vector<Index>& env_rows,
                                const std::vector<double>& relative, Index limit, const linalg::Awaited& preconditioner) {
  const Index rows = s.b.n, envs = static_cast<Index>(env_rows.size()) - 1;
  device::Buffer<Vec3> r(rows), x(rows), d(rows), Jx(rows), forces(rows);
  Jx.zero();  // of environments that have settled no product is taken
  const device::Buffer<double> weights = row_weights(s.A);
  const device::View<const double> w = weights.view();
  // D^-1/2 J, and its preconditioner.
  const linalg::Operator product = [&](device::View<const Vec3> in, device::View<Vec3> out) {
    (*s.whole)(in, out);
    weigh(w, out, out);
  };
  const linalg::Awaited inverse = [&](device::View<const Vec3> in, device::View<Vec3> out, const std::function<void(device::Fetch&)>& then) {
    unweigh(w, in, forces.view());
    preconditioner(std::as_const(forces).view(), out, then);
  };
  std::vector<double> b2, r2;
  const auto size = [&](std::vector<double>& square, device::Fetch& fetch) {
    square.assign(envs, 0.0);
    dot(std::as_const(r).view(), std::as_const(r).view(), env_rows, {square, fetch});
  };
  const auto residual = [&](device::Fetch& fetch) {
    (*s.whole)(std::as_const(x).view(), Jx.view());
    subtract(s.b, std::as_const(Jx).view(), r);
    weigh(w, std::as_const(r).view(), r.view());
    size(r2, fetch);
  };
  const auto begin = [&](device::Fetch& fetch) {
    weigh(w, s.b, r.view());
    size(b2, fetch);
    device::copy(x.view().p, s.x.p, rows * sizeof(Vec3));
    residual(fetch);
  };
  const EnvMask whose = start(begin);
  const auto leave = [&] { copy_of(whose, env_rows, std::as_const(x).view(), s.x); };
  EnvMask left = whose;
  linalg::GmresResult sum;
  sum.of_env.assign(envs, 0), sum.relative.assign(envs, 0.0);
  clear_envs(x, whose, 0, env_rows);
  for (;;) {
    std::vector<double> wanted(envs, 0.0);
    for (Index e = 0; e < envs; ++e) {
      if (left[e]) sum.relative[e] = b2[e] > 0 ? std::sqrt(r2[e] / b2[e]) : 0;
      left[e] = left[e] && sum.relative[e] > relative[e] && sum.of_env[e] < limit;
      if (left[e])
        wanted[e] = relative[e] / sum.relative[e];
      else
        clear_blocks(r, env_rows[e], env_rows[e + 1]), r2[e] = 0;
    }
    if (!any(left)) break;
    std::optional<model::Only> only;
    const linalg::GmresResult cycle = linalg::gmres(
        product, inverse, std::as_const(r).view(), d.view(), env_rows, wanted, limit,
        [&](const EnvMask& going) {
          only.reset();
          only.emplace(model, going);
        },
        r2);
    only.reset();
    add(std::as_const(d).view(), x);
    sum.iterations += cycle.iterations;
    for (Index e = 0; e < envs; ++e) sum.of_env[e] += left[e] ? cycle.of_env[e] : 0;
    device::Fetch own, &fetch = s.aside ? s.aside->fetch : own;
    residual(fetch);
    if (s.aside) {
      leave();
      s.aside->ask(fetch);
      s.aside->done = true;
    }
    fetch.now("whole system");
  }
  leave();
  return sum;
}

linalg::GmresResult solve_whole(const model::Model& model, const LinearSystem& s, const EnvMask& whose, const std::vector<Index>& env_rows,
                                const std::vector<double>& relative, Index limit, const linalg::Awaited& preconditioner) {
  device::Buffer<Vec3> first(s.b.n);
  const Start start = [&](const std::function<void(device::Fetch&)>& then) {
    preconditioner(s.b, first.view(), [&](device::Fetch& fetch) {
      copy_of(whose, env_rows, std::as_const(first).view(), s.x);
      then(fetch);
    });
    return whose;
  };
  return solve_whole(model, s, start, env_rows, relative, limit, preconditioner);
}

}  // namespace mortise::solver
