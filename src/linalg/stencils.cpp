#include "linalg/stencils.h"

#include <utility>

namespace mortise::linalg {
namespace {

void count_pairs(device::View<const Index> blocks, device::View<Index> pairs) {
  device::parallel_for("stencils.offsets", blocks.n - 1, [=] MORTISE_HD(Index s) { pairs[s] = pair_count(blocks[s]); });
}

}  // namespace

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

void StencilSet::take_counts(device::Buffer<Index>&& counts) {
  uniform_ = -1;
  n_ = counts.size() - 1;
  hess_offset_.resize(n_ + 1);
  offset_.swap(counts);
  count_pairs(offset_.view(), hess_offset_.view());
  device::scan(offset_);
  device::scan(hess_offset_);
}

void StencilSet::begin_resize(device::Buffer<Index>&& counts, device::Fetch& fetch) {
  take_counts(std::move(counts));
  fetch.add_total(offset_, sum_);
  fetch.add_total(hess_offset_, pairs_);
}

void StencilSet::end_resize(Index n) {
  n_ = n;
  offset_.resize(n + 1), hess_offset_.resize(n + 1);
  block_.resize(sum_);
  grad_.resize(sum_);
  hess_.resize(0);
  pattern_changed();
}

void StencilSet::take_shape(StencilSet& from) {
  uniform_ = -1;
  n_ = from.n_, sum_ = from.sum_, pairs_ = from.pairs_;
  offset_.swap(from.offset_), hess_offset_.swap(from.hess_offset_);
}

void StencilSet::resize(device::Buffer<Index>&& counts) {
  device::Fetch fetch;
  begin_resize(std::move(counts), fetch);
  fetch.now("stencils");
  end_resize(n_);
}

void StencilSet::resize(device::Buffer<Index>&& counts, Index blocks, Index pairs) {
  take_counts(std::move(counts));
  sum_ = blocks, pairs_ = pairs;
  end_resize(n_);
}

}  // namespace mortise::linalg
