#pragma once
// Every number of the factor that was chosen, with its reason. None of them depends on the number of threads, so that bits do not.
#include <cstddef>

namespace mortise::linalg::cholesky::tuning {

// Supernodes of up to so many block columns together are merged where no more than that share of the panel is zeros: fewer and larger panels.
// CHOLMOD's own numbers for scalar columns (4, 16, 48), as blocks.
inline constexpr std::size_t kMergedColumns[3] = {2, 6, 16};
inline constexpr double kMergedZeros[3] = {0.8, 0.1, 0.05};

inline constexpr double kOutgrown = 1.15;    // of a factor's flops: more in an order found for other contacts cost more than a new order does,
inline constexpr double kFarOutgrown = 1.5;  // and from here on more than waiting for it

inline constexpr double kShares = 128;      // parts of the tree that are not divided further: so many threads could find work, and tasks cost nothing
inline constexpr int kTile = 128;           // [scalars] tiles of large panels: large enough for BLAS, small enough to be shared out
inline constexpr double kLargePanel = 1e7;  // [flops] from here on a panel is worth dividing: some milliseconds
inline constexpr int kLargeLeft = 96;       // [blocks] rows that a child leaves: from here on they are added up in parallel
inline constexpr std::size_t kLargeProduct = 1 << 15;  // [scalars] of a panel that a solve reads: the same, some tens of microseconds

}  // namespace mortise::linalg::cholesky::tuning
