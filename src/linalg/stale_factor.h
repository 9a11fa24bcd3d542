#pragma once
// A x = b with the Cholesky factor of an earlier, similar matrix: conjugate gradients preconditioned with (L L^T)^-1. From one
// Newton iteration to the next most of the Hessian stays; a factor costs as much as some tens of solves with it.
#include "linalg/direct.h"

namespace mortise::linalg {

struct StaleResult {
  Index iterations = 0;
  bool converged = false;  // ||b - A x|| <= relative ||b||, by the recurrence
};

// Starts at x = 0; gives up after `most` iterations, or where A is not positive definite along a direction.
StaleResult solve_with_stale_factor(const BlockMatrix& A, DirectSolver& factor, View<const Vec3> b, View<Vec3> x, double relative, Index limit);

}  // namespace mortise::linalg
