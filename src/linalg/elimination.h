#pragma once
// Rows that follow others, x = T z with T a constant sparse matrix of scalars (times I3), leave the matrix:
//     A = T^T K T       A_ab = sum_ij t_ia t_jb K_ij
// The pieces of every block of K are found anew when the structure of K changes, and are summed in an order that depends on nothing else.
#include "linalg/block_matrix.h"
#include "linalg/grouping.h"

namespace mortise::linalg {

class Elimination {
 public:
  // Row r of K is that combination of the rows column[offset[r]] ... column[offset[r + 1] - 1] of A, ascending; one that stays is itself, with
  // weight 1. A has `rows` rows, and all of them stay.
  void set(const std::vector<Index>& offset, const std::vector<Index>& column, const std::vector<double>& weight, Index rows);
  void reduce(const BlockMatrix& K, BlockMatrix& A);
  void find_pieces(const BlockMatrix& K);  // of reduce(); public, because it has kernels

 private:
  Index rows_ = 0;
  Buffer<Index> offset_, column_;
  Buffer<double> weight_;

  std::uint64_t of_ = 0, pattern_ = 0;  // structure of K that the pieces belong to, and of A
  Buffer<Index> piece_;                 // the block of K that it is taken from
  Buffer<double> product_;              // t_ia t_jb
  Buffer<std::uint8_t> entry_;          // how it enters: elimination.cpp
  Grouping groups_;
};

}  // namespace mortise::linalg
