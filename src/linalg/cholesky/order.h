#pragma once
// The order in which the rows of a symmetric matrix are eliminated so that its factor stays sparse: nested dissection by METIS (Karypis, Kumar, SIAM
// J. Sci. Comput. 20(1), 1998), of the graph of blocks.
#include <vector>

#include "base/types.h"

namespace mortise::linalg::cholesky {

// Of a matrix with these upper blocks: row r has columns col[row_start[r]] ... (the diagonal first), ascending. Throws std::bad_alloc.
std::vector<Index> find_order(const std::vector<Index>& row_start, const std::vector<Index>& col);

}  // namespace mortise::linalg::cholesky
