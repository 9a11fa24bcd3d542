#pragma once
// What the Cholesky factor A = L L^T of a symmetric matrix of 3x3 blocks looks like, decided once per structure: which rows are eliminated together,
// as one dense panel of L (supernodes; Liu, Ng, Peyton, SIAM J. Matrix Anal. Appl. 14(1), 1993). From CHOLMOD (Chen, Davis, Hager, Rajamanickam, ACM
// TOMS 887, 2008), on the graph of blocks, which has a ninth of the entries. "Place" is a row's number in the order of elimination (order.h).
#include <cstdint>
#include <vector>

#include "base/types.h"

namespace mortise::linalg::cholesky {

struct Supernodes {
  // A block of A in a panel: block `value` of the matrix, transposed or not, is added at row `row` and column `column` of the panel (of blocks).
  struct Entry {
    Index value, row, column;
    bool transposed;
  };

  std::vector<Index> order;  // at every place: the row of the matrix
  // Supernode s eliminates the places first[s] ... first[s + 1] - 1. Its panel has the rows (places, ascending) row[row_start[s]] ...; its own
  // come first. What it leaves to others goes to its parent's panel and to what that leaves: row k of the others is row to_parent[k] there.
  std::vector<Index> first;
  std::vector<std::size_t> row_start;
  std::vector<Index> row, to_parent;
  // Supernodes are numbered so that those below s are begin[s] ... s - 1; children ascending. The last one, without places, stands above all roots.
  std::vector<Index> begin, child_start, child;
  std::vector<std::size_t> panel;    // where each panel begins [scalars], and the end
  std::vector<std::size_t> left;     // where rows that are left to others begin, over all supernodes [blocks], and the end
  std::vector<std::size_t> entries;  // where each supernode's entries begin, and the end
  std::vector<Entry> entry;
  std::vector<double> flops;  // of each and all below it

  Index count() const { return static_cast<Index>(first.size()) - 1; }
  Index columns(Index s) const { return first[s + 1] - first[s]; }
  Index rows(Index s) const { return static_cast<Index>(row_start[s + 1] - row_start[s]); }
};

// Of a matrix with these upper blocks (order.h), in this order, but for exchanges that leave fill as it is. Throws Error(Exit::device) when memory
// runs out.
Supernodes find_supernodes(const std::vector<Index>& row_start, const std::vector<Index>& col, const std::vector<Index>& order);

}  // namespace mortise::linalg::cholesky
