#pragma once
// Direct solution of A x = b by CHOLMOD's supernodal Cholesky factorisation A = L L^T (Chen, Davis, Hager, Rajamanickam, ACM
// TOMS 887, 2008) on the host. The fill-reducing ordering is computed on the graph of 3x3 blocks, which has a ninth of the
// entries, and stands as long as A.pattern does.
//
// Bits repeat for any number of threads while OpenBLAS runs on one thread (the default). A matrix that is block diagonal over
// environments is factored as a whole, so the ordering, and with it the last bits of an environment, depends on the others.
//
// Where the device has a factorisation of its own (device/cholesky.h), only the ordering is done on the host; failed_row() and
// refinements are not available then.
#include <memory>
#include <string>

#include "linalg/block_matrix.h"

namespace mortise::linalg {

struct DirectOptions {
  int blas_threads = 1;  // more is faster on large systems, but the bits then depend on the number
};

struct DirectStats {
  std::string ordering;       // "metis" or "amd"
  Index unknowns = 0;         // scalar
  double factor_entries = 0;  // nnz(L)
  double factor_flops = 0;
  std::size_t memory = 0;  // bytes held by CHOLMOD
  long long analyses = 0, factorisations = 0, solves = 0;
  double analyse_seconds = 0, factor_seconds = 0, solve_seconds = 0;  // of the last call each
  double reciprocal_condition = 0;                                    // (smallest / largest diagonal entry of L)^2, a rough estimate
};

// For a process that will be copied: its copies then need no threads of OpenBLAS.
void use_one_blas_thread();

class DirectSolver {
 public:
  explicit DirectSolver(DirectOptions options = {});
  ~DirectSolver();
  DirectSolver(const DirectSolver&) = delete;
  DirectSolver& operator=(const DirectSolver&) = delete;

  // False when A is not positive definite; failed_row() then names the row. Throws Error(Exit::device) when memory runs out.
  bool factor(const BlockMatrix& A);
  Index failed_row() const;

  // x = A^-1 b by the last factorisation, followed by `refinements` steps of iterative refinement x += A^-1 (b - A x).
  // b and x may be the same. Returns ||b - A x|| / ||b|| (2-norm) if refinements > 0, else -1.
  double solve(View<const Vec3> b, View<Vec3> x, int refinements = 0);

  const DirectStats& stats() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace mortise::linalg
