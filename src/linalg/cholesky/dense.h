#pragma once
// The dense part of a factor: large matrices in tiles, on as many threads as there are. Tiles are the same for any number of them.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>

#include "linalg/cholesky/blas.h"
#include "linalg/cholesky/tuning.h"

namespace mortise::linalg::cholesky {

// f(i) for i = 0 ... n - 1, without taking up anything else while waiting.
template <class F>
void for_tiles(int n, const F& f) {
  if (n == 1) return f(0);
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_for(tbb::blocked_range<int>(0, n, 1), [&](const tbb::blocked_range<int>& r) {
      for (int i = r.begin(); i != r.end(); ++i) f(i);
    });
  });
}

inline int tiles(int n) { return (n + tuning::kTile - 1) / tuning::kTile; }

// The first `columns` of the `rows` rows of F become those of L; `left` (lower triangle) becomes - L21 L21^T. False where F11 is not positive
// definite.
template <class Real>
bool eliminate(int rows, int columns, Real* F, Real* left) {
  constexpr int T = tuning::kTile;
  const int below = rows - columns;
  if (static_cast<double>(rows) * rows * columns < tuning::kLargePanel) {
    if (!blas::factor(columns, F, rows)) return false;
    if (below == 0) return true;
    blas::divide_by_transposed(below, columns, F, rows, F + columns, rows);
    blas::minus_square(below, columns, F + columns, rows, left, below);
    return true;
  }
  const auto at = [=](int i, int j) { return F + static_cast<std::size_t>(j) * rows + i; };
  for (int j = 0; j < columns; j += T) {
    const int width = std::min(T, columns - j), next = j + width;
    if (j > 0)
      for_tiles(tiles(rows - j), [&](int tile) {
        const int i = j + tile * T, height = std::min(T, rows - i);
        blas::minus_product(height, width, j, at(i, 0), rows, at(j, 0), rows, Real(1), at(i, j), rows);
      });
    if (!blas::factor(width, at(j, j), rows)) return false;
    if (next < rows)
      for_tiles(tiles(rows - next), [&](int tile) {
        const int i = next + tile * T, height = std::min(T, rows - i);
        blas::divide_by_transposed(height, width, at(j, j), rows, at(i, j), rows);
      });
  }
  const int n = tiles(below);
  if (n > 0)
    for_tiles(n * (n + 1) / 2, [&](int pair) {
      int down = 0;
      while ((down + 1) * (down + 2) / 2 <= pair) ++down;
      const int right = pair - down * (down + 1) / 2, i = down * T, j = right * T, height = std::min(T, below - i), width = std::min(T, below - j);
      Real* to = left + static_cast<std::size_t>(j) * below + i;
      if (down == right)
        blas::minus_square(height, columns, at(columns + i, 0), rows, to, below);
      else
        blas::minus_product(height, width, columns, at(columns + i, 0), rows, at(columns + j, 0), rows, Real(0), to, below);
    });
  return true;
}

// y <- y - A x, A (m x n, its columns `rows` apart); transposed: y <- y - A^T x.
template <class Real>
void subtract_large(bool transposed, int m, int n, const Real* A, int rows, const Real* x, Real* y) {
  if (m == 0 || n == 0) return;
  const int parts = static_cast<int>(static_cast<std::size_t>(m) * n / tuning::kLargeProduct) + 1, of = transposed ? n : m;
  for_tiles(parts, [&](int part) {
    const int from = static_cast<int>(static_cast<long long>(of) * part / parts),
              to = static_cast<int>(static_cast<long long>(of) * (part + 1) / parts);
    if (from == to) return;
    if (transposed)
      blas::subtract(true, m, to - from, A + static_cast<std::size_t>(from) * rows, rows, x, y + from);
    else
      blas::subtract(false, to - from, n, A + from, rows, x, y + from);
  });
}

// x <- L^-1 x, or L^-T x, for the first n rows and columns of a panel.
template <class Real>
void divide_large(bool transposed, int n, const Real* L, int rows, Real* x) {
  constexpr int T = tuning::kTile;
  const auto at = [=](int i, int j) { return L + static_cast<std::size_t>(j) * rows + i; };
  for (int k = 0; k < tiles(n); ++k) {
    const int j = (transposed ? tiles(n) - 1 - k : k) * T, width = std::min(T, n - j), next = j + width;
    if (transposed) subtract_large(true, n - next, width, at(next, j), rows, x + next, x + j);
    blas::divide(transposed, width, at(j, j), rows, x + j);
    if (!transposed) subtract_large(false, n - next, width, at(next, j), rows, x + j, x + next);
  }
}

}  // namespace mortise::linalg::cholesky
