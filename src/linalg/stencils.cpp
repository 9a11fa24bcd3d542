#include "linalg/stencils.h"

namespace mortise::linalg {

bool StencilSet::resize_uniform(Index n, Index nb) {
  if (n == n_ && nb == uniform_) return false;
  n_ = n, uniform_ = nb, pairs_ = n * pair_count(nb);
  offset_.resize(n + 1);
  hess_offset_.resize(n + 1);
  const auto off = offset_.view(), hoff = hess_offset_.view();
  device::parallel_for("stencils.offsets", n + 1, [=] MORTISE_HD(Index s) {
    off[s] = s * nb;
    hoff[s] = s * pair_count(nb);
  });
  block_.resize(n * nb);
  grad_.resize(n * nb);
  hess_.resize(0);
  pattern_changed();
  return true;
}

void StencilSet::resize(device::Buffer<Index>&& counts) {
  uniform_ = -1;
  n_ = counts.size() - 1;
  hess_offset_.resize(n_ + 1);
  const device::View<const Index> c = counts.view();
  const auto hoff = hess_offset_.view();
  const Index n = n_;
  device::parallel_for("stencils.offsets", n, [=] MORTISE_HD(Index s) { hoff[s] = pair_count(c[s]); });
  offset_.swap(counts);
  device::scan(offset_);
  device::scan(hess_offset_);
  Index blocks = 0;
  device::Fetch fetch;
  fetch.add_total(offset_, blocks);
  fetch.add_total(hess_offset_, pairs_);
  fetch.now();
  block_.resize(blocks);
  grad_.resize(blocks);
  hess_.resize(0);
  pattern_changed();
}

}  // namespace mortise::linalg
