#include "solver/linear_whole.h"

#include "solver/kernels.h"
#include "solver/tuning.h"

namespace mortise::solver {

linalg::GmresResult solve_whole(const LinearSystem& s, const EnvMask& whose, const std::vector<Index>& env_rows, const std::vector<double>& relative, Index most, const linalg::Operator& preconditioner) {
  const Index rows = s.b.n;
  device::Buffer<Vec3> r(rows), x(rows), d(rows), Jd(rows);
  device::copy(r.view().p, s.b.p, rows * sizeof(Vec3));
  x.zero();
  EnvMask left = whose;
  linalg::GmresResult sum;
  sum.of_env.assign(whose.size(), 0), sum.relative.assign(whose.size(), 1.0);
  for (;;) {
    for (Index e = 0; e < static_cast<Index>(whose.size()); ++e)
      if (!left[e]) clear_blocks(r, env_rows[e], env_rows[e + 1]);
    std::vector<double> wanted = relative;
    for (std::size_t e = 0; e < whose.size(); ++e) wanted[e] /= sum.relative[e];
    const linalg::GmresResult cycle = linalg::gmres(*s.whole, preconditioner, std::as_const(r).view(), d.view(), env_rows, wanted, std::min(tuning::kCycle, most - sum.iterations));
    add(std::as_const(d).view(), x);
    sum.iterations += cycle.iterations;
    for (std::size_t e = 0; e < whose.size(); ++e) {
      if (!left[e]) continue;
      sum.of_env[e] += cycle.of_env[e];
      sum.relative[e] *= cycle.relative[e];
      left[e] = sum.relative[e] > relative[e];
    }
    if (!any(left) || sum.iterations >= most) break;
    (*s.whole)(std::as_const(d).view(), Jd.view());
    subtract(std::as_const(r).view(), std::as_const(Jd).view(), d);
    r.swap(d);
  }
  for (Index e = 0; e < static_cast<Index>(whose.size()); ++e)
    if (whose[e]) device::copy(s.x.p + env_rows[e], std::as_const(x).view().p + env_rows[e], (env_rows[e + 1] - env_rows[e]) * sizeof(Vec3));
  return sum;
}

}  // namespace mortise::solver
