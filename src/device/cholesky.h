#pragma once
// Sparse Cholesky factorisation on the GPU, for verification and small scenes: cuSOLVER's low-level csrchol, in CUDA builds with
// MORTISE_CUSOLVER=ON (its libraries weigh more than a gigabyte). Everywhere else available() is false and nothing may be called.
#include <memory>

#include "device/device.h"

namespace mortise::device {

class Cholesky {
 public:
  static bool available();

  Cholesky();
  ~Cholesky();

  // Structure of a symmetric matrix of n rows, both triangles, columns ascending; no reordering happens here.
  void analyse(const Buffer<Index>& row_start, const Buffer<Index>& col);
  // False when the matrix with these entries is not positive definite.
  bool factor(const Buffer<double>& value);
  void solve(View<const double> b, View<double> x);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace mortise::device
