#pragma once
// Inverses of many dense symmetric matrices of up to kSlots 3x3 blocks, as A^-1 = X^T X with X = L^-1, A = L L^T. X is stored in
// single precision: X^T X stays symmetric and positive semi-definite however X is rounded, and rounding X costs only the root of
// the condition number (rounding A^-1 itself would cost all of it).
//
// Work is spread over domains and their block rows; a block column of the factor is one launch, so that no thread waits for another.
#include "linalg/block_matrix.h"
#include "linalg/domains.h"

namespace mortise::linalg {

inline constexpr Index kPacked = kSlots * (kSlots + 1) / 2;  // blocks of a lower triangle
// Place of block (a >= b) in the row-by-row lower triangle.
MORTISE_HD inline Index packed_place(Index a, Index b) { return a * (a + 1) / 2 + b; }

using Mat3f = Eigen::Matrix<float, 3, 3>;

// What happens to unknowns whose pivot is lost to rounding.
enum class Pivots : std::uint8_t {
  strict,   // an exact submatrix of A: a pivot clearly below zero makes A indefinite and is reported; one near zero becomes its size
  optional  // a coarse matrix, whose modes may depend on each other or do nothing: the unknown is left out, its row of X is zero
};

struct DomainMatrices {
  Index domains = 0, strict_domains = 0;  // the first ones
  Buffer<Index> blocks;                   // of every domain
  Buffer<Mat3> lower;                     // domains * kPacked; A on entry, then its factor
  Buffer<Vec3> size;                      // domains * kSlots: what the pivots of a block are measured against [N/m]
  Buffer<Mat3> pivot;                     // domains * kSlots: inverses of the diagonal blocks of L
  Buffer<Mat3f> inverse;                  // domains * kPacked: X
  Buffer<Index> bad;                      // per domain: 1 where a strict pivot failed

  void resize(const Domains& domains);
  void invert();
};

}  // namespace mortise::linalg
