#include <utility>

#include "effects/contact/change_stencils.h"
#include "effects/mortar_contact/averaged.h"
#include "effects/mortar_contact/node_entries.h"
#include "model/expand.h"

namespace mortise::effects::mortar {

void shape_with_nodes(const MortarView& s, const FrozenSamples& f, model::SampleChanges& changes, const model::PointMapView& point_map,
                      NodePieces& nodes, linalg::StencilSet& beside) {
  const Settings set = s.set;
  const model::SampleChangesView change = changes.view();
  const View<const Pair> pairs = f.pairs.view();
  const View<const Sample> samples = f.samples.view();
  const View<const Index> node = f.averages.node.view();
  const View<const double> area = f.averages.area.view(), gap = f.averages.gap.view(), kappa = s.kappa;
  const View<const Vec3> y = f.y.view();
  const Moving wanted = f.moving.wanted;
  const model::PointMapView map = point_map;
  // A part is what one sample contributes to one node of its slave.
  const Index parts = 3 * samples.n;
  Buffer<Index> counts(parts + 1);
  const View<Index> at = counts.view();
  device::parallel_for("mortar_contact.count_moving_entries", parts, [=] MORTISE_HD(Index i) {
    const Sample& sample = samples[i / 3];
    const Pair& p = pairs[sample.pair];
    const Index n = node[3 * sample.pair + i % 3];
    const bool acts = is_averaged(set, p, sample) && wanted.in(p.env) && area[n] > 0 && gap[n] < p.d_hat;
    at[i] = acts ? contact::changed_blocks(map, change, i / 3).blocks : 0;
  });
  const Index n = device::exclusive_scan(counts);
  Buffer<std::uint64_t> keys(n);
  Buffer<Index> order(n), start;
  Buffer<Vec3> left(n), right(n);
  {
    const View<std::uint64_t> k = keys.view();
    const View<Index> o = order.view();
    const View<Vec3> l = left.view(), r = right.view();
    device::parallel_for("mortar_contact.moving_entries", parts, [=] MORTISE_HD(Index i) {
      if (at[i + 1] == at[i]) return;
      const Index of = i / 3, a = i % 3;
      const Sample& sample = samples[of];
      const Pair& p = pairs[sample.pair];
      const Index own = node[3 * sample.pair + a];
      const auto e = contact::changed_blocks(map, change, of);
      const double w = sample.weight, N = sample.N[a], off = sample.gap - gap[own];
      Vec3 J[kPoints], z[model::kChangePoints];
      jacobian(p, sample, J);
      for (Vec3& none : z) none = Vec3::Zero();
      for (Index q = 0; q < points_of(p); ++q) z[q] = kappa[p.interface] * barrier::second(gap[own], p.d_hat) * w * N * J[q];
      e.chain(z, l.p + at[i]);
      for (Index q = 0; q < change.points(of); ++q) z[q] = Vec3::Zero();
      for (Index c = kFirstMoved; c < change.functionals; ++c) {
        double by = w * N * gap_by(p, sample, c, y);  // (g - g_a) d(w N_a) + w N_a dg
        if (c == kFirstMoved + 4) by += off * N;
        if (c < kFirstMoved + 2) by += off * w * (a == 0 ? -1 : a == c - kFirstMoved + 1 ? 1 : 0);
        if (by == 0) continue;
        for (Index q = 0; q < change.points(of); ++q) z[q] += by / area[own] * change.along(of, c)[q];
      }
      e.chain(z, r.p + at[i]);
      for (Index b = 0; b < e.blocks; ++b) k[at[i] + b] = entry_key(own, e.block[b]), o[at[i] + b] = at[i] + b;
    });
  }
  merge(keys, area.n, order, start, nodes.offset, nodes.block);
  const View<const Vec3> l = std::as_const(left).view(), r = std::as_const(right).view();
  const View<const Index> o = std::as_const(order).view();
  device::segment_sum(
      "mortar_contact.merge_left", start, [=] MORTISE_HD(Index j) { return Vec3(l[o[j]]); }, nodes.left);
  device::segment_sum(
      "mortar_contact.merge_right", start, [=] MORTISE_HD(Index j) { return Vec3(r[o[j]]); }, nodes.right);

  Buffer<Index> blocks(samples.n + area.n + 1);
  const View<Index> count = blocks.view();
  const View<const Index> entry = std::as_const(nodes.offset).view(), block = std::as_const(nodes.block).view();
  device::parallel_for("mortar_contact.count_beside", samples.n + area.n, [=] MORTISE_HD(Index i) {
    const Index own = i - samples.n;
    count[i] = own < 0 ? contact::changed_blocks(map, change, i).blocks : entry[own + 1] - entry[own];
  });
  beside.resize(std::move(blocks));
  const linalg::StencilView to = beside.view();
  device::parallel_for("mortar_contact.beside", samples.n + area.n, [=] MORTISE_HD(Index i) {
    const Index own = i - samples.n;
    if (own < 0) {
      const auto e = contact::changed_blocks(map, change, i);
      for (Index b = 0; b < e.blocks; ++b) to.block[to.offset[i] + b] = e.block[b];
    } else {
      for (Index b = entry[own]; b < entry[own + 1]; ++b) to.block[to.offset[i] + b - entry[own]] = block[b];
    }
  });
  beside.pattern_changed();
}

}  // namespace mortise::effects::mortar
