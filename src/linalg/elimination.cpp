#include "linalg/elimination.h"

#include "linalg/upper_block.h"

namespace mortise::linalg {

void Elimination::set(const std::vector<Index>& offset, const std::vector<Index>& column, const std::vector<double>& weight, Index rows) {
  offset_.upload(offset), column_.upload(column), weight_.upload(weight);
  rows_ = rows;
  of_ = 0;
}

void Elimination::find_pieces(const BlockMatrix& K) {
  const View<const Index> row = K.row.view(), col = K.col.view(), offset = offset_.view(), column = column_.view();
  const View<const double> weight = weight_.view();
  Buffer<Index> first(K.upper_blocks() + 1);
  const View<Index> count = first.view();
  device::parallel_for("elimination.count", K.upper_blocks(), [=] MORTISE_HD(Index k) {
    const Index i = row[k], j = col[k], ni = offset[i + 1] - offset[i], nj = offset[j + 1] - offset[j];
    count[k] = i == j ? ni * (ni + 1) / 2 : ni * nj;
  });
  const Index n = device::exclusive_scan(first);
  piece_.resize(n), product_.resize(n), entry_.resize(n);
  Buffer<std::uint64_t> keys(n);
  const View<std::uint64_t> key = keys.view();
  const View<Index> piece = piece_.view();
  const View<const Index> begin = std::as_const(first).view();
  const View<double> product = product_.view();
  const View<std::uint8_t> entry = entry_.view();
  const Index rows = rows_;
  device::parallel_for("elimination.pieces", K.upper_blocks(), [=] MORTISE_HD(Index k) {
    const Index i = row[k], j = col[k];
    Index e = begin[k];
    for (Index s = offset[i]; s < offset[i + 1]; ++s)
      for (Index t = i == j ? s : offset[j]; t < offset[j + 1]; ++t, ++e) {
        const Index a = column[s], b = column[t];
        piece[e] = k;
        product[e] = weight[s] * weight[t];
        key[e] = a <= b ? block_key(a, b, rows) : block_key(b, a, rows);
        entry[e] = i != j && a == b ? both : a > b ? transposed : direct;
      }
  });
  group(std::move(keys), device::kNoKey, groups_);
}

void Elimination::reduce(const BlockMatrix& K, BlockMatrix& A) {
  if (of_ != K.pattern) {
    find_pieces(K);
    of_ = K.pattern;
    pattern_ = 0;
  }
  if (pattern_ == 0 || A.pattern != pattern_) {
    set_pattern(groups_.key, rows_, A);  // every row that stays has its diagonal block in K
    pattern_ = A.pattern;
  }
  const View<const Index> piece = piece_.view();
  const View<const double> product = product_.view();
  const View<const std::uint8_t> entry = entry_.view();
  const View<const Mat3> from = K.value.view();
  const View<Mat3> to = A.value.view();
  grouped_sum<Mat3>(
      "elimination.sum", groups_,
      [=] MORTISE_HD(Index e) -> Mat3 {
        const Mat3& H = from[piece[e]];
        if (entry[e] == direct) return product[e] * H;
        if (entry[e] == transposed) return product[e] * H.transpose();
        return product[e] * (H + H.transpose());
      },
      [=] MORTISE_HD(Index k, const Mat3& t) { to[k] = t; });
}

}  // namespace mortise::linalg
