#include "linalg/cholesky/supernodes.h"

#include <cholmod.h>

#include <algorithm>

#include "base/error.h"
#include "linalg/cholesky/tuning.h"

namespace mortise::linalg::cholesky {
namespace {

// CHOLMOD's state, and the graph of a matrix in it.
struct Graph {
  cholmod_common common;
  cholmod_sparse* graph = nullptr;
  cholmod_factor* factor = nullptr;

  Graph(const std::vector<Index>& row_start, const std::vector<Index>& col) {
    cholmod_start(&common);
    common.print = 0;
    common.supernodal = CHOLMOD_SUPERNODAL;
    const std::size_t rows = row_start.size() - 1;
    graph = cholmod_allocate_sparse(rows, rows, col.size(), 1, 1, -1, CHOLMOD_PATTERN, &common);
    check();
    std::copy(row_start.begin(), row_start.end(), static_cast<int*>(graph->p));
    std::copy(col.begin(), col.end(), static_cast<int*>(graph->i));
  }
  ~Graph() {
    cholmod_free_factor(&factor, &common);
    cholmod_free_sparse(&graph, &common);
    cholmod_finish(&common);
  }
  Graph(const Graph&) = delete;
  Graph& operator=(const Graph&) = delete;

  void check() const {
    if (common.status == CHOLMOD_OUT_OF_MEMORY || common.status == CHOLMOD_TOO_LARGE)
      throw Error(Exit::device, "out of memory in the analysis of the direct solver; use `linear: cg`");
    if (common.status < 0) throw Error(Exit::internal, "CHOLMOD error " + std::to_string(common.status) + " in the analysis");
  }

  void analyse(const std::vector<Index>& order) {
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_GIVEN;
    std::copy(std::begin(tuning::kMergedColumns), std::end(tuning::kMergedColumns), common.nrelax);
    std::copy(std::begin(tuning::kMergedZeros), std::end(tuning::kMergedZeros), common.zrelax);
    factor = cholmod_analyze_p(graph, const_cast<Index*>(order.data()), nullptr, 0, &common);
    check();
  }
};

template <class T>
std::vector<T> copy(const void* from, std::size_t n) {
  const T* p = static_cast<const T*>(from);
  return {p, p + n};
}

// Parents and children, rows in the parents' panels, and what all below a supernode costs. of_place: the supernode that eliminates it.
void link(const std::vector<Index>& of_place, Supernodes& t) {
  const Index n = t.count();
  std::vector<Index> parent(n, n);
  t.begin.resize(n + 1), t.child_start.assign(n + 2, 0), t.child.resize(n), t.flops.assign(n + 1, 0.0);
  for (Index s = 0; s <= n; ++s) t.begin[s] = s < n ? s : 0;
  t.to_parent.assign(t.row.size(), -1);
  for (Index s = 0; s < n; ++s) {
    const double k = 3.0 * t.columns(s), left = 3.0 * (t.rows(s) - t.columns(s));
    t.flops[s] += k * k * k / 3 + k * k * left + k * left * left;
    if (left > 0) parent[s] = of_place[t.row[t.row_start[s] + t.columns(s)]];
    const Index p = parent[s];
    t.begin[p] = std::min(t.begin[p], t.begin[s]);
    t.flops[p] += t.flops[s];
    ++t.child_start[p + 1];
    std::size_t at = p < n ? t.row_start[p] : 0;
    for (std::size_t i = t.row_start[s] + t.columns(s); i < t.row_start[s + 1]; ++i) {
      while (at < t.row_start[p + 1] && t.row[at] < t.row[i]) ++at;
      if (at == t.row_start[p + 1] || t.row[at] != t.row[i]) throw Error(Exit::internal, "a supernode's rows are not among its parent's");
      t.to_parent[i] = static_cast<Index>(at - t.row_start[p]);
    }
  }
  for (Index s = 0; s <= n; ++s) t.child_start[s + 1] += t.child_start[s];
  std::vector<Index> at(t.child_start.begin(), t.child_start.end() - 1);
  for (Index s = 0; s < n; ++s) t.child[at[parent[s]]++] = s;
}

// Where the blocks of the matrix go.
void place_blocks(const std::vector<Index>& row_start, const std::vector<Index>& col, const std::vector<Index>& of_place, Supernodes& t) {
  const Index n = t.count(), rows = static_cast<Index>(t.order.size());
  std::vector<Index> place(rows);
  for (Index k = 0; k < rows; ++k) place[t.order[k]] = k;
  t.entries.assign(n + 1, 0);
  for (Index r = 0; r < rows; ++r)
    for (Index k = row_start[r]; k < row_start[r + 1]; ++k) ++t.entries[of_place[std::min(place[r], place[col[k]])] + 1];
  for (Index s = 0; s < n; ++s) t.entries[s + 1] += t.entries[s];
  t.entry.resize(col.size());
  std::vector<std::size_t> at(t.entries.begin(), t.entries.end() - 1);
  for (Index r = 0; r < rows; ++r)
    for (Index k = row_start[r]; k < row_start[r + 1]; ++k) {
      const Index lower = std::max(place[r], place[col[k]]), upper = std::min(place[r], place[col[k]]), s = of_place[upper];
      t.entry[at[s]++] = {k, lower, upper - t.first[s], place[r] == upper && lower != upper};
    }
  // From places to rows of the panel.
  std::vector<Index> row_of(rows);
  for (Index s = 0; s < n; ++s) {
    for (std::size_t i = t.row_start[s]; i < t.row_start[s + 1]; ++i) row_of[t.row[i]] = static_cast<Index>(i - t.row_start[s]);
    for (std::size_t k = t.entries[s]; k < t.entries[s + 1]; ++k) t.entry[k].row = row_of[t.entry[k].row];
  }
}

}  // namespace

Supernodes find_supernodes(const std::vector<Index>& row_start, const std::vector<Index>& col, const std::vector<Index>& order) {
  Supernodes t;
  {
    Graph graph(row_start, col);
    graph.analyse(order);
    const cholmod_factor& L = *graph.factor;
    t.order = copy<Index>(L.Perm, L.n);
    t.first = copy<Index>(L.super, L.nsuper + 1);
    t.row = copy<Index>(L.s, L.ssize);
    const std::vector<Index> start = copy<Index>(L.pi, L.nsuper + 1);
    t.row_start.assign(start.begin(), start.end());
  }
  const Index n = t.count();
  std::vector<Index> of_place(t.order.size());
  for (Index s = 0; s < n; ++s) std::fill(of_place.begin() + t.first[s], of_place.begin() + t.first[s + 1], s);
  link(of_place, t);
  t.panel.assign(n + 1, 0), t.left.assign(n + 1, 0);
  for (Index s = 0; s < n; ++s) {
    t.panel[s + 1] = t.panel[s] + 9 * static_cast<std::size_t>(t.rows(s)) * t.columns(s);
    t.left[s + 1] = t.left[s] + (t.rows(s) - t.columns(s));
  }
  place_blocks(row_start, col, of_place, t);
  return t;
}

}  // namespace mortise::linalg::cholesky
