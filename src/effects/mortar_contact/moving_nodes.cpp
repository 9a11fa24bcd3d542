#include <utility>

#include "effects/mortar_contact/moving_parts.h"
#include "effects/mortar_contact/neighbours.h"

namespace mortise::effects::mortar {

MovingView view_of(Motion& moving) { return {std::as_const(moving.start).view(), std::as_const(moving.node).view(), moving.by.view()}; }

void find_nodes(const Stage& stage, const model::PointMapView& point_map, FrozenSamples& out) {
  const Stage s = stage;
  const View<const Pair> pairs = std::as_const(out.pairs).view();
  const View<const Sample> samples = std::as_const(out.samples).view();
  Motion& moving = out.moving;
  const Moving wanted = moving.wanted;
  moving.start.resize(samples.n + 1), moving.partly.resize(samples.n);
  Buffer<Index> of_nodes(2 * samples.n + 1);  // blocks of all, then pairs of all
  const View<Index> count = moving.start.view(), blocks = of_nodes.view();
  const View<std::uint8_t> partly = moving.partly.view();
  const model::PointMapView map = point_map;
  device::parallel_for("mortar_contact.count_nodes", samples.n, [=] MORTISE_HD(Index i) {
    const NodeList list = nodes_of(s, pairs[samples[i].pair], samples[i], wanted.in(pairs[samples[i].pair].env));
    count[i] = list.n, partly[i] = list.all ? 0 : kLost;
    blocks[i] = model::expand<model::kChangePoints>(map, list.id, list.n).blocks;
    blocks[samples.n + i] = linalg::pair_count(blocks[i]);
  });
  device::scan(moving.start);
  device::scan(of_nodes);
  Index nodes = 0, all = 0;
  device::Fetch fetch;
  fetch.add_total(moving.start, nodes);
  fetch.add(View<const Index>{blocks.p + samples.n, 1}, [&](const std::vector<Index>& sum) { moving.sizes.blocks = sum[0]; });
  fetch.add_total(of_nodes, all);
  fetch.now("nodes of samples");
  moving.sizes.pairs = all - moving.sizes.blocks;
  moving.node.resize(nodes);
  moving.by.resize(kMoved * moving.node.size());
  moving.by.zero();
  const View<const Index> start = std::as_const(moving.start).view();
  const View<Index> node = moving.node.view();
  device::parallel_for("mortar_contact.nodes_of", samples.n, [=] MORTISE_HD(Index i) {
    const NodeList list = nodes_of(s, pairs[samples[i].pair], samples[i], wanted.in(pairs[samples[i].pair].env));
    for (int k = 0; k < list.n; ++k) node[start[i] + k] = list.id[k];
  });
}

}  // namespace mortise::effects::mortar
