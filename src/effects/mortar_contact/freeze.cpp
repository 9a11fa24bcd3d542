// Freezing goes in stages, so that no kernel has to hold all of it:
//
//   patches  planes of the slaves, and how they are bent against their neighbours;
//   facing   where their masters are over them, and which come within reach at all: most candidates end here;
//   offers   where a master may have samples on a slave, and what they weigh (sampling.h): of faces, of edges, of vertices and of half-spaces by a
//            kernel each, first counted, then written;
//   judge    what other masters hide of every offer, where the curved faces above it are, and whether it lies within reach: then it is a sample.
//
// The host waits once, for the number of samples. Offers have room for as many as there were last, and some more (device/room.h).
#include <utility>

#include "effects/mortar_contact/averaged.h"
#include "effects/mortar_contact/moving.h"

namespace mortise::effects::mortar {
namespace {

// From place `at` on, as long as there is room; Sample::pair is the candidate.
struct Write {
  View<Sample> out;
  Index at, candidate;
  MORTISE_HD void operator()(SampleKind kind, double weight, double gap, const double* N, const double* M) {
    if (at < out.n) out[at] = {kind, candidate, weight, gap, {N[0], N[1], N[2]}, {M[0], M[1], M[2]}};
    ++at;
  }
};

// Where the offers of every piece go. Counting is writing without room: a kernel that does both is no larger than one of them.
struct Offers {
  View<Index> count;        // is told how many each has, or, where it is empty,
  View<const Index> first;  // begin here
  View<Sample> out;

  // show(write) offers all of piece `at`, of candidate c.
  template <class Show>
  MORTISE_HD void take(Index at, Index c, const Show& show) const {
    const bool counts = count.n > 0;
    if (!counts && first[at + 1] == first[at]) return;
    Write write{out, counts ? 0 : first[at], c};
    show(write);
    if (counts) count[at] = write.at;
  }
};

template <class Part, class Weights, class Emit>
MORTISE_HD inline void show(const Stage& stage, Index c, int piece, const Weights& weights, Emit& emit) {
  const Patch& p = stage.patch(c);
  Part::show(Sampler<double, Weights, Emit>(stage.s, p, p.facing[stage.place(c)], stage.master[c], p.plane.n, weights, emit), piece);
}

template <class Part, class Weights>
void offer(const Stage& stage, const Weights weights, const Offers& to) {
  const Stage s = stage;
  const Offers offers = to;
  device::parallel_for("mortar_contact.offers", Part::kCount * s.master.n, [=] MORTISE_HD(Index i) {
    const Index c = i / Part::kCount, piece = i % Part::kCount;
    if (s.near[c]) offers.take(kPieces * c + Part::kFirst + piece, c, [&](Write& write) { show<Part>(s, c, piece, weights, write); });
  });
}

void offer_planes(const Stage& stage, const Offers& to) {
  const Stage s = stage;
  const Offers offers = to;
  device::parallel_for("mortar_contact.offers", s.s.planes.n > 0 ? kPlanePieces * s.master.n : 0, [=] MORTISE_HD(Index i) {
    const Index c = i / kPlanePieces, piece = i % kPlanePieces;
    if (s.master[c] < 0)
      offers.take(kPieces * c + piece, c, [&](Write& write) { sample_plane(s.s, s.patch(c), s.s.planes[-1 - s.master[c]], piece, s.y, write); });
  });
}

void find_patches(const Stage& stage, const device::Ranges& whose, View<const Facing> facing, View<Patch> patches) {
  const Stage s = stage;
  device::parallel_for("mortar_contact.patches", whose, [=] MORTISE_HD(Index i) {
    Patch& p = patches[i];
    p.slave = s.s.slaves[i];
    const Triangle t = s.s.surface.triangles[p.slave];
    for (int k = 0; k < 3; ++k) p.y[k] = s.y[t.v[k]];
    p.plane = slave_plane(p.y[0], p.y[1], p.y[2]);
    p.area = p.plane.area;
    for (int k = 0; k < 3; ++k) p.bend[k] = bend(s.s, p.slave, k, p.plane.n);
    p.support = s.s.support[i];
    p.reach = p.support + s.margin[s.s.surface.env[t.v[0]]];
    p.masters = 0;
    p.master = s.master.p + s.offset[i], p.facing = facing.p + s.offset[i];
    for (Index c = s.offset[i]; c < s.offset[i + 1] && s.master[c] >= 0; ++c) ++p.masters;
  });
}

void find_facing(const Stage& stage, View<Facing> facing, View<std::uint8_t> near) {
  const Stage s = stage;
  device::parallel_for("mortar_contact.facing", s.master.n, [=] MORTISE_HD(Index c) {
    near[c] = 0;
    if (s.master[c] < 0) return;
    facing[c] = project(s.s, s.patch(c).plane, s.master[c], s.y);
    facing[c].cosine = -s.patch(c).plane.n.dot(s.s.normal[s.master[c]]);
    near[c] = within(s.s, s.patch(c), s.place(c)) ? 1 : 0;
  });
}

// Candidates of which others may hide a part: only then it is worth looking at every place.
void find_layers(const Stage& stage, View<const Index> first, View<std::uint8_t> layered) {
  const Stage s = stage;
  device::parallel_for("mortar_contact.layers", s.master.n, [=] MORTISE_HD(Index c) {
    layered[c] = 0;
    if (s.master[c] >= 0 && first[kPieces * (c + 1)] > first[kPieces * c]) layered[c] = any_layer(s.s, s.patch(c), s.place(c)) ? 1 : 0;
  });
}

// kept[o] = 1 where offer o is a sample, 0 up to the room's end.
void judge(const Stage& stage, View<const std::uint8_t> layered, View<const Index> count, View<Sample> offers, View<Index> kept) {
  const Stage s = stage;
  device::parallel_for("mortar_contact.judge", offers.n, [=] MORTISE_HD(Index o) {
    kept[o] = 0;
    if (o >= count[0]) return;
    Sample& offer = offers[o];
    const Index c = offer.pair;
    if (s.master[c] >= 0 && layered[c]) {
      offer.weight *= visible(s.s, s.patch(c), s.place(c), s.y, offer.N, offer.gap);
      if (!(offer.weight > 0)) return;
    }
    kept[o] = s.master[c] < 0 || s.s.bent(s.s.slaves[s.slave[c]]) || s.s.bent(s.master[c]) || offer.gap < s.patch(c).reach ? 1 : 0;
  });
}

// Between curved faces: faces are sampled at points of the slave, ridges and tips at their own.
void slide_offers(const Stage& stage, View<const Index> count, View<Sample> offers, View<Index> kept) {
  const Stage s = stage;
  device::parallel_for("mortar_contact.slide", s.s.quarter.n > 0 ? offers.n : 0, [=] MORTISE_HD(Index o) {
    if (o >= count[0] || !kept[o]) return;
    Sample& offer = offers[o];
    const Index c = offer.pair, i = s.slave[c], slave = s.s.slaves[i], master = s.master[c];
    if (master < 0 || !(s.s.bent(slave) || s.s.bent(master))) return;
    const bool of_slave = offer.kind == SampleKind::face;
    const Sheet under = sheet_of(s.s, s.patches[i].plane, of_slave ? slave : master, s.y);
    const Vec3 fixed = under.at(of_slave ? offer.N : offer.M);
    const Sheet over = sheet_of(s.s, s.patches[i].plane, of_slave ? master : slave, s.y);
    const Vec3 found = slide(over, fixed, of_slave ? offer.M : offer.N);
    offer.gap = std::fmax(of_slave ? found[2] - fixed[2] : fixed[2] - found[2], tuning::kLeastGap * s.s.support[i]);
    kept[o] = offer.gap < s.patches[i].reach ? 1 : 0;
  });
}

MORTISE_HD inline Pair make_pair(const MortarView& s, View<const Vec3> y, Index i, Index master) {
  Pair p;
  p.slave = s.slaves[i], p.master = master, p.d_hat = s.support[i];
  const Triangle t = s.surface.triangles[p.slave];
  const SlavePlane plane = slave_plane(y[t.v[0]], y[t.v[1]], y[t.v[2]]);
  p.env = s.surface.env[t.v[0]];
  p.on = s.nodes_of(p.slave);
  for (int a = 0; a < 3; ++a) p.k[a] = Vec3::Zero();
  const Index body = s.surface.body[t.v[0]];
  if (master < 0) {
    p.interface = s.interface_at(body, s.surface.pairs.bodies - 1 - master);
    p.n = p.m = -s.planes[-1 - master].normal;
    return p;
  }
  p.under = s.nodes_of(master);
  p.interface = s.interface_at(body, s.surface.body[p.under.point[0]]);
  p.n = p.m = plane.n;
  const double cosine = s.normal[master].dot(plane.n);
  if (s.set.exact && cosine < -tuning::kTurned) {
    p.m = s.normal[master] / cosine;
    const Vec3 u = (p.m - plane.n.dot(p.m) * plane.n) / (2 * plane.area);
    p.k[1] = plane.e2.cross(u);
    p.k[2] = u.cross(plane.e1);
    p.k[0] = -p.k[1] - p.k[2];
  }
  return p;
}

// Offsets of the environments, from those of the candidates: to[e] = of(first candidate of e).
template <class Of>
void pick(View<const Index> offset, View<const Index> first, Of of, device::Fetch& fetch, std::vector<Index>& to) {
  Buffer<Index> picked(first.n);
  const View<Index> out = picked.view();
  device::parallel_for("mortar_contact.env_offset", out.n, [=] MORTISE_HD(Index e) { out[e] = of(offset[first[e]]); });
  fetch.add(View<const Index>(out), to);
  fetch.keep(std::move(picked));
}

// Samples of candidate c are those of its offers that were kept.
struct Kept {
  View<const Index> first, at;
  MORTISE_HD Index begin(Index c) const {
    const Index o = first[kPieces * c];
    return at[o < at.n - 1 ? o : at.n - 1];
  }
  MORTISE_HD Index operator()(Index c) const { return begin(c); }
};
struct At {
  View<const Index> at;
  MORTISE_HD Index operator()(Index c) const { return at[c]; }
};

// One try; false where the room was too small, which it is no more.
template <class Weights>
bool try_freeze(const Stage& stage, const std::vector<Index>& slave_env, const Weights weights, device::Room& rooms, Moving moving,
                FrozenSamples& out) {
  const Stage s = stage;
  const Index n = s.master.n, room = rooms.among(n);
  Buffer<Index> offer_offset(kPieces * n + 1), kept_offset(room + 1), pair_offset(n + 1);
  Buffer<std::uint8_t> layered(n);
  Buffer<Sample> offer_buffer(room);
  const View<Index> counts = offer_offset.view(), keep = kept_offset.view(), pairs = pair_offset.view();
  const View<const Index> first = std::as_const(offer_offset).view(), kept = std::as_const(kept_offset).view();
  const View<Sample> offers = offer_buffer.view();
  const auto offer_all = [&](const Offers& to) {
    each_part<Weights>(s.s.set, [&](auto part) { offer<decltype(part)>(s, weights, to); });
    offer_planes(s, to);
  };
  offer_offset.zero();  // not all have every piece
  offer_all({counts, {}, {}});
  device::scan(offer_offset);
  const View<const Index> count{first.p + kPieces * n, 1};
  offer_all({{}, first, offers});
  find_layers(s, first, layered.view());
  judge(s, std::as_const(layered).view(), count, offers, keep);
  slide_offers(s, count, offers, keep);
  device::scan(kept_offset);
  const Kept samples_of{first, kept};
  device::parallel_for("mortar_contact.count_pairs", n,
                       [=] MORTISE_HD(Index c) { pairs[c] = samples_of.begin(c + 1) > samples_of.begin(c) ? 1 : 0; });
  device::scan(pair_offset);

  const Buffer<Index> env_buffer(slave_env);
  Index all = 0;
  device::Fetch fetch;
  fetch.add_total(offer_offset, all);
  pick(s.offset, env_buffer.view(), At{std::as_const(pair_offset).view()}, fetch, out.env_pairs);
  pick(s.offset, env_buffer.view(), samples_of, fetch, out.env_samples);
  fetch.now("mortar freeze");
  rooms.found(all, n);
  if (all > room) return false;

  out.samples.resize(out.env_samples.back());
  out.pairs.resize(out.env_pairs.back());
  const View<Sample> to = out.samples.view();
  const View<Pair> pair_to = out.pairs.view();
  device::parallel_for("mortar_contact.pairs", n, [=] MORTISE_HD(Index c) {
    if (pairs[c + 1] == pairs[c]) return;
    Pair p = make_pair(s.s, s.y, s.slave[c], s.master[c]);
    p.begin = samples_of.begin(c), p.end = samples_of.begin(c + 1);
    pair_to[pairs[c]] = p;
  });
  device::parallel_for("mortar_contact.samples", all, [=] MORTISE_HD(Index o) {
    if (kept[o + 1] == kept[o]) return;
    Sample sample = offers[o];
    sample.pair = pairs[sample.pair];
    to[kept[o]] = sample;
  });
  out.moving.clear();
  if (moving.wanted) find_moving(s, moving, weights, {first, kept}, out);
  return true;
}

}  // namespace

void freeze(const MortarView& view, Search& search, const Buffer<double>& margin, device::Room& room, Moving moving, FrozenSamples& out) {
  const View<const Vec3> y = std::as_const(out.y).view();
  search.update(view, y, margin);
  Buffer<Patch> patches(view.slaves.n);
  Buffer<Facing> facing(search.master().n);
  Buffer<std::uint8_t> near(search.master().n);
  const Stage stage{
      view, y, search.offset(), search.slave(), search.master(), margin.view(), std::as_const(patches).view(), std::as_const(near).view()};
  find_patches(stage, search.slaves(), std::as_const(facing).view(), patches.view());
  find_facing(stage, facing.view(), near.view());
  weighted(view.set, [&](const auto& weights) {
    while (!try_freeze(stage, search.slave_env(), weights, room, moving, out)) {
    }
  });
  average(view, out);
}

}  // namespace mortise::effects::mortar
