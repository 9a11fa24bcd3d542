#pragma once
// Conjugate gradients for A x = b, preconditioned with the inverses of the 3x3 diagonal blocks (Hestenes and Stiefel 1952; block
// Jacobi). A is block diagonal over environments: every environment has its own alpha, beta, tolerance and end, so its iterates
// do not depend on its neighbours. An environment counts as converged only when its true residual b - A x says so; if the
// recurrence claimed it wrongly, the iteration restarts from the true residual.
#include <vector>

#include "linalg/block_matrix.h"

namespace mortise::linalg {

struct CgOptions {
  Index max_iterations = 10000;  // per environment, restarts included
  double absolute = 0;           // [unit of b] residuals up to this count as converged, whatever the relative tolerance asks
};

enum class CgEnd : std::uint8_t {
  converged,
  iteration_limit,
  not_positive_definite,  // p^T A p <= 0, or a diagonal block without a Cholesky factor: x holds the last good iterate
  stagnated               // rounding keeps the true residual above the tolerance
};

struct CgResult {
  struct Env {
    CgEnd end = CgEnd::converged;
    Index iterations = 0;
    Index restarts = 0;
    double residual = 0;  // true ||b - A x||, 2-norm over the environment's rows
    double rhs = 0;       // ||b||
  };
  std::vector<Env> env;
  bool converged() const {
    for (const Env& e : env)
      if (e.end != CgEnd::converged) return false;
    return true;
  }
  Index iterations() const {
    Index most = 0;
    for (const Env& e : env) most = e.iterations > most ? e.iterations : most;
    return most;
  }
};

// Starts at x and leaves the solution there. Environment e owns rows [env_rows[e], env_rows[e+1]) and ends when
// ||b - A x|| <= max(relative[e] ||b||, options.absolute).
CgResult conjugate_gradients(const BlockMatrix& A, View<const Vec3> b, View<Vec3> x, const std::vector<Index>& env_rows,
                             const std::vector<double>& relative, const CgOptions& options = {});

}  // namespace mortise::linalg
