#include "linalg/scalar_csr.h"

#include <algorithm>

#include "base/error.h"

namespace mortise::linalg {

void ScalarCsr::set_pattern(const BlockMatrix& A, const std::vector<int>& order) {
  const std::vector<Index> full_start = A.full_start.download(), full_col = A.full_col.download(), full_source = A.full_source.download();
  std::vector<Index> place(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) place[order[k]] = static_cast<Index>(k);
  if (9 * static_cast<std::size_t>(full_col.size()) > 0x7fffffff)
    throw Error(Exit::device, "the matrix is too large for the direct solver; use `linear: cg`");
  std::vector<Index> start{0}, col, source;
  col.reserve(9 * full_col.size()), source.reserve(9 * full_col.size());
  std::vector<std::pair<Index, Index>> row;  // new column, place in the full structure
  for (int r : order) {
    row.clear();
    for (Index k = full_start[r]; k < full_start[r + 1]; ++k) row.emplace_back(place[full_col[k]], full_source[k]);
    std::sort(row.begin(), row.end());
    for (int i = 0; i < 3; ++i) {
      for (const auto& [c, k] : row)
        for (int j = 0; j < 3; ++j) {
          col.push_back(3 * c + j);
          source.push_back(k >= 0 ? 9 * k + 3 * j + i : 9 * ~k + 3 * i + j);
        }
      start.push_back(static_cast<Index>(col.size()));
    }
  }
  order_.upload(std::vector<Index>(order.begin(), order.end()));
  start_.upload(start), col_.upload(col), source_.upload(source);
  value_.resize(col_.size());
}

void ScalarCsr::set_values(const BlockMatrix& A) {
  const View<const Mat3> block = A.value.view();
  const View<const Index> source = source_.view();
  const View<double> value = value_.view();
  device::parallel_for("csr.values", value.n, [=] MORTISE_HD(Index e) { value[e] = block[source[e] / 9].data()[source[e] % 9]; });
}

void ScalarCsr::to(View<const Vec3> v, View<double> out) const {
  const View<const Index> order = order_.view();
  device::parallel_for("csr.to", out.n, [=] MORTISE_HD(Index i) { out[i] = v[order[i / 3]][i % 3]; });
}

void ScalarCsr::from(View<const double> v, View<Vec3> out) const {
  const View<const Index> order = order_.view();
  device::parallel_for("csr.from", v.n, [=] MORTISE_HD(Index i) { out[order[i / 3]][i % 3] = v[i]; });
}

}  // namespace mortise::linalg
