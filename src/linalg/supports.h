#pragma once
// Supports by projection: row r may move only within the range of the symmetric projector P_r (identity = free, zero = held).
//     A <- P A P + (I - P),   b <- P b
// keeps A symmetric positive definite, and the solution of A x = b lies in the range of P.
#include "linalg/block_matrix.h"

namespace mortise::linalg {

void project(BlockMatrix& A, View<const Mat3> P_of_row);

}  // namespace mortise::linalg
