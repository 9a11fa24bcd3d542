#include "linalg/cholesky/factor.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "linalg/cholesky/dense.h"
#include "linalg/cholesky/tree.h"

namespace mortise::linalg::cholesky {
namespace {

// Adds what child c left to columns of its parent's matrix F: to the panel, its first `parent_columns` ones, or to what the parent leaves itself.
template <class Real>
void add_left(const Supernodes& t, Index c, const Real* from, Index parent_rows, Index parent_columns, bool to_panel, Real* F) {
  const Index own = t.columns(c), n = t.rows(c) - own;
  const Index* to = t.to_parent.data() + t.row_start[c] + own;
  const Index split = static_cast<Index>(std::lower_bound(to, to + n, parent_columns) - to);
  const Index first = to_panel ? 0 : split, count = to_panel ? split : n - split;
  const Index up = to_panel ? 0 : parent_columns, height = 3 * (parent_rows - up);
  const auto column = [&](Index j) {
    Real* base = F + static_cast<std::size_t>(3 * (to[j] - up)) * height;
    const Real* source = from + static_cast<std::size_t>(3 * j) * (3 * n);
    for (int k = 0; k < 3; ++k, base += height, source += 3 * n) {
      Real* corner = base + 3 * (to[j] - up);
      for (int i = k; i < 3; ++i) corner[i] += source[3 * j + i];
      for (Index i = j + 1; i < n; ++i) {
        Real* at = base + 3 * (to[i] - up);
        const Real* value = source + 3 * i;
        at[0] += value[0], at[1] += value[1], at[2] += value[2];
      }
    }
  };
  constexpr Index kColumns = 16;
  if (count < tuning::kLargeLeft)
    for (Index j = first; j < first + count; ++j) column(j);
  else
    for_tiles((count + kColumns - 1) / kColumns, [&](int tile) {
      const Index from = first + kColumns * tile;
      for (Index j = from; j < std::min(first + count, from + kColumns); ++j) column(j);
    });
}

}  // namespace

template <class Real>
bool Factor<Real>::compute(const Supernodes& t, const Mat3* value) {
  if (panel_size_ != t.panel.back()) {
    panels_.reset();
    panel_size_ = 0;
    panels_.reset(new Real[t.panel.back()]);
    panel_size_ = t.panel.back();
  }
  const Index count = t.count();
  std::vector<std::unique_ptr<Real[]>> left(count);  // what supernodes leave to their parents: square, column by column, lower triangles
  std::vector<Real> smallest(count), largest(count);
  std::atomic<bool> failed = false;
  const auto front = [&](Index s) {
    if (failed) return;
    const Index rows = t.rows(s), columns = t.columns(s), below = rows - columns, height = 3 * rows;
    Real* panel = panels_.get() + t.panel[s];
    std::fill(panel, panels_.get() + t.panel[s + 1], Real(0));
    for (std::size_t k = t.entries[s]; k < t.entries[s + 1]; ++k) {
      const Supernodes::Entry& e = t.entry[k];
      const Mat3& A = value[e.value];
      Real* at = panel + static_cast<std::size_t>(3 * e.column) * height + 3 * e.row;
      for (int j = 0; j < 3; ++j, at += height)
        for (int i = 0; i < 3; ++i) at[i] = static_cast<Real>(e.transposed ? A(j, i) : A(i, j));
    }
    const auto add_children = [&](bool to_panel, Real* F) {
      for (Index k = t.child_start[s]; k < t.child_start[s + 1]; ++k)
        if (const Index c = t.child[k]; left[c]) add_left(t, c, left[c].get(), rows, columns, to_panel, F);
    };
    add_children(true, panel);
    if (below > 0) left[s].reset(new Real[9 * static_cast<std::size_t>(below) * below]);
    if (!eliminate(height, 3 * columns, panel, left[s].get())) {
      failed = true;
      return;
    }
    if (below > 0) add_children(false, left[s].get());
    for (Index k = t.child_start[s]; k < t.child_start[s + 1]; ++k) left[t.child[k]].reset();
    smallest[s] = largest[s] = panel[0];
    for (int j = 0; j < 3 * columns; ++j) {
      const Real d = panel[static_cast<std::size_t>(j) * height + j];
      if (!(d > 0) || !std::isfinite(d)) failed = true;
      smallest[s] = std::min(smallest[s], d), largest[s] = std::max(largest[s], d);
    }
  };
  Tree(t).up(front);
  if (failed) return false;
  const double low = *std::min_element(smallest.begin(), smallest.end()), high = *std::max_element(largest.begin(), largest.end());
  reciprocal_condition_ = low * low / (high * high);
  return true;
}

template <class Real>
void Factor<Real>::solve(const Supernodes& t, const Vec3* b, Vec3* x) {
  const std::size_t n = t.order.size();
  place_.resize(3 * n), left_.resize(3 * t.left.back());
  Real *const y = place_.data(), *const left = left_.data();
  for (std::size_t k = 0; k < n; ++k)
    for (int i = 0; i < 3; ++i) y[3 * k + i] = static_cast<Real>(b[t.order[k]][i]);
  const Tree tree(t);
  // L y = b: every supernode takes over what its children left, and leaves what its own share makes of the rows below.
  tree.up([&](Index s) {
    const Index columns = t.columns(s), below = t.rows(s) - columns, height = 3 * t.rows(s);
    const Real* panel = panels_.get() + t.panel[s];
    Real *own = y + 3 * t.first[s], *rest = left + 3 * t.left[s];
    std::fill(rest, rest + 3 * below, Real(0));
    for (Index k = t.child_start[s]; k < t.child_start[s + 1]; ++k) {
      const Index c = t.child[k], n = t.rows(c) - t.columns(c);
      const Index* to = t.to_parent.data() + t.row_start[c] + t.columns(c);
      const Real* from = left + 3 * t.left[c];
      for (Index j = 0; j < n; ++j, from += 3) {
        Real* at = to[j] < columns ? own + 3 * to[j] : rest + 3 * (to[j] - columns);
        at[0] += from[0], at[1] += from[1], at[2] += from[2];
      }
    }
    divide_large(false, 3 * columns, panel, height, own);
    subtract_large(false, 3 * below, 3 * columns, panel + 3 * columns, height, own, rest);
  });
  // L^T x = y
  tree.down([&](Index s) {
    const Index columns = t.columns(s), below = t.rows(s) - columns, height = 3 * t.rows(s);
    const Real* panel = panels_.get() + t.panel[s];
    Real *own = y + 3 * t.first[s], *rest = left + 3 * t.left[s];
    const Index* row = t.row.data() + t.row_start[s] + columns;
    for (Index j = 0; j < below; ++j)
      for (int i = 0; i < 3; ++i) rest[3 * j + i] = y[3 * row[j] + i];
    subtract_large(true, 3 * below, 3 * columns, panel + 3 * columns, height, rest, own);
    divide_large(true, 3 * columns, panel, height, own);
  });
  for (std::size_t k = 0; k < n; ++k)
    for (int i = 0; i < 3; ++i) x[t.order[k]][i] = y[3 * k + i];
}

template class Factor<double>;
template class Factor<float>;

}  // namespace mortise::linalg::cholesky
