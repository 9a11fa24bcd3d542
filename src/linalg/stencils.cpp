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
  n_ = n, uniform_ = nb, sizes_ = {n * nb, n * pair_count(nb)};
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
  fetch.add_total(offset_, sizes_.blocks);
  fetch.add_total(hess_offset_, sizes_.pairs);
}

void StencilSet::end_resize(Index n) {
  n_ = n;
  offset_.resize(n + 1), hess_offset_.resize(n + 1);
  block_.resize(sizes_.blocks);
  grad_.resize(sizes_.blocks);
  hess_.resize(0);
  pattern_changed();
}

void StencilSet::take_shape(StencilSet& from) {
  uniform_ = -1;
  n_ = from.n_, sizes_ = from.sizes_;
  offset_.swap(from.offset_), hess_offset_.swap(from.hess_offset_);
}

void StencilSet::resize(device::Buffer<Index>&& counts, StencilSizes sizes) {
  if (sizes.known()) {
    take_counts(std::move(counts));
    sizes_ = sizes;
  } else {
    device::Fetch fetch;
    begin_resize(std::move(counts), fetch);
    fetch.now("stencils");
  }
  end_resize(n_);
}

}  // namespace mortise::linalg
