#pragma once
// A x = b for an operator that need not be symmetric and is known only by its products: generalised minimal residuals with a
// preconditioner that may itself be inexact (flexible GMRES; Saad, SIAM J. Sci. Comput. 14(2), 1993). Every environment is a system
// of its own: its scalars never mix with another's.
#include <functional>
#include <vector>

#include "device/device.h"

namespace mortise::linalg {

using device::Buffer;
using device::View;

using Operator = std::function<void(View<const Vec3> in, View<Vec3> out)>;
// One that the host may have to wait for: then(fetch) is called where `out` may be there, and its fetch is brought with what is waited for. It has
// been called for the `out` that is left.
using Awaited = std::function<void(View<const Vec3> in, View<Vec3> out, const std::function<void(device::Fetch&)>& then)>;
// `op`, which is not waited for.
Awaited awaited(Operator op);

struct GmresResult {
  Index iterations = 0;          // of the environment that took most,
  std::vector<Index> of_env;     // and of each: one that has converged stands still
  std::vector<double> relative;  // |b - A x| / |b| of every environment, by the recurrence; 0 where b is 0
};

// Starts at x = 0 and stops when every environment's residual is at most its `relative` |b|, or after `most` products. `go_on`, where there is one,
// is told before every product which environments have not ended yet: only theirs are wanted. b2: |b|^2 of every environment, where the caller knows
// it; that of a single environment comes with the first product. The host waits once per product, with the preconditioner.
GmresResult gmres(const Operator& A, const Awaited& preconditioner, View<const Vec3> b, View<Vec3> x, const std::vector<Index>& env_rows,
                  const std::vector<double>& relative, Index limit, const std::function<void(const std::vector<std::uint8_t>&)>& go_on = {},
                  const std::vector<double>& b2 = {});

}  // namespace mortise::linalg
