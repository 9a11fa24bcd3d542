#pragma once
#include "linalg/rank_ones.h"
#include "model/contact_view.h"

namespace mortise::effects {

// An effect at one state q: a value that its owner keeps, fills anew at another state, and may hold beside others. Its buffers are used again.
// Effects that freeze more derive from it.
struct Linearisation {
  virtual ~Linearisation() = default;
  // Forces and, as far as wanted, the symmetric part of their Jacobian.
  linalg::StencilSet stencils;
  // What the Jacobian has besides, where that was wanted: pieces of rank one, not symmetric, beside each stencil, or each of `beside`, where other
  // blocks take part.
  linalg::RankOnes unsymmetric;
  linalg::StencilSet beside;
  linalg::StencilSet& of_unsymmetric() { return beside.size() > 0 ? beside : stencils; }
  bool shaped = false;  // the blocks of `stencils` are written: for effects that always have the same
  // Samples of a contact effect, once sample() was called.
  model::ContactView contact;
  virtual std::size_t bytes() const { return stencils.bytes() + unsymmetric.bytes() + beside.bytes() + contact.samples.bytes(); }
};

}  // namespace mortise::effects
