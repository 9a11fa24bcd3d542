#include <utility>

#include "effects/mortar_contact/moving_parts.h"
#include "effects/mortar_contact/neighbours.h"
#include "effects/mortar_contact/spot.h"

namespace mortise::effects::mortar {

void follow_layers(const Stage& stage, FrozenSamples& out) {
  const Stage s = stage;
  const View<const Pair> pairs = std::as_const(out.pairs).view();
  const View<const Sample> samples = std::as_const(out.samples).view();
  const MovingView moving = view_of(out.moving);
  const View<std::uint8_t> partly = out.moving.partly.view();
  const Moving wanted = out.moving.wanted;
  device::parallel_for("mortar_contact.moving_layers", samples.n, [=] MORTISE_HD(Index i) {
    const Sample& sample = samples[i];
    const Pair& p = pairs[sample.pair];
    if (!p.layered || !wanted.in(p.env) || s.s.bent(p.slave) || s.s.bent(p.master)) return;
    partly[i] &= kLost;
    const Under under = under_others(s, p);
    const double v = visible(s.s, under.patch, under.place, s.y, sample.N, sample.gap);
    if (!(v > 0 && v < 1)) return;
    const Index* on = s.s.surface.triangles[p.slave].v;
    const ByNodes to{s.s, s.y, moving.node.p + moving.start[i], static_cast<int>(moving.count(i)), moving.by(i, 4)};
    const double scale = -sample.weight / v;
    double by[3] = {0, 0, 0};  // N_1, N_2, gap
    each_rim(s, under, sample, [&](Index master) {
      const Index* over = s.s.surface.triangles[master].v;
      using D = Jet<3>;
      MORTISE_ROLLED for (int moved = 0; moved <= 6; ++moved) {  // a corner of the slave, of the master, or the sample itself
        Vec3Of<D> y[3], x[3];
        for (int k = 0; k < 3; ++k)
          for (int c = 0; c < 3; ++c) {
            y[k][c] = moved == k ? D::variable(s.y[on[k]][c], c) : D(s.y[on[k]][c]);
            x[k][c] = moved == 3 + k ? D::variable(s.y[over[k]][c], c) : D(s.y[over[k]][c]);
          }
        D N[3] = {0, sample.N[1], sample.N[2]}, gap = sample.gap;
        if (moved == 6) N[1] = D::variable(N[1].a, 0), N[2] = D::variable(N[2].a, 1), gap = D::variable(gap.a, 2);
        N[0] = 1 - N[1] - N[2];
        const D share = covers<D>(y, x, N, gap);
        if (moved < 6)
          to.add(moved < 3 ? on[moved] : over[moved - 3], scale * Vec3(share.d[0], share.d[1], share.d[2]));
        else
          for (int c = 0; c < 3; ++c) by[c] += scale * share.d[c];
      }
    });
    const Spot foot(p.on, sample.N, s.y), head(p.under, sample.M, s.y);
    for (int k = 0; k < moving.count(i); ++k) {
      Vec3 gap = Vec3::Zero();
      if (k < points_of(p)) gap = (k < p.on.count ? -foot.shape[k] : head.shape[k - p.on.count]) * p.n;
      for (int j = 0; j < 2; ++j) gap += p.n.dot(head.x[j]) * moving.by(i, 2 + j)[k] - p.n.dot(foot.x[j]) * moving.by(i, j)[k];
      moving.by(i, 4)[k] += by[0] * moving.by(i, 0)[k] + by[1] * moving.by(i, 1)[k] + by[2] * gap;
    }
  });
}

void slide(const MortarView& view, View<const Vec3> y, FrozenSamples& out) {
  if (view.quarter.n == 0) return;
  const View<const Pair> pairs = std::as_const(out.pairs).view();
  const View<const Sample> samples = std::as_const(out.samples).view();
  const MovingView moving = view_of(out.moving);
  device::parallel_for("mortar_contact.moving_slide", samples.n, [=] MORTISE_HD(Index i) {
    const Sample& sample = samples[i];
    const Pair& p = pairs[sample.pair];
    if (p.under.count == 0 || !p.quadratic()) return;
    const bool of_slave = sample.kind == SampleKind::face;  // N moves as found, M follows
    const Frame frame = frame_of(p.on, y);
    const Spot on(p.on, sample.N, y), under(p.under, sample.M, y);
    const Spot &first = of_slave ? on : under, &second = of_slave ? under : on;
    const int leads = of_slave ? 0 : 2, led = 2 - leads;
    const double A[2][2] = {{frame.g[0].dot(second.x[0]), frame.g[0].dot(second.x[1])}, {frame.g[1].dot(second.x[0]), frame.g[1].dot(second.x[1])}};
    const double det = A[0][0] * A[1][1] - A[0][1] * A[1][0];
    for (int k = 0; k < moving.count(i); ++k) {
      // g_r . (second's motion by barycentrics) = g_r . (first's motion - second's with its nodes +- g dn)
      const bool slave = k < p.on.count, neighbour = k >= points_of(p);
      const int own = slave ? k : k - p.on.count;
      Vec3 rhs[2];
      for (int r = 0; r < 2; ++r) {
        const Vec3& g = frame.g[r];
        const double move = neighbour ? 0 : slave ? on.shape[own] : under.shape[own];
        rhs[r] = (slave == of_slave ? move : -move) * g;
        for (int j = 0; j < 2; ++j) rhs[r] += g.dot(first.x[j]) * moving.by(i, leads + j)[k];
        if (!slave) continue;
        double turn = 0;  // g_i . dn = -sum_j g_i . g_j n . de_j
        for (int j = 0; j < 2; ++j) turn -= g.dot(frame.g[j]) * ((own == p.on.vertex(j + 1) ? 1 : 0) - (own == p.on.vertex(0) ? 1 : 0));
        rhs[r] += (of_slave ? sample.gap : -sample.gap) * turn * frame.n;
      }
      for (int j = 0; j < 2; ++j)
        moving.by(i, led + j)[k] = det != 0 ? Vec3((A[1 - j][1 - j] * rhs[j] - A[j][1 - j] * rhs[1 - j]) / det) : Vec3::Zero();
    }
  });
}

}  // namespace mortise::effects::mortar
