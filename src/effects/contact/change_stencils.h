#pragma once
// Stencils of the points that samples hang on (model::SampleChanges), for pieces of the Jacobian that reach beyond the samples' own points.
#include "linalg/stencils.h"
#include "model/contact_view.h"
#include "model/expand.h"

namespace mortise::effects::contact {

template <Index N = model::kChangePoints>
MORTISE_HD inline model::Expansion<N> changed_blocks(const model::PointMapView& map, const model::SampleChangesView& changes, Index i) {
  return model::expand<N>(map, changes.node.p + changes.start[i], changes.points(i));
}

// One per sample, with its blocks; without gradients and Hessians.
void shape(const model::PointMapView& map, model::SampleChanges& changes, Index samples, linalg::StencilSet& out);

}  // namespace mortise::effects::contact
