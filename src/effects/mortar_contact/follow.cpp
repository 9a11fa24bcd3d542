#include "effects/contact/barrier.h"
#include "effects/contact/change_stencils.h"
#include "effects/mortar_contact/averaged.h"
#include "effects/mortar_contact/functionals.h"
#include "effects/mortar_contact/neighbours.h"

namespace mortise::effects::mortar {
namespace {

// d c = d(n . n_m) by the turns of the slave and of the master, on whose sides they depend by -g_j . n_m and -g_mj . n.
struct Turned {
  Frame slave, master;
  double c;
  MORTISE_HD Turned(const Pair& p, View<const Vec3> y) : slave(frame_of(p.on, y)), master(frame_of(p.under, y)), c(slave.n.dot(master.n)) {}
  MORTISE_HD double by_slave(int j) const { return -slave.g[j].dot(master.n); }
  MORTISE_HD double by_master(int j) const { return -master.g[j].dot(slave.n); }
};

// k_1 = e_2 x u, k_2 = u x e_1, u = (m - n) / |e_1 x e_2| with m = n_m / (n . n_m), of slaves' sides and masters' normals that are jets.
template <class T>
MORTISE_HD inline void turning_of(const Vec3Of<T>& e1, const Vec3Of<T>& e2, const Vec3Of<T>& nm, Vec3Of<T> k[3]) {
  const Vec3Of<T> twice = cross<T>(e1, e2);
  const T size = root(twice.squaredNorm());
  const Vec3Of<T> n = T(1 / size) * twice, u = T(1 / size) * (T(1 / n.dot(nm)) * nm - n);
  k[1] = cross<T>(e2, u), k[2] = cross<T>(u, e1), k[0] = -k[1] - k[2];
}

// The changes of k with functional c.
MORTISE_HD inline void turning_by(const Pair& p, const Turned& t, Index c, View<const Vec3> y, Vec3 dk[3]) {
  using D = Jet<1>;
  for (int a = 0; a < 3; ++a) dk[a] = Vec3::Zero();
  if (c < kFirstMasterTurn) return;
  const Vec3 at = y[p.on.point[p.on.vertex(0)]];
  Vec3Of<D> side[2], nm, k[3];
  for (int r = 0; r < 3; ++r) {
    for (int j = 0; j < 2; ++j) side[j][r] = D(y[p.on.point[p.on.vertex(j + 1)]][r] - at[r]);
    nm[r] = D(t.master.n[r]);
    if (c < kFirstSide) nm[r].d[0] = -t.master.g[c - kFirstMasterTurn][r];
  }
  if (c >= kFirstSide) side[(c - kFirstSide) / 3][(c - kFirstSide) % 3].d[0] = 1;
  turning_of<D>(side[0], side[1], nm, k);
  for (int a = 0; a < 3; ++a)
    for (int r = 0; r < 3; ++r) dk[a][r] = k[a][r].d[0];
}

// Gradients of three terms in a kernel of their own: what they ask for of a GPU's registers is no other scene's to pay.
template <bool kExact>
void sample_changes_of(const MortarView& view, FrozenSamples& f, model::SampleChanges& out) {
  const Index functionals = functionals_of(view.set);
  out.resize(f.samples.size(), functionals, f.moving.start, f.moving.node);
  out.sizes = f.moving.sizes;
  const model::SampleChangesView to = out.view();
  const View<const Pair> pairs = f.pairs.view();
  const View<const Sample> samples = f.samples.view();
  const View<const double> pressure = f.pressure.view();
  const MovingView moving = view_of(f.moving);
  const View<const Vec3> y = f.y.view();
  const Moving wanted = f.moving.wanted;
  const PressureOf press(view, f);
  // A thread per functional.
  device::parallel_for("mortar_contact.sample_changes", functionals * samples.n, [=] MORTISE_HD(Index at) {
    const Index i = at / functionals, c = at % functionals;
    const Sample& sample = samples[i];
    const Pair& p = pairs[sample.pair];
    const bool plane = p.master < 0, turns = kExact && turning(p, sample);
    to.clear(i, c);
    Vec3* along = to.along(i, c);
    const double length = turns ? p.m.norm() : 1;
    if (c == kGap) {
      Vec3 gap[kPoints];
      jacobian(p, sample, gap);
      for (int k = 0; k < points_of(p); ++k) along[k] = gap[k];
      to.force(i, c) = length * sample.weight * press.by(p, sample, c, y);
      to.known_[i] = wanted.in(p.env);
    } else if (!wanted.in(p.env)) {
      return;
    } else if (c < kFirstTurn) {
      const int q = static_cast<int>(c - kFirstMoved), j = q % 2;
      for (Index k = 0; k < moving.count(i); ++k) along[k] = moving.by(i, q)[k];
      if (q == 4) {
        to.force(i, c) = length * pressure[i];
        return;
      }
      if (plane && q >= 2) return;
      // d gap by a barycentric, and the weights of the nodes
      const bool slave = q < 2;
      const Spot spot(slave ? p.on : p.under, slave ? sample.N : sample.M, y);
      const double sign = slave ? -1 : 1;
      to.force(i, c) = length * sample.weight * press.by(p, sample, c, y);
      double* weight = to.weight(i, c) + (slave ? 0 : p.on.count);
      for (int k = 0; k < (slave ? p.on.count : p.under.count); ++k) weight[k] = (plane ? -sign : sign) * spot.by[j][k];
    } else if (c < kFrozen && !plane) {
      const int j = static_cast<int>(c - kFirstTurn);
      const Frame frame = frame_of(p.on, y);
      along[p.on.vertex(j + 1)] = frame.n, along[p.on.vertex(0)] = -frame.n;
      if (!turns) {
        to.normal(i, c) = -frame.g[j];
        return;
      }
      const Turned t(p, y);  // the force has the size w p |m|, |m| = -1 / c
      to.force(i, c) = sample.weight * pressure[i] * t.by_slave(j) / (t.c * t.c);
    } else if (turns && c == kRest) {
      Vec3 gap[kPoints];
      jacobian(p, sample, gap);
      const Spot on(p.on, sample.N, y), under(p.under, sample.M, y);
      for (int k = 0; k < p.on.count; ++k) along[k] = -on.shape[k] * p.n - gap[k];
      for (int k = 0; k < p.under.count; ++k) along[p.on.count + k] = under.shape[k] * p.n - gap[p.on.count + k];
      to.force(i, c) = length * sample.weight * press.by(p, sample, c, y);
    } else if (turns && c < kFirstSide) {
      const int j = static_cast<int>(c - kFirstMasterTurn);
      const Turned t(p, y);  // and points along m / |m| = -n_m
      along[p.on.count + p.under.vertex(j + 1)] = t.master.n, along[p.on.count + p.under.vertex(0)] = -t.master.n;
      to.force(i, c) = sample.weight * pressure[i] * t.by_master(j) / (t.c * t.c);
      to.normal(i, c) = t.master.g[j];
    } else if (turns) {
      const int j = static_cast<int>(c - kFirstSide), corner = j / 3 + 1;
      along[p.on.vertex(corner)] = Vec3::Unit(j % 3), along[p.on.vertex(0)] = -Vec3::Unit(j % 3);
    }
  });
}

template <bool kExact>
void follow_of(const MortarView& view, const FrozenSamples& f, model::ContactView& contact, const model::PointMapView& point_map,
               linalg::StencilSet& beside, linalg::RankOnes& out) {
  const model::SampleChangesView change = contact.changes.view();
  const View<const model::ContactSample> samples = std::as_const(contact.samples).view();
  const model::PointMapView map = point_map;
  NodePieces nodes;
  if (view.set.averaged)
    shape_with_nodes(view, f, contact.changes, map, nodes, beside);
  else
    contact::shape(map, contact.changes, samples.n, beside);
  // What follows from the frozen gap is the frozen Hessian, but for that of the turning slave's normal.
  const Index first = kExact ? kGap : kFirstMoved, rank = functionals_of(view.set) - first, blocks = beside.blocks().n;
  out.resize(rank, blocks);
  const View<const Index> offset = beside.offsets();
  const View<Vec3> left = out.left.view(), right = out.right.view();
  const View<const Pair> pairs = f.pairs.view();
  const View<const Sample> frozen = f.samples.view();
  const View<const double> pressure = f.pressure.view();
  const View<const Vec3> y = f.y.view();
  const PressureOf press(view, f);
  device::parallel_for("mortar_contact.follow", samples.n, [=] MORTISE_HD(Index i) {
    const model::ContactSample& s = samples[i];
    const auto e = contact::changed_blocks(map, change, i);
    const Vec3 n(s.normal[0], s.normal[1], s.normal[2]);
    Vec3 force[model::kChangePoints];
    for (Index k = 0; k < change.points(i); ++k) force[k] = Vec3::Zero();
    for (Index c = 0; c < rank; ++c) {
      const double *weight = change.weight(i, first + c), d_force = first + c == kGap ? 0 : change.force(i, first + c);
      const Vec3 turn = s.force * change.normal(i, first + c);
      for (Index k = 0; k < s.points; ++k) force[k] = -((s.weight[k] * d_force + weight[k] * s.force) * n + s.weight[k] * turn);
      if (kExact && turning(pairs[frozen[i].pair], frozen[i])) {
        // d(w p g k_a) on the slave's corners
        const Sample& sample = frozen[i];
        const Pair& p = pairs[sample.pair];
        const double w = sample.weight, g = sample.gap, by = gap_by(p, sample, first + c, y);
        double scale = w * pressure[i] * by + (first + c == kFirstMoved + 4 ? pressure[i] * g : 0);
        if (first + c != kGap) scale += w * g * press.by(p, sample, first + c, y);
        Vec3 dk[3];
        turning_by(p, Turned(p, y), first + c, y, dk);
        for (int a = 0; a < 3; ++a) force[p.on.vertex(a)] += scale * p.k[a] + w * pressure[i] * g * dk[a];
      }
      e.chain(force, left.p + c * blocks + offset[i]);
      e.chain(change.along(i, first + c), right.p + c * blocks + offset[i]);
    }
  });
  if (nodes.left.size() == 0) return;
  // One piece for every node, the first of its stencil.
  const View<const Vec3> l = std::as_const(nodes.left).view(), r = std::as_const(nodes.right).view();
  const Index of_samples = blocks - l.n;
  device::parallel_for("mortar_contact.follow_nodes", rank * l.n, [=] MORTISE_HD(Index at) {
    const Index c = at / l.n, entry = at % l.n, to = c * blocks + of_samples + entry;
    left[to] = c == 0 ? l[entry] : Vec3(0, 0, 0), right[to] = c == 0 ? r[entry] : Vec3(0, 0, 0);
  });
}

}  // namespace

void sample_changes(const MortarView& s, FrozenSamples& f, model::SampleChanges& out) {
  s.set.exact ? sample_changes_of<true>(s, f, out) : sample_changes_of<false>(s, f, out);
}

void follow(const MortarView& s, const FrozenSamples& f, model::ContactView& contact, const model::PointMapView& map, linalg::StencilSet& beside,
            linalg::RankOnes& out) {
  s.set.exact ? follow_of<true>(s, f, contact, map, beside, out) : follow_of<false>(s, f, contact, map, beside, out);
}

bool complete(const FrozenSamples& f) {
  const View<const std::uint8_t> partly = f.moving.partly.view();
  return device::sum("mortar_contact.partly", partly.n, [=] MORTISE_HD(Index i) { return partly[i] ? 1.0 : 0.0; }) == 0;
}

}  // namespace mortise::effects::mortar
