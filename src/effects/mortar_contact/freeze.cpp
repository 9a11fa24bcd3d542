// Freezing goes in stages, so that no kernel has to hold all of it:
//
//   patches  planes of the slaves, and how they are bent against their neighbours;
//   facing   where their masters are over them, and which come within reach at all: most candidates end here;
//   offers   where a master may have samples on a slave, and what they weigh (sampling.h): of faces, of edges, of vertices and of half-spaces by a
//            kernel each, first counted, then written;
//   judge    what other masters hide of every offer, where the curved faces above it are, and whether it lies within reach: then it is a sample.
//
// The host waits once, for the numbers of all. Candidates and offers have room for as many as there were last, and some more (device/room.h).
#include <type_traits>
#include <utility>

#include "effects/mortar_contact/averaged.h"
#include "effects/mortar_contact/freezing.h"
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
    if (s.plane(c))
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
    for (Index c = s.offset[i]; c < s.offset[i + 1] && c < s.master.n && s.master[c] >= 0; ++c) ++p.masters;
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
  p.slave = s.slaves[i], p.master = master, p.d_hat = s.support[i], p.turning = false;
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
  p.turning = s.set.exact && cosine < -tuning::kTurned;
  if (p.turning) {
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
void pick(const Stage& stage, View<const Index> first, Of of, device::Fetch& fetch, std::vector<Index>& to) {
  const View<const Index> offset = stage.offset;
  const Index room = stage.master.n;
  Buffer<Index> picked(first.n);
  const View<Index> out = picked.view();
  device::parallel_for("mortar_contact.env_offset", out.n, [=] MORTISE_HD(Index e) {
    const Index c = offset[first[e]];
    out[e] = of(c < room ? c : room);
  });
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

// What is counted of every candidate, a list each. One scan goes through all of them.
enum List : Index { pairs, pair_blocks, pair_pairs, sample_blocks, sample_pairs, kLists };

// 1 of a candidate with samples, and how many blocks, and pairs of them, its stencil has and those of its samples have together; `lists`: the first
// alone, or all.
void count_pairs(const Stage& stage, const Kept& samples_of, const model::PointMapView& point_map, Index lists, Buffer<Index>& counts) {
  const Stage s = stage;
  const Index n = s.master.n;
  counts.resize(lists * n + 1);
  const View<Index> count = counts.view();
  const bool sizes = lists > 1;
  const model::PointMapView map = point_map;
  device::parallel_for("mortar_contact.count_pairs", n, [=] MORTISE_HD(Index c) {
    const Index samples = samples_of.begin(c + 1) - samples_of.begin(c);
    count[c] = samples > 0 ? 1 : 0;
    if (!sizes) return;
    Index blocks = 0;
    if (samples > 0) {
      const FaceNodes none{}, on = s.s.nodes_of(s.s.slaves[s.slave[c]]), under = s.master[c] < 0 ? none : s.s.nodes_of(s.master[c]);
      blocks = blocks_of(map, on, under).blocks;
    }
    count[pair_blocks * n + c] = blocks, count[pair_pairs * n + c] = linalg::pair_count(blocks);
    count[sample_blocks * n + c] = samples * blocks, count[sample_pairs * n + c] = samples * linalg::pair_count(blocks);
  });
  device::scan(counts);
}

}  // namespace

void Freezing::begin(const MortarView& view, Search& search, const Buffer<double>& margin, const FreezeRoom& room, const model::PointMapView* map,
                     FrozenSamples& out, device::Fetch& fetch) {
  const View<const Vec3> y = std::as_const(out.y).view();
  search_ = &search, out_ = &out;
  if (map) map_ = *map;
  const Index slaves = search.slaves().size(), n = room.candidates.among(slaves);
  search.begin(view, y, margin, n, fetch);
  patches_.resize(view.slaves.n);
  facing_.resize(n), near_.resize(n);
  stage_.emplace(
      Stage{view, y, search.offset(), search.slave(), search.master(), margin.view(), std::as_const(patches_).view(), std::as_const(near_).view()});
  const Stage& s = *stage_;
  find_patches(s, search.slaves(), std::as_const(facing_).view(), patches_.view());
  find_facing(s, facing_.view(), near_.view());

  offers_at_.resize(kPieces * n + 1), offers_.resize(room.offers.among(slaves)), kept_at_.resize(offers_.size() + 1);
  const View<const Index> first = std::as_const(offers_at_).view(), kept = std::as_const(kept_at_).view(), count{first.p + kPieces * n, 1};
  weighted(view.set, [&](const auto& weights) {
    const auto offer_all = [&](const Offers& to) {
      each_part<std::decay_t<decltype(weights)>>(view.set, [&](auto part) { offer<decltype(part)>(s, weights, to); });
      offer_planes(s, to);
    };
    offers_at_.zero();  // not all have every piece
    offer_all({offers_at_.view(), {}, {}});
    device::scan(offers_at_);
    offer_all({{}, first, offers_.view()});
  });
  layered_.resize(n);
  find_layers(s, first, layered_.view());
  judge(s, std::as_const(layered_).view(), count, offers_.view(), kept_at_.view());
  slide_offers(s, count, offers_.view(), kept_at_.view());
  device::scan(kept_at_);
  const Kept samples_of{first, kept};
  list_end_.assign(map ? kLists : 1, 0);
  const auto lists = static_cast<Index>(list_end_.size());
  count_pairs(s, samples_of, map_, lists, counts_);

  fetch.add_total(offers_at_, offered_);
  const View<const Index> added = std::as_const(counts_).view();
  for (Index list = 0; list < lists; ++list)
    fetch.add(View<const Index>{added.p + (list + 1) * n, 1}, [this, list](const std::vector<Index>& sum) { list_end_[list] = sum[0]; });
  const Buffer<Index> env_buffer(search.slave_env());
  pick(s, env_buffer.view(), At{added}, fetch, out.env_pairs);
  pick(s, env_buffer.view(), samples_of, fetch, out.env_samples);
}

bool Freezing::end(FreezeRoom& rooms, Moving moving) {
  const Index slaves = search_->slaves().size();
  const Index candidates = stage_->master.n;
  const bool all = search_->end();
  // Where there was no room for all candidates, as many more of them have offers too.
  const auto offered = static_cast<Index>(all ? offered_ : static_cast<double>(offered_) / candidates * search_->found());
  rooms.candidates.found(search_->found(), slaves, FreezeRoom::kKept);
  rooms.offers.found(offered, slaves, FreezeRoom::kKept);
  if (!all || offered > offers_.size()) return false;
  stage_->slave = search_->slave(), stage_->master = search_->master();

  FrozenSamples& out = *out_;
  out.of_pairs = out.of_samples = {};
  if (list_end_.size() == kLists) {
    const auto of = [&](List list) { return list_end_[list] - list_end_[list - 1]; };
    out.of_pairs = {of(pair_blocks), of(pair_pairs)}, out.of_samples = {of(sample_blocks), of(sample_pairs)};
  }
  out.samples.resize(out.env_samples.back());
  out.pairs.resize(out.env_pairs.back());
  const Stage s = *stage_;
  const View<const Index> first = std::as_const(offers_at_).view(), kept = std::as_const(kept_at_).view(), pairs = std::as_const(counts_).view();
  const Kept samples_of{first, kept};
  const View<const Sample> offers = std::as_const(offers_).view();
  const View<Sample> to = out.samples.view();
  const View<Pair> pair_to = out.pairs.view();
  const View<const std::uint8_t> layered = std::as_const(layered_).view();
  device::parallel_for("mortar_contact.pairs", s.master.n, [=] MORTISE_HD(Index c) {
    if (pairs[c + 1] == pairs[c]) return;
    Pair p = make_pair(s.s, s.y, s.slave[c], s.master[c]);
    p.begin = samples_of.begin(c), p.end = samples_of.begin(c + 1), p.layered = layered[c] != 0;
    pair_to[pairs[c]] = p;
  });
  device::parallel_for("mortar_contact.samples", offered_, [=] MORTISE_HD(Index o) {
    if (kept[o + 1] == kept[o]) return;
    Sample sample = offers[o];
    sample.pair = pairs[sample.pair];
    to[kept[o]] = sample;
  });
  out.moving.clear();
  if (moving.wanted) weighted(s.s.set, [&](const auto& weights) { find_moving(s, moving, map_, weights, {first, kept}, out); });
  average(s.s, out);
  return true;
}

void freeze(const MortarView& view, Search& search, const Buffer<double>& margin, FreezeRoom& room, const model::PointMapView* map, Moving moving,
            FrozenSamples& out) {
  for (bool done = false; !done;) {
    Freezing freezing;
    device::Fetch fetch;
    freezing.begin(view, search, margin, room, map, out, fetch);
    fetch.now("mortar freeze");
    done = freezing.end(room, moving);
  }
}

}  // namespace mortise::effects::mortar
