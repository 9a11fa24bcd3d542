#include "effects/contact/barrier.h"
#include "effects/contact/change_stencils.h"
#include "effects/mortar_contact/moving.h"
#include "effects/mortar_contact/neighbours.h"
#include "effects/mortar_contact/spot.h"

namespace mortise::effects::mortar {
namespace {

// Functionals of a sample: its frozen gap, N_1, N_2, M_1, M_2, w, n . de_1, n . de_2.
inline constexpr Index kGap = 0, kFirstMoved = 1, kFirstTurn = kFirstMoved + kMoved, kFunctionals = kFirstTurn + 2;

}  // namespace

void sample_changes(const MortarView& view, FrozenSamples& f, model::SampleChanges& out) {
  out.resize(f.samples.size(), kFunctionals, f.moving.start, f.moving.node);
  out.sizes = f.moving.sizes;
  const model::SampleChangesView to = out.view();
  const View<const Pair> pairs = f.pairs.view();
  const View<const Sample> samples = f.samples.view();
  const View<const double> pressure = f.pressure.view(), kappa = view.kappa;
  const MovingView moving = view_of(f.moving);
  const View<const Vec3> y = f.y.view();
  const Moving wanted = f.moving.wanted;
  // A thread per functional.
  device::parallel_for("mortar_contact.sample_changes", kFunctionals * samples.n, [=] MORTISE_HD(Index at) {
    const Index i = at / kFunctionals, c = at % kFunctionals;
    const Sample& sample = samples[i];
    const Pair& p = pairs[sample.pair];
    const bool plane = p.master < 0;
    to.clear(i, c);
    Vec3* along = to.along(i, c);
    const double stiffness = kappa[p.interface] * sample.weight * barrier::second(sample.gap, p.d_hat);
    if (c == kGap) {
      Vec3 gap[kPoints];
      jacobian(p, sample, gap);
      for (int k = 0; k < points_of(p); ++k) along[k] = gap[k];
      to.force(i, c) = -stiffness;
      to.known_[i] = wanted.in(p.env);
    } else if (!wanted.in(p.env)) {
      return;
    } else if (c < kFirstTurn) {
      const int q = static_cast<int>(c - kFirstMoved), j = q % 2;
      for (Index k = 0; k < moving.count(i); ++k) along[k] = moving.by(i, q)[k];
      if (q == 4) {
        to.force(i, c) = pressure[i];
        return;
      }
      if (plane && q >= 2) return;
      // d gap by a barycentric, and the weights of the nodes
      const bool slave = q < 2;
      const Spot spot(slave ? p.on : p.under, slave ? sample.N : sample.M, y);
      const double sign = slave ? -1 : 1;
      to.force(i, c) = -stiffness * sign * p.n.dot(spot.x[j]);
      double* weight = to.weight(i, c) + (slave ? 0 : p.on.count);
      for (int k = 0; k < (slave ? p.on.count : p.under.count); ++k) weight[k] = (plane ? -sign : sign) * spot.by[j][k];
    } else if (!plane) {
      const int j = static_cast<int>(c - kFirstTurn);
      const Frame frame = frame_of(p.on, y);
      along[p.on.vertex(j + 1)] = frame.n, along[p.on.vertex(0)] = -frame.n;
      to.normal(i, c) = -frame.g[j];
    }
  });
}

void follow(model::ContactView& contact, const model::PointMapView& point_map, linalg::StencilSet& beside, linalg::RankOnes& out) {
  const model::SampleChangesView change = contact.changes.view();
  const View<const model::ContactSample> samples = std::as_const(contact.samples).view();
  const model::PointMapView map = point_map;
  contact::shape(map, contact.changes, samples.n, beside);
  constexpr Index kRank = kFunctionals - 1;  // what follows from the frozen gap is the frozen Hessian
  const Index blocks = beside.blocks().n;
  out.resize(kRank, blocks);
  const View<const Index> offset = beside.offsets();
  const View<Vec3> left = out.left.view(), right = out.right.view();
  device::parallel_for("mortar_contact.follow", samples.n, [=] MORTISE_HD(Index i) {
    const model::ContactSample& s = samples[i];
    const auto e = contact::changed_blocks(map, change, i);
    const Vec3 n(s.normal[0], s.normal[1], s.normal[2]);
    Vec3 force[model::kChangePoints];
    for (Index k = 0; k < change.points(i); ++k) force[k] = Vec3::Zero();
    for (Index c = 0; c < kRank; ++c) {
      const double *weight = change.weight(i, kFirstMoved + c), d_force = change.force(i, kFirstMoved + c);
      const Vec3 turn = s.force * change.normal(i, kFirstMoved + c);
      for (Index k = 0; k < s.points; ++k) force[k] = -((s.weight[k] * d_force + weight[k] * s.force) * n + s.weight[k] * turn);
      e.chain(force, left.p + c * blocks + offset[i]);
      e.chain(change.along(i, kFirstMoved + c), right.p + c * blocks + offset[i]);
    }
  });
}

bool complete(const Settings& set, const FrozenSamples& f) {
  if (set.exact || set.averaged) return false;
  const View<const std::uint8_t> partly = f.moving.partly.view();
  return device::sum("mortar_contact.partly", partly.n, [=] MORTISE_HD(Index i) { return partly[i] ? 1.0 : 0.0; }) == 0;
}

}  // namespace mortise::effects::mortar
