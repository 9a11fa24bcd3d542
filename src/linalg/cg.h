#pragma once
// Preconditioned conjugate gradients for A x = b (Hestenes and Stiefel 1952). A is block diagonal over environments: every
// environment has its own alpha, beta, tolerance and end, so its iterates do not depend on its neighbours. An environment counts
// as converged only when its true residual b - A x says so; if the recurrence claimed it wrongly, the iteration restarts from the
// true residual.
//
// All scalars of the iteration stay on the device. Iterations run in blocks of `check_every`, recorded once into a
// device::Graph and replayed; between two blocks the host looks at the states: once where a solve takes no more than a block. An environment that has
// ended stands still, so the result does not depend on the length of the blocks.
#include <functional>
#include <memory>
#include <vector>

#include "linalg/preconditioner.h"

namespace mortise::linalg {

struct CgOptions {
  Index max_iterations = 10000;      // per environment, restarts included
  std::vector<double> absolute;      // [unit of b] per environment, or empty: residuals up to this count as converged
  Index check_every = 16;            // iterations between two looks from the host
  Index expected = 0;                // iterations that it will take, where something is known of that: during half of them the host does not look
  std::vector<std::uint8_t> only{};  // per environment: whether it is solved at all, or empty: all are
  // Called where the host is about to look and x may be the solution; what it asks of the fetch is brought with that look. It has been called for the
  // x that solve() leaves.
  std::function<void(device::Fetch&)> then{};
  device::Fetch* fetch = nullptr;  // brought with the first look, where somebody has asked for something already
};

enum class CgEnd : std::uint8_t {
  converged,
  iteration_limit,
  not_positive_definite,  // p^T A p <= 0, or the preconditioner met a pivot that is not positive: x holds the last good iterate
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
    Index largest = 0;
    for (const Env& e : env) largest = e.iterations > largest ? e.iterations : largest;
    return largest;
  }
};

struct CgState;

// Keeps its vectors and the recorded iterations from one solve to the next.
class ConjugateGradients {
 public:
  // Environment e owns rows [env_rows[e], env_rows[e+1]).
  explicit ConjugateGradients(const std::vector<Index>& env_rows);
  ~ConjugateGradients();

  // Starts at x and leaves the solution there. Environment e ends when ||b - A x|| <= max(relative[e] ||b||, absolute[e]).
  CgResult solve(const BlockMatrix& A, const Preconditioner& M, View<const Vec3> b, View<Vec3> x, const std::vector<double>& relative,
                 const CgOptions& options = {});

 private:
  std::unique_ptr<CgState> state_;
};

}  // namespace mortise::linalg
