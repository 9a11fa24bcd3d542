#include "effects/mortar_contact/moving.h"

#include <utility>

#include "effects/contact/barrier.h"

namespace mortise::effects::mortar {
namespace {

// What a slave and a master triangle are to each other: for every corner k of the master its barycentrics L_k1, L_k2 and its height [m], then the
// slave's corners (l, 0) and (a, b) in axes of its own [m], then c = -n . n_master.
inline constexpr int kOfCorner = 3, kLength = 9, kAlong = 10, kAcross = 11, kCosine = 12, kVariables = 13;
// A kernel with all of their derivatives at once has polygons that no GPU's registers or caches hold; the CPU likes few rounds.
inline constexpr int kTogether = 5, kRounds = (kVariables + kTogether - 1) / kTogether;
using J = Jet<kTogether>;

// Sides e_1, e_2 of a triangle, its normal, and g_i with g_i . e_j = delta_ij.
struct Frame {
  Vec3 n, g[2];
  MORTISE_HD Frame(const Vec3& e1, const Vec3& e2) {
    const Vec3 twice = e1.cross(e2);
    const double length = twice.norm();
    n = twice / length;
    g[0] = e2.cross(n) / length, g[1] = n.cross(e1) / length;
  }
};
MORTISE_HD inline Frame frame_of(const FaceNodes& on, View<const Vec3> y) {
  const Vec3 a = y[on.point[on.vertex(0)]];
  return {y[on.point[on.vertex(1)]] - a, y[on.point[on.vertex(2)]] - a};
}

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
    for (int k = 0; k < 3; ++k) s.bend[k] = p.bend[k];
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

  // Adds sum_i z_i d(variable i) to `on` and `under`, by places of the slave's and the master's corners.
  MORTISE_HD void pull(const double* z, int round, Vec3 on[3], Vec3 under[3]) const {
    const auto of = [&](int i) {
      const int at = i - round * kTogether;
      return at >= 0 && at < kTogether ? z[at] : 0.0;
    };
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
  View<Vec3> by;
  Index points;

  // The sample that is told of, or -1: rounding may see another one at the rim of what is within reach.
  MORTISE_HD Index next(SampleKind kind, const J* N, const J* M) {
    const Index o = at++, sample = o < end ? places.sample(o) : -1;
    if (sample < 0 || samples[sample].kind != kind) return -1;
    const bool of_slave = kind == SampleKind::face;
    double off = 0;  // what curved faces above it are is not in yet
    for (int i = 0; i < 3; ++i) off += of_slave ? std::abs(N[i].a - samples[sample].N[i]) : std::abs(M[i].a - samples[sample].M[i]);
    return off < 1e-9 ? sample : -1;
  }
  // What is kept of its weight (layers.h).
  MORTISE_HD J weight(Index sample, const J& weight) const { return samples[sample].weight / weight.a * weight; }
  MORTISE_HD Vec3* of(Index sample, int quantity) const { return by.p + (kMoved * sample + quantity) * points; }
};

struct Follow {
  Trace trace;
  const Couple& couple;
  const FaceNodes &on, &under;
  int round;
  MORTISE_HD void operator()(SampleKind kind, const J& weight, const J&, const J* N, const J* M) {
    const Index sample = trace.next(kind, N, M);
    if (sample < 0) return;
    const J moved[kMoved] = {N[1], N[2], M[1], M[2], trace.weight(sample, weight)};
    for (int q = 0; q < kMoved; ++q) {
      Vec3 a[3] = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()}, b[3] = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
      couple.pull(moved[q].d, round, a, b);
      Vec3* to = trace.of(sample, q);
      for (int k = 0; k < 3; ++k) to[on.vertex(k)] += a[k], to[on.count + under.vertex(k)] += b[k];
    }
  }
};

template <class Part, class Weights>
void follow_part(const Stage& stage, const Weights weights, const Places& places, FrozenSamples& out) {
  const Stage s = stage;
  const Places at = places;
  const View<const Sample> samples = std::as_const(out.samples).view();
  const View<Vec3> by = out.moving.by.view();
  const Index points = out.moving.points;
  device::parallel_for("mortar_contact.moving", Part::kCount * s.master.n, [=] MORTISE_HD(Index i) {
    const Index c = i / Part::kCount, piece = i % Part::kCount, place = kPieces * c + Part::kFirst + piece, master = s.master[c];
    if (!s.near[c] || !at.any(place)) return;
    const Patch& patch = s.patch(c);
    const FaceNodes on = s.s.nodes_of(patch.slave), under = s.s.nodes_of(master);
    const Index* v = s.s.surface.triangles[master].v;
    const Vec3 corner[3] = {s.y[v[0]], s.y[v[1]], s.y[v[2]]};
    const Couple couple(patch, patch.facing[s.place(c)], corner);
    MORTISE_ROLLED for (int round = 0; round < kRounds; ++round) {
      SlaveOf<J> slave;
      FacingOf<J> facing;
      couple.see(round, slave, facing);
      Follow follow{{at, at.first[place], at.first[place + 1], samples, by, points}, couple, on, under, round};
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
      Vec3* to = trace.of(sample, q);
      for (int k = 0; k < 3; ++k) to[on.vertex(k)] += moved[q].d[k] * normal;
      for (int k = 0; k < 2; ++k) to[on.vertex(k + 1)] += moved[q].d[3] * side[k], to[on.vertex(0)] -= moved[q].d[3] * side[k];
    }
  }
};

void follow_planes(const Stage& stage, const Places& places, FrozenSamples& out) {
  const Stage s = stage;
  const Places at = places;
  const View<const Sample> samples = std::as_const(out.samples).view();
  const View<Vec3> by = out.moving.by.view();
  const Index points = out.moving.points;
  device::parallel_for("mortar_contact.moving", s.s.planes.n > 0 ? kPlanePieces * s.master.n : 0, [=] MORTISE_HD(Index i) {
    const Index c = i / kPlanePieces, piece = i % kPlanePieces, place = kPieces * c + piece;
    if (s.master[c] >= 0 || !at.any(place)) return;
    const Patch& p = s.patch(c);
    const contact::Plane plane = s.s.planes[-1 - s.master[c]];
    const FaceNodes on = s.s.nodes_of(p.slave);
    SlaveOf<J> slave;
    slave.slave = p.slave, slave.support = p.support, slave.reach = p.reach;
    J h[6], corner[3];
    for (int k = 0; k < on.count; ++k) h[k] = plane.normal.dot(s.y[on.point[k]] - plane.point);
    for (int k = 0; k < 3; ++k) corner[k] = J::variable(h[on.vertex(k)].a, k);
    const double half = -0.5 * s.s.set.pass_weight;
    const J shadow = J::variable(s.s.set.pass_weight * -p.plane.n.dot(plane.normal) * p.area, 3);
    FollowPlane follow{{at, at.first[place], at.first[place + 1], samples, by, points},
                       on,
                       plane.normal,
                       {half * p.plane.e2.cross(plane.normal), half * plane.normal.cross(p.plane.e1)}};
    sample_plane(s.s, slave, shadow, corner, h, static_cast<int>(piece), follow);
  });
}

// A point on a face: its shape functions, and how it moves with its barycentrics.
struct Spot {
  double shape[6], by[2][6];
  Vec3 x[2];  // dx / d(barycentric)
  MORTISE_HD Spot(const FaceNodes& on, const double at[3], View<const Vec3> y) {
    on.shape(at, shape);
    on.slope(at, by[0], by[1]);
    for (int j = 0; j < 2; ++j) {
      x[j] = Vec3::Zero();
      for (int k = 0; k < on.count; ++k) x[j] += by[j][k] * y[on.point[k]];
    }
  }
};

// Between curved faces the other point of a sample stays above or below the first along n:  x_m(M) - x_s(N) = g n.
void slide(const MortarView& view, View<const Vec3> y, FrozenSamples& out) {
  if (view.quarter.n == 0) return;
  const View<const Pair> pairs = std::as_const(out.pairs).view();
  const View<const Sample> samples = std::as_const(out.samples).view();
  const View<Vec3> by = out.moving.by.view();
  const Index points = out.moving.points;
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
    Vec3* of = by.p + kMoved * i * points;
    for (int k = 0; k < points_of(p); ++k) {
      // g_i . (second's own motion by barycentrics) = g_i . (first's motion - second's with its nodes) -+ ... + g g_i . dn
      const bool slave = k < p.on.count;
      const int own = slave ? k : k - p.on.count;
      Vec3 rhs[2];
      for (int r = 0; r < 2; ++r) {
        const Vec3& g = frame.g[r];
        const double move = slave ? on.shape[own] : under.shape[own];
        rhs[r] = (slave == of_slave ? move : -move) * g;
        for (int j = 0; j < 2; ++j) rhs[r] += g.dot(first.x[j]) * of[(leads + j) * points + k];
        if (!slave) continue;
        double turn = 0;  // g_i . dn = -sum_j g_i . g_j n . de_j
        for (int j = 0; j < 2; ++j) turn -= g.dot(frame.g[j]) * ((own == p.on.vertex(j + 1) ? 1 : 0) - (own == p.on.vertex(0) ? 1 : 0));
        rhs[r] += (of_slave ? sample.gap : -sample.gap) * turn * frame.n;
      }
      for (int j = 0; j < 2; ++j) of[(led + j) * points + k] = det != 0 ? Vec3((A[1 - j][1 - j] * rhs[j] - A[j][1 - j] * rhs[1 - j]) / det) : Vec3::Zero();
    }
  });
}

// d gap beyond J, by the barycentrics [m]: of N_1, N_2, M_1, M_2.
struct Slopes {
  double of[4];
  MORTISE_HD Slopes(const Pair& p, const Spot& on, const Spot* under) {
    for (int j = 0; j < 2; ++j) of[j] = -p.n.dot(on.x[j]), of[2 + j] = under ? p.n.dot(under->x[j]) : 0;
  }
};

}  // namespace

template <class Weights>
void find_moving(const Stage& stage, const Weights& weights, const Places& places, FrozenSamples& out) {
  out.moving.resize(out.samples.size(), stage.s.quarter.n > 0 ? kPoints : 6);
  out.moving.by.zero();
  each_part<Weights>(stage.s.set, [&](auto part) { follow_part<decltype(part)>(stage, weights, places, out); });
  follow_planes(stage, places, out);
  slide(stage.s, stage.y, out);
}
template void find_moving(const Stage&, const Consistent&, const Places&, FrozenSamples&);
template void find_moving(const Stage&, const Tapered&, const Places&, FrozenSamples&);

void follow(const MortarView& s, const FrozenSamples& f, const model::PointMapView& point_map, linalg::StencilSet& set, linalg::RankOnes& out) {
  const Index points = f.moving.points, rank = 3 * points, blocks = set.blocks().n;
  out.resize(rank, blocks);
  out.left.zero(), out.right.zero();
  const View<const Pair> pairs = f.pairs.view();
  const View<const Sample> samples = f.samples.view();
  const View<const double> pressure = f.pressure.view(), kappa = s.kappa;
  const View<const Vec3> by = f.moving.by.view(), y = f.y.view();
  const View<const Index> offset = set.offsets();
  const View<Vec3> left = out.left.view(), right = out.right.view();
  const model::PointMapView map = point_map;
  // Column c: what forces become while node c/3 moves along axis c%3.
  device::parallel_for("mortar_contact.follow", rank * pairs.n, [=] MORTISE_HD(Index at) {
    const Pair& p = pairs[at / rank];
    const int c = at % rank, node = c / 3, axis = c % 3, count = points_of(p);
    if (node >= count) return;
    Vec3 d[kPoints], dn = Vec3::Zero();
    for (int k = 0; k < count; ++k) d[k] = Vec3::Zero();
    const bool plane = p.master < 0;
    const Frame frame = frame_of(p.on, y);
    for (int j = 0; j < 2 && !plane && node < p.on.count; ++j)
      dn -= ((node == p.on.vertex(j + 1) ? 1 : 0) - (node == p.on.vertex(0) ? 1 : 0)) * frame.n[axis] * frame.g[j];
    for (Index j = p.begin; j < p.end; ++j) {
      const Sample& sample = samples[j];
      if (!(pressure[j] > 0)) continue;
      double move[kMoved];
      for (int q = 0; q < kMoved; ++q) move[q] = by[(kMoved * j + q) * points + node][axis];
      const Spot on(p.on, sample.N, y), under(plane ? p.on : p.under, plane ? sample.N : sample.M, y);
      const Slopes slopes(p, on, plane ? nullptr : &under);
      double dg = 0;
      for (int q = 0; q < 4; ++q) dg += slopes.of[q] * move[q];
      const double load = sample.weight * pressure[j];
      const double d_load = pressure[j] * move[4] - kappa[p.interface] * sample.weight * barrier::second(sample.gap, p.d_hat) * dg;
      // -d f_k
      for (int k = 0; k < p.on.count; ++k)
        d[k] += (d_load * on.shape[k] + load * (on.by[0][k] * move[0] + on.by[1][k] * move[1])) * p.n + load * on.shape[k] * dn;
      for (int k = 0; k < p.under.count; ++k)
        d[p.on.count + k] -= (d_load * under.shape[k] + load * (under.by[0][k] * move[2] + under.by[1][k] * move[3])) * p.n + load * under.shape[k] * dn;
    }
    const model::Expansion<kPoints> e = blocks_of(map, p);
    const Index to = c * left.n / rank + offset[at / rank];
    e.chain(d, left.p + to);
    for (int j = 0; j < model::kPointTerms; ++j)
      if (e.slot[node][j] >= 0) right[to + e.slot[node][j]][axis] += e.weight[node][j];
  });
}

void sample_changes(const MortarView& view, const FrozenSamples& f, model::SampleChanges& out) {
  constexpr Index kFunctionals = 8;  // the frozen gap, N_1, N_2, M_1, M_2, w, n . de_1, n . de_2
  const Index points = f.moving.points;
  if (points == 0) return out.resize(0, 0, 0);
  out.resize(f.samples.size(), kFunctionals, points);
  const model::SampleChangesView to = out.view();
  const View<const Pair> pairs = f.pairs.view();
  const View<const Sample> samples = f.samples.view();
  const View<const double> pressure = f.pressure.view(), kappa = view.kappa;
  const View<const Vec3> by = f.moving.by.view(), y = f.y.view();
  device::parallel_for("mortar_contact.sample_changes", samples.n, [=] MORTISE_HD(Index i) {
    const Sample& sample = samples[i];
    const Pair& p = pairs[sample.pair];
    const bool plane = p.master < 0;
    const Frame frame = frame_of(p.on, y);
    const Spot on(p.on, sample.N, y), under(plane ? p.on : p.under, plane ? sample.N : sample.M, y);
    const Slopes slopes(p, on, plane ? nullptr : &under);
    const double stiffness = kappa[p.interface] * sample.weight * barrier::second(sample.gap, p.d_hat);
    for (Index c = 0; c < kFunctionals; ++c) {
      to.clear(i, c);
      Vec3* along = to.along(i, c);
      double* weight = to.weight(i, c);
      if (c == 0) {
        Vec3 gap[kPoints];
        jacobian(p, sample, gap);
        for (int k = 0; k < points_of(p); ++k) along[k] = gap[k];
        to.force(i, c) = -stiffness;
      } else if (c < 6) {
        const int q = static_cast<int>(c) - 1;
        for (int k = 0; k < points_of(p); ++k) along[k] = by[(kMoved * i + q) * points + k];
        to.force(i, c) = q < 4 ? -stiffness * slopes.of[q] : pressure[i];
        for (int k = 0; k < p.on.count && q < 2; ++k) weight[k] = plane ? on.by[q][k] : -on.by[q][k];
        for (int k = 0; k < p.under.count && q >= 2 && q < 4; ++k) weight[p.on.count + k] = under.by[q - 2][k];
      } else if (!plane) {
        const int j = static_cast<int>(c) - 6;
        along[p.on.vertex(j + 1)] = frame.n, along[p.on.vertex(0)] = -frame.n;
        to.normal(i, c) = -frame.g[j];
      }
    }
  });
}

bool complete(const MortarView& s, const FrozenSamples& f) {
  if (s.set.exact || s.set.averaged) return false;
  const View<const Sample> samples = f.samples.view();
  return device::sum("mortar_contact.others", samples.n,
                     [=] MORTISE_HD(Index i) { return samples[i].kind == SampleKind::face ? 0.0 : 1.0; }) == 0;
}

}  // namespace mortise::effects::mortar
