#include "effects/contact/change_stencils.h"

namespace mortise::effects::contact {

using device::Buffer;
using device::View;

void shape(const model::PointMapView& point_map, model::SampleChanges& changes, Index samples, linalg::StencilSet& out) {
  const model::PointMapView map = point_map;
  const model::SampleChangesView change = changes.view();
  Buffer<Index> counts(samples + 1);
  const View<Index> count = counts.view();
  device::parallel_for("contact.count_changed", samples, [=] MORTISE_HD(Index i) { count[i] = changed_blocks(map, change, i).blocks; });
  out.resize(std::move(counts), changes.sizes);
  const linalg::StencilView to = out.view();
  device::parallel_for("contact.changed", samples, [=] MORTISE_HD(Index i) {
    const auto e = changed_blocks(map, change, i);
    for (Index b = 0; b < e.blocks; ++b) to.block[to.offset[i] + b] = e.block[b];
  });
  out.pattern_changed();
}

}  // namespace mortise::effects::contact
