#include "effects/mortar_contact/moving.h"

#include <utility>

#include "effects/mortar_contact/neighbours.h"
#include "effects/mortar_contact/spot.h"

namespace mortise::effects::mortar {
namespace {

// What a slave and a master triangle are to each other: for every corner k of the master its barycentrics L_k1, L_k2 and its height [m], then the
// slave's corners (l, 0) and (a, b) in axes of its own [m], c = -n . n_master, and how the slave is bent over its sides.
inline constexpr int kOfCorner = 3, kLength = 9, kAlong = 10, kAcross = 11, kCosine = 12, kBend = 13, kVariables = 16;
// A kernel with all of their derivatives at once has polygons that no GPU's registers or caches hold; the CPU likes few rounds.
inline constexpr int kTogether = 4, kRounds = (kVariables + kTogether - 1) / kTogether;
using J = Jet<kTogether>;

inline constexpr double kSame = 1e-9;  // of barycentrics and weights: far above their rounding

// Why a sample is followed in part only: it is not found again, or there is no room for its nodes; others hide some of it.
inline constexpr std::uint8_t kLost = 1, kHidden = 2;

// A slave and a master triangle, and how the variables move with their corners.
struct Couple {
  const Patch& p;
  const Facing& f;
  Frame slave, master;
  Vec3 t1, t2;  // the slave's axes
  double l, a, b;

  MORTISE_HD Couple(const Patch& patch, const Facing& facing, const Vec3 corner[3])
      : p(patch), f(facing), slave(patch.plane.e1, patch.plane.e2), master(corner[1] - corner[0], corner[2] - corner[0]) {
    l = p.plane.e1.norm(), t1 = p.plane.e1 / l, t2 = slave.n.cross(t1);
    a = p.plane.e2.dot(t1), b = p.plane.e2.dot(t2);
  }

  // The variables, of which those of a round carry derivatives.
  MORTISE_HD J variable(double value, int i, int round) const {
    const int at = i - round * kTogether;
    return at >= 0 && at < kTogether ? J::variable(value, at) : J(value);
  }
  MORTISE_HD void see(int round, SlaveOf<J>& s, FacingOf<J>& over) const {
    s.slave = p.slave, s.support = p.support, s.reach = p.reach;
    for (int k = 0; k < 3; ++k) s.bend[k] = variable(p.bend[k], kBend + k, round);
    const J x1 = variable(l, kLength, round), x2 = variable(a, kAlong, round), y2 = variable(b, kAcross, round);
    const J zero = 0.0;
    s.y[0] = Vec3Of<J>(zero, zero, zero), s.y[1] = Vec3Of<J>(x1, zero, zero), s.y[2] = Vec3Of<J>(x2, y2, zero);
    s.area = 0.5 * (x1 * y2);
    s.area.a = p.area;
    for (int k = 0; k < 3; ++k) {
      for (int i = 1; i < 3; ++i) over.L[k][i] = variable(f.L[k][i], kOfCorner * k + i - 1, round);
      over.L[k][0] = 1 - over.L[k][1] - over.L[k][2];
      over.L[k][0].a = f.L[k][0];
      over.height[k] = variable(f.height[k], kOfCorner * k + 2, round);
    }
    over.cosine = variable(f.cosine, kCosine, round);
  }

  // z_i of a round, 0 of others.
  MORTISE_HD static double of_round(const double* z, int i, int round) {
    const int at = i - round * kTogether;
    return at >= 0 && at < kTogether ? z[at] : 0.0;
  }
  // Adds sum_i z_i d(variable i) to `on` and `under`, by places of the slave's and the master's corners. What it is bent by is others'.
  MORTISE_HD void pull(const double* z, int round, Vec3 on[3], Vec3 under[3]) const {
    const auto of = [&](int i) { return of_round(z, i, round); };
    Vec3 e1 = Vec3::Zero(), e2 = Vec3::Zero();  // by sides of the slave
    for (int k = 0; k < 3; ++k) {
      // x_k = sum_a L_ka y_a + h n:  dL_ki = g_i . (dx_k - sum_a L_ka dy_a - h dn),  dh = n . (dx_k - sum_a L_ka dy_a)
      const Vec3 t = of(kOfCorner * k) * slave.g[0] + of(kOfCorner * k + 1) * slave.g[1], v = t + of(kOfCorner * k + 2) * slave.n;
      under[k] += v;
      for (int i = 0; i < 3; ++i) on[i] -= f.L[k][i] * v;
      e1 += f.height[k] * t.dot(slave.g[0]) * slave.n, e2 += f.height[k] * t.dot(slave.g[1]) * slave.n;
    }
    // l = |e1|, e2 = a t1 + b t2
    e1 += of(kLength) * t1 + (of(kAlong) * b - of(kAcross) * a) / l * t2;
    e2 += of(kAlong) * t1 + of(kAcross) * t2;
    // dc = -dn . n_m - n . dn_m
    const double c = of(kCosine);
    e1 += c * slave.g[0].dot(master.n) * slave.n, e2 += c * slave.g[1].dot(master.n) * slave.n;
    const Vec3 E1 = c * master.g[0].dot(slave.n) * master.n, E2 = c * master.g[1].dot(slave.n) * master.n;
    under[1] += E1, under[2] += E2, under[0] -= E1 + E2;
    on[1] += e1, on[2] += e2, on[0] -= e1 + e2;
  }
};

// The motion of the samples of one piece, in the order in which they were offered.
struct Trace {
  Places places;
  Index at, end;
  View<const Sample> samples;
  MovingView moving;
  View<std::uint8_t> partly;

  // The sample that is told of, or -1: rounding may see another one at the rim of what is within reach.
  MORTISE_HD Index next(SampleKind kind, const J* N, const J* M) {
    const Index o = at++, sample = o < end ? places.sample(o) : -1;
    if (sample < 0 || samples[sample].kind != kind) return -1;
    const bool of_slave = kind == SampleKind::face;
    double off = 0;  // where curved faces above or below it are is not in yet
    for (int i = 0; i < 3; ++i) off += of_slave ? std::abs(N[i].a - samples[sample].N[i]) : std::abs(M[i].a - samples[sample].M[i]);
    if (off < kSame) return sample;
    partly[sample] |= kLost;
    return -1;
  }
  // Of what others leave of its weight (follow_layers).
  MORTISE_HD J weight(Index sample, const J& weight) const {
    const double share = samples[sample].weight / weight.a;
    if (share < 1 - kSame) partly[sample] |= kHidden;
    return share * weight;
  }
};

// Of every piece whose samples' motion is wanted.
struct Traces {
  Places places;
  View<const Sample> samples;
  MovingView moving;
  View<std::uint8_t> partly;
  Moving wanted;
  Traces(const Places& at, FrozenSamples& f)
      : places(at), samples(std::as_const(f.samples).view()), moving(view_of(f.moving)), partly(f.moving.partly.view()), wanted(f.moving.wanted) {}
  MORTISE_HD Trace of(Index place) const { return {places, places.first[place], places.first[place + 1], samples, moving, partly}; }
};

struct Follow {
  Trace trace;
  const Couple& couple;
  const MortarView& s;
  View<const Vec3> y;
  const FaceNodes &on, &under;
  int round;
  MORTISE_HD void operator()(SampleKind kind, const J& weight, const J&, const J* N, const J* M) {
    const Index sample = trace.next(kind, N, M);
    if (sample < 0) return;
    const J moved[kMoved] = {N[1], N[2], M[1], M[2], trace.weight(sample, weight)};
    for (int q = 0; q < kMoved; ++q) {
      Vec3 a[3] = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()}, b[3] = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
      couple.pull(moved[q].d, round, a, b);
      Vec3* to = trace.moving.by(sample, q);
      for (int k = 0; k < 3; ++k) to[on.vertex(k)] += a[k], to[on.count + under.vertex(k)] += b[k];
      if (kind == SampleKind::face) continue;
      const ByNodes out{s, y, trace.moving.node.p + trace.moving.start[sample], static_cast<int>(trace.moving.count(sample)), to};
      for (int k = 0; k < 3; ++k) {
        const double x = Couple::of_round(moved[q].d, kBend + k, round);
        if (x != 0) of_bend(s, couple.p.slave, k, couple.p.plane.n, x, out);
      }
    }
  }
};

template <class Part, class Weights>
void follow_part(const Stage& stage, const Weights weights, const Places& places, FrozenSamples& out) {
  const Stage s = stage;
  const Traces traces(places, out);
  device::parallel_for("mortar_contact.moving", Part::kCount * s.master.n, [=] MORTISE_HD(Index i) {
    const Index c = i / Part::kCount, piece = i % Part::kCount, place = kPieces * c + Part::kFirst + piece, master = s.master[c];
    if (!s.near[c] || !traces.places.any(place)) return;
    const Patch& patch = s.patch(c);
    if (!traces.wanted.in(s.env(patch))) return;
    const FaceNodes on = s.s.nodes_of(patch.slave), under = s.s.nodes_of(master);
    const Index* v = s.s.surface.triangles[master].v;
    const Vec3 corner[3] = {s.y[v[0]], s.y[v[1]], s.y[v[2]]};
    const Couple couple(patch, patch.facing[s.place(c)], corner);
    MORTISE_ROLLED for (int round = 0; round < kRounds; ++round) {
      SlaveOf<J> slave;
      FacingOf<J> facing;
      couple.see(round, slave, facing);
      Follow follow{traces.of(place), couple, s.s, s.y, on, under, round};
      Part::show(Sampler<J, Weights, Follow>(s.s, slave, facing, master, patch.plane.n, weights, follow), piece);
    }
  });
}

// Over a half-space: heights of the slave's corners, and the area of its shadow.
struct FollowPlane {
  Trace trace;
  const FaceNodes& on;
  Vec3 normal, side[2];  // d shadow = side_1 . de_1 + side_2 . de_2
  MORTISE_HD void operator()(SampleKind kind, const J& weight, const J&, const J* N, const J* M) {
    const Index sample = trace.next(kind, N, M);
    if (sample < 0) return;
    const J moved[kMoved] = {N[1], N[2], 0, 0, trace.weight(sample, weight)};
    for (int q = 0; q < kMoved; ++q) {
      Vec3* to = trace.moving.by(sample, q);
      for (int k = 0; k < 3; ++k) to[on.vertex(k)] += moved[q].d[k] * normal;
      for (int k = 0; k < 2; ++k) to[on.vertex(k + 1)] += moved[q].d[3] * side[k], to[on.vertex(0)] -= moved[q].d[3] * side[k];
    }
  }
};

void follow_planes(const Stage& stage, const Places& places, FrozenSamples& out) {
  const Stage s = stage;
  const Traces traces(places, out);
  device::parallel_for("mortar_contact.moving", s.s.planes.n > 0 ? kPlanePieces * s.master.n : 0, [=] MORTISE_HD(Index i) {
    const Index c = i / kPlanePieces, piece = i % kPlanePieces, place = kPieces * c + piece;
    if (s.master[c] >= 0 || !traces.places.any(place)) return;
    const Patch& p = s.patch(c);
    if (!traces.wanted.in(s.env(p))) return;
    const contact::Plane plane = s.s.planes[-1 - s.master[c]];
    const FaceNodes on = s.s.nodes_of(p.slave);
    SlaveOf<J> slave;
    slave.slave = p.slave, slave.support = p.support, slave.reach = p.reach;
    J h[6], corner[3];
    for (int k = 0; k < on.count; ++k) h[k] = plane.normal.dot(s.y[on.point[k]] - plane.point);
    for (int k = 0; k < 3; ++k) corner[k] = J::variable(h[on.vertex(k)].a, k);
    const double half = -0.5 * s.s.set.pass_weight;
    const J shadow = J::variable(s.s.set.pass_weight * -p.plane.n.dot(plane.normal) * p.area, 3);
    FollowPlane follow{traces.of(place), on, plane.normal, {half * p.plane.e2.cross(plane.normal), half * plane.normal.cross(p.plane.e1)}};
    sample_plane(s.s, slave, shadow, corner, h, static_cast<int>(piece), follow);
  });
}

// What samples of edges and vertices weigh hangs on the area behind them.
template <class Weights>
void follow_features(const Stage& stage, const Weights weights, FrozenSamples& out) {
  const Stage s = stage;
  const View<const Pair> pairs = std::as_const(out.pairs).view();
  const View<const Sample> samples = std::as_const(out.samples).view();
  const MovingView moving = view_of(out.moving);
  const Moving wanted = out.moving.wanted;
  device::parallel_for("mortar_contact.moving_features", samples.n, [=] MORTISE_HD(Index i) {
    const Sample& sample = samples[i];
    const Pair& p = pairs[sample.pair];
    if (sample.kind == SampleKind::face || !wanted.in(p.env)) return;
    const Ring ring = around(s.s, p.master, sample);
    const double area = weights.feature_area(s.s, p.n, ring.list, ring.begin, ring.end);
    if (!(area > 0)) return;
    const ByNodes to{s.s, s.y, moving.node.p + moving.start[i], static_cast<int>(moving.count(i)), moving.by(i, 4)};
    weights.area_slopes(s.s, p.slave, p.n, ring.list, ring.begin, ring.end, sample.weight / area,
                        [&](Index t, const Vec3& c, double a) { to.of_triangle(t, c, a); });
  });
}

// What other masters hide of a sample changes with their places, the slave's, and its own. Its weight is w v, v = 1 - sum of shares, of which dw is
// in.
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
    each_rim(s, under, sample, [&](Index master, double) {
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

// Between curved faces the other point of a sample stays above or below the first along n:  x_m(M) - x_s(N) = g n.
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

// Which nodes every sample hangs on.
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

}  // namespace

MovingView view_of(Motion& moving) { return {std::as_const(moving.start).view(), std::as_const(moving.node).view(), moving.by.view()}; }

template <class Weights>
void find_moving(const Stage& stage, Moving wanted, const model::PointMapView& map, const Weights& weights, const Places& places,
                 FrozenSamples& out) {
  out.moving.wanted = wanted;
  find_nodes(stage, map, out);
  each_part<Weights>(stage.s.set, [&](auto part) { follow_part<decltype(part)>(stage, weights, places, out); });
  follow_planes(stage, places, out);
  follow_features(stage, weights, out);
  follow_layers(stage, out);
  slide(stage.s, stage.y, out);
}
template void find_moving(const Stage&, Moving, const model::PointMapView&, const Consistent&, const Places&, FrozenSamples&);
template void find_moving(const Stage&, Moving, const model::PointMapView&, const Tapered&, const Places&, FrozenSamples&);

}  // namespace mortise::effects::mortar
