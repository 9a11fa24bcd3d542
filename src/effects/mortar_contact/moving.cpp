#include "effects/mortar_contact/moving.h"

#include <utility>

#include "effects/mortar_contact/couple.h"
#include "effects/mortar_contact/moving_parts.h"

namespace mortise::effects::mortar {
namespace {

inline constexpr double kSame = 1e-9;  // of barycentrics and weights: far above their rounding

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

}  // namespace

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
