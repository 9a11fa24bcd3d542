#include "effects/mortar_contact/averaged.h"

#include <utility>

#include "effects/body_blocks.h"
#include "effects/contact/barrier.h"
#include "effects/mortar_contact/node_entries.h"
#include "model/expand.h"

namespace mortise::effects::mortar {
namespace {

// Adds w N_a J of the averaged samples of a pair to J_a.
MORTISE_HD inline void weigh(const Settings& set, const Pair& p, View<const Sample> samples, int a, Vec3 sum[kPoints]) {
  for (int k = 0; k < points_of(p); ++k) sum[k] = Vec3::Zero();
  Vec3 J[kPoints];
  for (Index j = p.begin; j < p.end; ++j) {
    if (!is_averaged(set, p, samples[j])) continue;
    jacobian(p, samples[j], J);
    for (int k = 0; k < points_of(p); ++k) sum[k] += samples[j].weight * samples[j].N[a] * J[k];
  }
}

}  // namespace

// A part is what one pair contributes to one node of its slave: part 3 i + a of pair i.
void average(const MortarView& s, FrozenSamples& f) {
  const View<const Pair> pairs = std::as_const(f.pairs).view();
  const View<const Sample> samples = std::as_const(f.samples).view();
  const Settings set = s.set;
  const View<const double> kappa = s.kappa;
  f.pressure.resize(samples.n);
  const View<double> pressure = f.pressure.view();
  Averages& out = f.averages;
  if (!set.averaged || pairs.n == 0) {
    out.area.resize(0), out.gap.resize(0), out.interface.resize(0), out.node.resize(0);
    out.env_nodes.assign(f.env_pairs.size(), 0);
    device::parallel_for("mortar_contact.pressure", samples.n, [=] MORTISE_HD(Index i) {
      const Pair& p = pairs[samples[i].pair];
      pressure[i] = -kappa[p.interface] * barrier::first(samples[i].gap, p.d_hat);
    });
    return;
  }
  const Index parts = 3 * pairs.n, interfaces = kappa.n;
  Buffer<std::uint64_t> keys(parts);
  Buffer<double> area_buffer(parts), moment_buffer(parts);
  out.part.resize(parts), out.node.resize(parts);
  {
    const View<std::uint64_t> k = keys.view();
    const View<double> area = area_buffer.view(), moment = moment_buffer.view();
    const View<Index> part = out.part.view();
    device::parallel_for("mortar_contact.parts", parts, [=] MORTISE_HD(Index i) {
      const Pair& p = pairs[i / 3];
      const int a = i % 3;
      k[i] = entry_key(p.env * interfaces + p.interface, p.on.point[a]);
      part[i] = i;
      area[i] = moment[i] = 0;
      for (Index j = p.begin; j < p.end; ++j) {
        if (!is_averaged(set, p, samples[j])) continue;
        area[i] += samples[j].weight * samples[j].N[a];
        moment[i] += samples[j].weight * samples[j].N[a] * samples[j].gap;
      }
    });
  }
  device::sort_pairs(keys, out.part);
  device::run_starts(keys, out.start);
  const View<const Index> part = std::as_const(out.part).view(), start = std::as_const(out.start).view();
  const View<const double> area = std::as_const(area_buffer).view(), moment = std::as_const(moment_buffer).view();
  device::segment_sum(
      "mortar_contact.node_area", out.start, [=] MORTISE_HD(Index j) { return area[part[j]]; }, out.area);
  device::segment_sum(
      "mortar_contact.node_gap", out.start, [=] MORTISE_HD(Index j) { return moment[part[j]]; }, out.gap);
  const Index nodes = out.area.size();
  out.interface.resize(nodes);
  Buffer<Index> env_buffer(nodes);
  const View<Index> node = out.node.view(), interface = out.interface.view(), env = env_buffer.view();
  const View<double> gap = out.gap.view();
  const View<const double> node_area = std::as_const(out.area).view(), d_hat = s.d_hat;
  device::parallel_for("mortar_contact.nodes", nodes, [=] MORTISE_HD(Index i) {
    const Pair& p = pairs[part[start[i]] / 3];
    interface[i] = p.interface, env[i] = p.env;
    gap[i] = node_area[i] > 0 ? gap[i] / node_area[i] : 2 * d_hat[p.interface];
    for (Index j = start[i]; j < start[i + 1]; ++j) node[part[j]] = i;
  });
  out.env_nodes = env_offsets(env_buffer.download(), static_cast<Index>(f.env_pairs.size()) - 1);
  device::parallel_for("mortar_contact.pressure", samples.n, [=] MORTISE_HD(Index i) {
    const Sample& sample = samples[i];
    const Pair& p = pairs[sample.pair];
    double sum = 0;
    if (is_averaged(set, p, sample))
      for (int a = 0; a < 3; ++a) sum -= sample.N[a] * barrier::first(gap[node[3 * sample.pair + a]], p.d_hat);
    else
      sum = -barrier::first(sample.gap, p.d_hat);
    pressure[i] = kappa[p.interface] * sum;
  });
}

void averaged_energy(const MortarView& s, const FrozenSamples& f, View<const Vec3> y, const std::vector<std::uint8_t>& whose,
                     device::EnvValues per_env) {
  const Averages& averages = f.averages;
  const View<const Pair> pairs = f.pairs.view();
  const View<const Sample> samples = f.samples.view();
  const View<const Vec3> y0 = f.y.view();
  const Settings set = s.set;
  Buffer<double> buffer(3 * pairs.n);
  const View<double> change = buffer.view();  // of the parts' sum w N_a g
  std::vector<Index> env_parts;
  for (Index first : f.env_pairs) env_parts.push_back(3 * first);
  device::parallel_for("mortar_contact.part_changes", {env_parts, whose}, [=] MORTISE_HD(Index i) {
    const Pair& p = pairs[i / 3];
    Vec3 J[kPoints];
    weigh(set, p, samples, i % 3, J);
    double sum = 0;
    for (int k = 0; k < points_of(p); ++k) sum += J[k].dot(y[point_of(p, k)] - y0[point_of(p, k)]);
    change[i] = sum;
  });
  const View<const Index> part = averages.part.view(), start = averages.start.view(), interface = averages.interface.view();
  const View<const double> area = averages.area.view(), gap = averages.gap.view(), kappa = s.kappa, d_hat = s.d_hat;
  device::env_sum(
      "mortar_contact.node_energy", {averages.env_nodes, whose},
      [=] MORTISE_HD(Index i) {
        if (!(area[i] > 0)) return 0.0;
        double moved = 0;
        for (Index j = start[i]; j < start[i + 1]; ++j) moved += change[part[j]];
        const double g = gap[i] + moved / area[i];
        return kappa[interface[i]] * area[i] * frozen_barrier(g, gap[i], d_hat[interface[i]]);
      },
      per_env);
}

void node_stencils(const MortarView& s, const FrozenSamples& f, const model::PointMapView& point_map, NodeStencils& out) {
  const Settings set = s.set;
  const View<const double> d_hat = s.d_hat;
  const Averages& averages = f.averages;
  const View<const Pair> pairs = f.pairs.view();
  const View<const Sample> samples = f.samples.view();
  const View<const Index> node = averages.node.view();
  const View<const double> area = averages.area.view(), gap = averages.gap.view();
  const model::PointMapView map = point_map;
  const Index parts = node.n;
  Buffer<Index> counts(parts + 1);
  const View<Index> at = counts.view();
  const auto acts = [=] MORTISE_HD(Index i) { return area[node[i]] > 0 && gap[node[i]] < d_hat[pairs[i / 3].interface]; };
  device::parallel_for("mortar_contact.count_entries", parts, [=] MORTISE_HD(Index i) { at[i] = acts(i) ? blocks_of(map, pairs[i / 3]).blocks : 0; });
  const Index n = device::exclusive_scan(counts);
  Buffer<std::uint64_t> keys(n);
  Buffer<Index> order(n), start;
  Buffer<Vec3> pieces(n);
  {
    const View<std::uint64_t> k = keys.view();
    const View<Index> o = order.view();
    const View<Vec3> piece = pieces.view();
    device::parallel_for("mortar_contact.entries", parts, [=] MORTISE_HD(Index i) {
      if (at[i + 1] == at[i]) return;
      const Pair& p = pairs[i / 3];
      const model::Expansion<kPoints> e = blocks_of(map, p);
      Vec3 J[kPoints];
      weigh(set, p, samples, i % 3, J);
      e.chain(J, piece.p + at[i]);
      for (Index b = 0; b < e.blocks; ++b) {
        piece[at[i] + b] /= area[node[i]];
        k[at[i] + b] = entry_key(node[i], e.block[b]), o[at[i] + b] = at[i] + b;
      }
    });
  }
  merge(keys, area.n, order, start, out.offset, out.block);
  const View<const Vec3> piece = std::as_const(pieces).view();
  const View<const Index> o = std::as_const(order).view();
  device::segment_sum(
      "mortar_contact.merge_entries", start, [=] MORTISE_HD(Index j) { return Vec3(piece[o[j]]); }, out.G);
}

}  // namespace mortise::effects::mortar
