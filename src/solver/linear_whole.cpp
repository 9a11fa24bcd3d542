#include "solver/linear_whole.h"

#include <cmath>

#include "solver/kernels.h"
#include "solver/tuning.h"

namespace mortise::solver {

linalg::GmresResult solve_whole(const LinearSystem& s, const EnvMask& whose, const std::vector<Index>& env_rows, const std::vector<double>& relative,
                                Index most, const linalg::Operator& preconditioner) {
  const Index rows = s.b.n, envs = static_cast<Index>(whose.size());
  device::Buffer<Vec3> r, x(rows), d(rows), Jx(rows);
  device::copy(x.view().p, s.x.p, rows * sizeof(Vec3));
  EnvMask left = whose;
  linalg::GmresResult sum;
  sum.of_env.assign(envs, 0), sum.relative.assign(envs, 0.0);
  for (Index e = 0; e < envs; ++e)
    if (!whose[e]) clear_blocks(x, env_rows[e], env_rows[e + 1]);
  for (;;) {
    (*s.whole)(std::as_const(x).view(), Jx.view());
    subtract(s.b, std::as_const(Jx).view(), r);
    const std::vector<double> r2 = dot(std::as_const(r).view(), std::as_const(r).view(), env_rows);
    std::vector<double> wanted(envs, 0.0);
    for (Index e = 0; e < envs; ++e) {
      if (left[e]) sum.relative[e] = s.b2[e] > 0 ? std::sqrt(r2[e] / s.b2[e]) : 0;
      left[e] = left[e] && sum.relative[e] > relative[e];
      if (left[e])
        wanted[e] = relative[e] / sum.relative[e];
      else
        clear_blocks(r, env_rows[e], env_rows[e + 1]);
    }
    if (!any(left) || sum.iterations >= most) break;
    const linalg::GmresResult cycle =
        linalg::gmres(*s.whole, preconditioner, std::as_const(r).view(), d.view(), env_rows, wanted, most - sum.iterations);
    add(std::as_const(d).view(), x);
    sum.iterations += cycle.iterations;
    for (Index e = 0; e < envs; ++e) sum.of_env[e] += left[e] ? cycle.of_env[e] : 0;
  }
  for (Index e = 0; e < envs; ++e)
    if (whose[e]) device::copy(s.x.p + env_rows[e], std::as_const(x).view().p + env_rows[e], (env_rows[e + 1] - env_rows[e]) * sizeof(Vec3));
  return sum;
}

}  // namespace mortise::solver
