#include "effects/friction/slips.h"

#include <utility>

#include "model/expand.h"

namespace mortise::effects::friction {

using device::Buffer;

MORTISE_HD inline Index distinct_blocks(const model::PointMapView& map, const ContactSample& s) {
  return model::expand<model::kSamplePoints>(map, s.point, s.points).blocks;
}

void freeze(const model::PointMapView& map, const Buffer<ContactSample>& samples, const model::ContactView& view, View<const double> mu,
            geometry::BodyPairsView pairs, const AnchorsView& anchors, linalg::StencilSet& stencils, Buffer<double>& weights,
            Buffer<FrozenContact>& frozen) {
  const View<const ContactSample> sample = samples.view();
  Buffer<Index> counts(sample.n + 1);
  const View<Index> count = counts.view();
  device::parallel_for("friction.count_blocks", sample.n, [=] MORTISE_HD(Index i) { count[i] = distinct_blocks(map, sample[i]); });
  stencils.resize(std::move(counts), view.sizes);
  const linalg::StencilView out = stencils.view();
  weights.resize(out.block.n);
  frozen.resize(sample.n);
  const View<double> weight = weights.view();
  const AnchorsView held = anchors;
  const View<FrozenContact> to = frozen.view();
  device::parallel_for("friction.freeze", sample.n, [=] MORTISE_HD(Index i) {
    const ContactSample& s = sample[i];
    const auto e = model::expand<model::kSamplePoints>(map, s.point, s.points);
    const Index at = out.offset[i];
    for (Index b = 0; b < e.blocks; ++b) out.block[at + b] = e.block[b];
    e.chain(s.weight, weight.p + at);
    to[i].normal = Vec3(s.normal[0], s.normal[1], s.normal[2]);
    to[i].mu = mu[pairs.of(s.body_a, s.body_b)];
    to[i].load = to[i].mu * s.force;
    to[i].anchor = Vec3::Zero();
    for (Index k = 0; k < s.points; ++k) to[i].anchor += s.weight[k] * held.of(s, k);
  });
}

std::vector<Rub> measure(const Slips& s, Positions q) {
  Buffer<Rub> rubs(s.size());
  const View<Rub> rub = rubs.view();
  device::parallel_for("friction.measure", s.size(), [=] MORTISE_HD(Index i) {
    const Vec3 slip = s.slip(i, q), r = s.moved(i, q);
    // r is the motion of the first body against an obstacle, else that of the second against the first.
    const double sign = model::against_obstacle(s.sample[i]) ? 1 : -1;
    const double x = slip.norm();
    rub[i] = {(-sign * s.frozen[i].load * f1_over_x(x, s.creep(i))) * slip, sign * r, x < s.creep(i)};
  });
  return rubs.download();
}

}  // namespace mortise::effects::friction
