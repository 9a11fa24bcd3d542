#pragma once
// A x = b, symmetric, of one environment, by conjugate gradients with whatever there is of M^-1: the factor of an earlier, similar matrix (from one Newton
// iteration to the next most of the Hessian stays, and a factor costs as much as some tens of solves with it), or what is solved on another mesh. The
// host looks at every iteration.
#include "linalg/block_matrix.h"
#include "linalg/gmres.h"

namespace mortise::linalg {

struct HostCgResult {
  Index iterations = 0;
  bool converged = false;  // ||b - A x|| <= relative ||b||, by the recurrence
};

// Starts at x = 0; gives up after `most` iterations, or where A is not positive definite along a direction. The preconditioner is symmetric and positive.
HostCgResult solve_on_host(const BlockMatrix& A, const Operator& preconditioner, View<const Vec3> b, View<Vec3> x, double relative, Index limit);

}  // namespace mortise::linalg
