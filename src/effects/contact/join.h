#pragma once
// Two lists of contact samples as one: in every environment those of the first list, then those of the second, each in its order. A law that acts in
// two ways (mortar_contact with its guard) tells of both so.
#include "model/contact_view.h"

namespace mortise::effects::contact {

// Samples `more` join those of `to`; more_env: their offsets of environments, more_sizes: of their stencils. origin: of every sample now there its
// number in the list that it comes from: i of the first, -1 - i of the second.
void join(const device::Buffer<model::ContactSample>& more, const std::vector<Index>& more_env, linalg::StencilSizes more_sizes,
          model::ContactView& to, device::Buffer<Index>& origin);

// How samples so joined change: `more`, of uniform shape and all known, joins `to`, whose samples have points of their own, or of which nothing is
// known.
void join(const device::Buffer<model::ContactSample>& joined, const device::Buffer<Index>& origin, model::SampleChanges& more,
          model::SampleChanges& to);

}  // namespace mortise::effects::contact
