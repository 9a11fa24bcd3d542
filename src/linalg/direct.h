#pragma once
// Direct solution of A x = b by a sparse Cholesky factor on the host (cholesky/factor.h), on all threads and with the same bits for any number of
// them while OpenBLAS runs on one.
//
// A matrix that is block diagonal over environments is factored as a whole, so the ordering, and with it the last bits of an environment, depends on
// the others.
//
// Where the device has a factorisation of its own (device/cholesky.h), only the ordering is done on the host.
#include <memory>
#include <vector>

#include "linalg/block_matrix.h"

namespace mortise::linalg {

struct DirectStats {
  Index unknowns = 0;         // scalar
  double factor_entries = 0;  // of L, zeros of merged supernodes included
  double factor_flops = 0;
  std::size_t memory = 0;  // bytes of L
  long long orderings = 0, analyses = 0, factorisations = 0, solves = 0;
  double analyse_seconds = 0, factor_seconds = 0, solve_seconds = 0;  // of the last call each
  double reciprocal_condition = 0;                                    // (smallest / largest diagonal entry of L)^2, a rough estimate
};

enum class Precision {
  full,   // solutions are those of double precision
  rough,  // single precision where that can factor the matrix: half of the time and memory, and a solution of some six digits less what the
          // condition of A costs: a preconditioner
  trial,  // the same, but false where that is not enough: of matrices that may have to be made anew, as indefinite ones are
};

class DirectSolver {
 public:
  DirectSolver();
  ~DirectSolver();
  DirectSolver(const DirectSolver&) = delete;
  DirectSolver& operator=(const DirectSolver&) = delete;

  // In which order rows are eliminated. It outlives changes of the pattern, which are some contacts, as long as it is good for them. A better one is
  // found beside the work with the old one, as one thread can only do, and taken at the next change, or by settle_order().
  struct Order {
    std::vector<Index> rows;
    double flops = 0;  // what a factor took when it was found
  };
  const Order& order() const;
  // For the matrices to come: this one, or, where it is not of as many rows, one that is found anew.
  void set_order(Order order);
  void settle_order();

  // False when A is not positive definite. Throws Error(Exit::device) when memory runs out.
  bool factor(const BlockMatrix& A, Precision wanted = Precision::full);
  // Of the last factor.
  Precision precision() const;

  // x = A^-1 b by the last factorisation. b and x may be the same.
  void solve(View<const Vec3> b, View<Vec3> x);

  const DirectStats& stats() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace mortise::linalg
