#include "effects/mortar_contact/frozen.h"

#include <utility>

#include "effects/contact/barrier.h"
#include "effects/mortar_contact/averaged.h"

namespace mortise::effects::mortar {
namespace {

// Change of a gap with derivative J when the pair's points move by dy.
MORTISE_HD inline double change(const Pair& p, const Vec3 J[kPoints], const Vec3 dy[kPoints]) {
  double sum = 0;
  for (int k = 0; k < points_of(p); ++k) sum += J[k].dot(dy[k]);
  return sum;
}

}  // namespace

void measure(const geometry::SurfaceView& surface, const model::QuadraticFaces& faces, View<const Vec3> y, const device::Ranges& whose,
             Buffer<Vec3>& normal, Buffer<double>& area, Buffer<double>& bow) {
  normal.resize(surface.triangles.n), area.resize(surface.triangles.n), bow.resize(faces.quarter.size());
  const View<Vec3> n = normal.view();
  const View<double> a = area.view(), deepest = bow.view();
  const View<const Triangle> triangles = surface.triangles;
  const View<const geometry::Face> face = faces.nodes.view();
  const View<const Index> quarter = faces.quarter.view();
  device::parallel_for("mortar_contact.measure", whose, [=] MORTISE_HD(Index t) {
    const Index* v = triangles[t].v;
    const Vec3 twice = (y[v[1]] - y[v[0]]).cross(y[v[2]] - y[v[0]]);
    const double length = twice.norm();
    n[t] = twice / length;
    a[t] = length / 2;
    if (deepest.n == 0) return;
    // Over a quarter the face stands off by sum N_i N_j d_ij, with d the distance of the node in the middle of an edge of the face from
    // its mean, for the edge of the quarter parallel to it: by max |d|/3 at most.
    deepest[t] = 0;
    for (int e = 0; quarter[t] >= 0 && e < 3; ++e) {
      const Index* f = face[quarter[t] / 4].v;
      const Vec3 d = y[f[3 + e]] - 0.5 * (y[f[geometry::edge_begin(e)]] + y[f[geometry::edge_end(e)]]);
      deepest[t] = std::fmax(deepest[t], d.norm() / 3);
    }
  });
}

void least_gaps(const MortarView& view, const Search& search, View<const Vec3> y, Buffer<double>& least) {
  least.resize(view.slaves.n);
  const View<double> out = least.view();
  const View<const Index> offset = search.offset(), master = search.master();
  const MortarView s = view;
  device::parallel_for("mortar_contact.least_gaps", s.slaves.n, [=] MORTISE_HD(Index i) {
    const Triangle t = s.surface.triangles[s.slaves[i]];
    const SlavePlane plane = slave_plane(y[t.v[0]], y[t.v[1]], y[t.v[2]]);
    double g = INFINITY;
    for (Index c = offset[i]; c < offset[i + 1]; ++c) {
      if (master[c] < 0) {
        const contact::Plane p = s.planes[-1 - master[c]];
        for (int k = 0; k < 3; ++k) g = std::fmin(g, p.normal.dot(y[t.v[k]] - p.point));
        continue;
      }
      if (!(facing(s.set, plane.n, s.normal[master[c]]) > 0)) continue;
      const Facing f = project(s, plane, master[c], y);
      const Polygon p = clip(f.L);
      for (int k = 0; k < p.n; ++k) {
        const double h = height(f, p.v[k].M);
        if (h > 0) g = std::fmin(g, h);
      }
    }
    out[i] = g < s.support[i] ? g : INFINITY;
  });
}

void cover(const MortarView& view, const Search& search, View<const Vec3> y, Buffer<Cover>& covers) {
  const View<const Index> slave = search.slave(), master = search.master();
  covers.resize(master.n);
  const View<Cover> out = covers.view();
  const MortarView s = view;
  device::parallel_for("mortar_contact.cover", master.n, [=] MORTISE_HD(Index c) {
    const Triangle t = s.surface.triangles[s.slaves[slave[c]]];
    const SlavePlane plane = slave_plane(y[t.v[0]], y[t.v[1]], y[t.v[2]]);
    Cover of{s.slaves[slave[c]], master[c], 0, {0, 0, 0}, {0, 0, 0}};
    if (master[c] < 0) {
      of.share = 1;
      for (int k = 0; k < 3; ++k) of.N[k] = plane.area / 3;
    } else if (facing(s.set, plane.n, s.normal[master[c]]) > 0) {
      const Polygon p = clip(project(s, plane, master[c], y).L);
      for (int i = 1; i + 1 < p.n; ++i) {
        const double share = fan_area(p, i), third = share * plane.area / 3;
        of.share += share;
        for (int k = 0; k < 3; ++k) {
          of.N[k] += third * (p.v[0].N[k] + p.v[i].N[k] + p.v[i + 1].N[k]);
          of.M[k] += third * (p.v[0].M[k] + p.v[i].M[k] + p.v[i + 1].M[k]);
        }
      }
    }
    out[c] = of;
  });
}

void energy(const MortarView& s, const FrozenSamples& f, View<const Vec3> y, const std::vector<std::uint8_t>& whose, device::EnvValues per_env) {
  const View<const Pair> pairs = f.pairs.view();
  const View<const Sample> samples = f.samples.view();
  const View<const Vec3> y0 = f.y.view();
  const View<const double> kappa = s.kappa;
  const Settings set = s.set;
  device::env_sum(
      "mortar_contact.energy", {f.env_pairs, whose},
      [=] MORTISE_HD(Index i) {
        const Pair& p = pairs[i];
        Vec3 dy[kPoints], J[kPoints];
        for (int k = 0; k < points_of(p); ++k) dy[k] = y[point_of(p, k)] - y0[point_of(p, k)];
        double sum = 0;
        for (Index j = p.begin; j < p.end; ++j) {
          jacobian(p, samples[j], J);
          const double g = samples[j].gap + change(p, J, dy);
          if (p.binding() && !(g > 0)) return static_cast<double>(INFINITY);
          if (!is_averaged(set, p, samples[j])) sum += samples[j].weight * frozen_barrier(g, samples[j].gap, p.d_hat);
        }
        return kappa[p.interface] * sum;
      },
      per_env);
  if (set.averaged) averaged_energy(s, f, y, whose, per_env);
}

void assemble(const MortarView& s, const FrozenSamples& f, const model::PointMapView& point_map, bool hessian, linalg::StencilSet& guard,
              linalg::StencilSet& set) {
  const View<const Pair> pairs = f.pairs.view();
  const View<const Sample> samples = f.samples.view();
  const View<const double> kappa = s.kappa;
  const linalg::StencilView extra = guard.view();
  const model::PointMapView map = point_map;
  const View<const double> pressure = f.pressure.view();
  const Settings settings = s.set;
  NodeStencils nodes;  // only they have the Hessian of averaged gaps
  const bool nodal = settings.averaged && hessian;
  if (nodal) node_stencils(s, f, map, nodes);
  const View<const Index> entry = std::as_const(nodes.offset).view(), node_block = std::as_const(nodes.block).view();
  const View<const Vec3> G = std::as_const(nodes.G).view();
  const Index node_count = nodal ? f.averages.area.size() : 0;
  Buffer<Index> counts(pairs.n + node_count + extra.n + 1);
  const View<Index> count = counts.view();
  device::parallel_for("mortar_contact.count_blocks", pairs.n + node_count + extra.n, [=] MORTISE_HD(Index i) {
    const Index k = i - pairs.n;
    count[i] = k < 0 ? blocks_of(map, pairs[i]).blocks : k < node_count ? entry[k + 1] - entry[k] : extra.blocks(k - node_count);
  });
  set.resize(std::move(counts), nodal ? linalg::StencilSizes{} : f.of_pairs + guard.sizes());
  if (hessian) set.need_hessian();
  const linalg::StencilView out = set.view();
  device::parallel_for("mortar_contact.assemble", pairs.n, [=] MORTISE_HD(Index i) {
    const Pair& p = pairs[i];
    const model::Expansion<kPoints> e = blocks_of(map, p);
    const Index at = out.offset[i];
    for (Index b = 0; b < e.blocks; ++b) out.block[at + b] = e.block[b];
    if (hessian) model::zero_hessian(out, i, e.blocks);
    Vec3 gradient[kPoints], J[kPoints], V[4 * kPoints];
    for (int k = 0; k < kPoints; ++k) gradient[k] = Vec3::Zero();
    for (Index j = p.begin; j < p.end; ++j) {
      const Sample& sample = samples[j];
      if (!(pressure[j] > 0)) continue;
      jacobian(p, sample, J);
      const double w = kappa[p.interface] * sample.weight, first = -sample.weight * pressure[j];
      for (int k = 0; k < points_of(p); ++k) gradient[k] += first * J[k];
      if (!hessian || is_averaged(settings, p, sample)) continue;
      e.chain(J, V);
      model::add_rank_one(out, i, e.blocks, w * barrier::second(sample.gap, p.d_hat), V);
    }
    e.chain(gradient, out.grad.p + at);
  });
  const View<const double> area = f.averages.area.view(), gap = f.averages.gap.view(), d_hat = s.d_hat;
  const View<const Index> interface = f.averages.interface.view();
  device::parallel_for("mortar_contact.assemble_nodes", node_count, [=] MORTISE_HD(Index i) {
    const Index nb = entry[i + 1] - entry[i], to = out.offset[pairs.n + i];
    for (Index b = 0; b < nb; ++b) out.block[to + b] = node_block[entry[i] + b], out.grad[to + b] = Vec3::Zero();
    model::zero_hessian(out, pairs.n + i, nb);
    const double c = kappa[interface[i]] * area[i] * barrier::second(gap[i], d_hat[interface[i]]);
    if (c > 0) model::add_rank_one(out, pairs.n + i, nb, c, G.p + entry[i]);
  });
  const Index begin = pairs.n + node_count;
  device::parallel_for("mortar_contact.append_guard", extra.n, [=] MORTISE_HD(Index i) {
    const Index nb = extra.blocks(i), from = extra.offset[i], to = out.offset[begin + i];
    for (Index b = 0; b < nb; ++b) out.block[to + b] = extra.block[from + b], out.grad[to + b] = extra.grad[from + b];
    if (!hessian) return;
    const Index h0 = extra.hess_offset[i], h1 = out.hess_offset[begin + i];
    for (Index b = 0; b < linalg::pair_count(nb); ++b) out.hess[h1 + b] = extra.hess[h0 + b];
  });
}

void limit(const MortarView& view, const FrozenSamples& f, View<const Vec3> dy, double keep, device::EnvValues alpha) {
  const View<const Pair> pairs = f.pairs.view();
  const View<const Sample> samples = f.samples.view();
  const View<const Vec3> y = f.y.view();
  const MortarView s = view;
  device::env_min(
      "mortar_contact.limit", f.env_pairs,
      [=] MORTISE_HD(Index i) {
        const Pair& p = pairs[i];
        double step = 2;
        if (!p.binding()) return step;
        Vec3 d[kPoints], J[kPoints];
        for (int k = 0; k < points_of(p); ++k) d[k] = dy[point_of(p, k)];
        const auto lower = [&](double gap, double rate) {
          if (rate < 0 && gap > 0) step = std::fmin(step, (1 - keep) * gap / -rate);
        };
        for (Index j = p.begin; j < p.end; ++j) {
          jacobian(p, samples[j], J);
          lower(samples[j].gap, change(p, J, d));
        }
        const Index *t = s.surface.triangles[p.slave].v, *under = p.master < 0 ? t : s.surface.triangles[p.master].v;
        const Vec3 turned = (y[under[1]] - y[under[0]]).cross(y[under[2]] - y[under[0]]);
        if (p.master >= 0 && facing(s.set, p.n, turned / turned.norm()) > 0) {
          const SlavePlane plane = slave_plane(y[t[0]], y[t[1]], y[t[2]]);
          const Facing over = project(s, plane, p.master, y);
          const Polygon poly = clip(over.L);
          for (int k = 0; k < poly.n; ++k) {
            double rate = 0;
            for (int a = 0; a < 3; ++a) rate += plane.n.dot(poly.v[k].M[a] * d[p.on.count + p.under.vertex(a)] - poly.v[k].N[a] * d[p.on.vertex(a)]);
            lower(height(over, poly.v[k].M), rate);
          }
        }
        return step;
      },
      alpha);
}

void samples(const MortarView& s, const FrozenSamples& f, model::ContactView& view) {
  view.samples.resize(f.samples.size());
  view.env_offset = f.env_samples;
  view.sizes = f.of_samples;
  view.local = !s.set.averaged;
  const View<model::ContactSample> out = view.samples.view();
  const View<const Pair> pairs = f.pairs.view();
  const View<const Sample> samples = f.samples.view();
  const View<const Vec3> y = f.y.view();
  const View<const double> pressure = f.pressure.view(), kappa = s.kappa;
  const geometry::SurfaceView surface = s.surface;
  device::parallel_for("mortar_contact.publish", samples.n, [=] MORTISE_HD(Index i) {
    const Sample& from = samples[i];
    const Pair& p = pairs[from.pair];
    const bool plane = p.master < 0;
    const Vec3 m = from.kind == SampleKind::face ? p.m : p.n;
    const double length = m.norm();
    model::ContactSample c;
    for (Index k = 0; k < model::kSamplePoints; ++k) c.point[k] = -1, c.weight[k] = 0;
    c.points = points_of(p);
    double N[6], M[6];
    p.on.shape(from.N, N);
    if (!plane) p.under.shape(from.M, M);
    Vec3 place = Vec3::Zero();
    for (Index k = 0; k < c.points; ++k) {
      const bool slave = k < p.on.count;
      c.point[k] = point_of(p, k);
      // Towards a half-space the normal is the plane's, which points at the slave.
      c.weight[k] = !slave ? M[k - p.on.count] : plane ? N[k] : -N[k];
      if (slave) place += N[k] * y[c.point[k]];
    }
    for (int k = 0; k < 3; ++k) c.normal[k] = (plane ? -m[k] : m[k]) / length, c.position[k] = place[k];
    c.area = from.weight;
    c.gap = from.gap;
    c.pressure = pressure[i];
    c.force = c.pressure * c.area * length;
    c.stiffness = kappa[p.interface] * c.area * barrier::second(c.gap, p.d_hat) * length * length;
    c.env = p.env;
    c.body_a = surface.body[p.on.point[0]];
    c.body_b = plane ? surface.pairs.bodies - 1 - p.master : surface.body[p.under.point[0]];
    out[i] = c;
  });
}

}  // namespace mortise::effects::mortar
