#pragma once
// What an effect hands to assembly: a set of small dense pieces ("stencils"). Stencil s couples the blocks
// block[offset[s]] ... block[offset[s+1]-1]; each block is one 3-vector degree of freedom. Per block it carries a gradient
// 3-vector [N], and for every pair a <= b of its blocks (row by row of the upper triangle) a 3x3 Hessian piece [N/m],
// H(a,b) = d gradient_a / d q_b. A block id of -1 is an unused slot. Ids may repeat inside a stencil.
#include "device/device.h"

namespace mortise::linalg {

MORTISE_HD inline Index pair_count(Index blocks) { return blocks * (blocks + 1) / 2; }
// Place of pair (a <= b) in the row-by-row upper triangle of an nb x nb array.
MORTISE_HD inline Index pair_place(Index a, Index b, Index nb) { return a * nb - a * (a - 1) / 2 + (b - a); }

// How many blocks the stencils of a set have in all, and pairs of them; -1 where that is not known.
struct StencilSizes {
  Index blocks = -1, pairs = -1;
  bool known() const { return blocks >= 0; }
  // Of two sets together.
  StencilSizes operator+(const StencilSizes& o) const {
    return known() && o.known() ? StencilSizes{blocks + o.blocks, pairs + o.pairs} : StencilSizes{};
  }
};

struct StencilView {
  device::View<const Index> offset;       // stencils + 1
  device::View<const Index> hess_offset;  // stencils + 1
  device::View<Index> block;
  device::View<Vec3> grad;
  device::View<Mat3> hess;
  Index n = 0;
  MORTISE_HD Index blocks(Index s) const { return offset[s + 1] - offset[s]; }
};

class StencilSet {
 public:
  // n stencils of nb blocks each. Does nothing, and says so, when that is the present shape.
  bool resize_uniform(Index n, Index nb);
  // Stencil s gets counts[s] blocks; counts has n+1 values, the last is ignored. Consumes the buffer. Where their sizes are not known the host waits.
  void resize(device::Buffer<Index>&& counts, StencilSizes sizes = {});
  // The same in two halves, between which `fetch` brings the sums; then all but the first n have to be without blocks, and are none.
  void begin_resize(device::Buffer<Index>&& counts, device::Fetch& fetch);
  void end_resize(Index n);
  // Takes over what begin_resize() of `from` was told, in place of its own; end_resize() comes next.
  void take_shape(StencilSet& from);
  // Room for the Hessian pieces, which a new shape is without.
  void need_hessian() { hess_.resize(sizes_.pairs); }
  bool has_hessian() const { return hess_.size() == sizes_.pairs; }
  // Must be called after the block ids were (re)written, and only then: assembly reuses its sorting while this stands.
  void pattern_changed() { ++version_; }

  Index size() const { return n_; }
  StencilSizes sizes() const { return sizes_; }
  std::uint64_t version() const { return version_; }
  std::size_t bytes() const { return offset_.bytes() + hess_offset_.bytes() + block_.bytes() + grad_.bytes() + hess_.bytes(); }
  device::View<const Index> offsets() const { return offset_.view(); }
  device::View<const Index> blocks() const { return block_.view(); }
  StencilView view() { return {offset_.view(), hess_offset_.view(), block_.view(), grad_.view(), hess_.view(), n_}; }

 private:
  void take_counts(device::Buffer<Index>&& counts);

  Index n_ = 0;
  StencilSizes sizes_{0, 0};
  Index uniform_ = -1;
  std::uint64_t version_ = 0;
  device::Buffer<Index> offset_, hess_offset_, block_;
  device::Buffer<Vec3> grad_;
  device::Buffer<Mat3> hess_;
};

}  // namespace mortise::linalg
