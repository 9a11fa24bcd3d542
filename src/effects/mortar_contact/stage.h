#pragma once
// What the stages of freezing (freeze.cpp) and of the samples' motion (moving.cpp) share.
#include "effects/mortar_contact/frozen.h"

namespace mortise::effects::mortar {

// Pieces of the offers of a candidate, a thread each: of its face or of a half-space, of edges, of vertices.
inline constexpr Index kFacePieces = 3, kPlanePieces = 2, kPieces = kFacePieces + 3 + 3;

// What all stages read. Candidate c is master[c] on slave[c]; those of slave i are [offset[i], offset[i + 1]), triangles first.
struct Stage {
  MortarView s;
  View<const Vec3> y;
  View<const Index> offset, slave, master;
  View<const double> margin;
  View<const Patch> patches;
  View<const std::uint8_t> near;

  MORTISE_HD Index place(Index c) const { return c - offset[slave[c]]; }  // among the slave's masters
  MORTISE_HD Index env(const Patch& p) const { return s.surface.env[s.surface.triangles[p.slave].v[0]]; }
  MORTISE_HD bool plane(Index c) const { return master[c] < 0 && master[c] != Search::kNobody; }
  MORTISE_HD const Patch& patch(Index c) const { return patches[slave[c]]; }
};

// Which offers of a candidate.
struct WholeFaces {
  static constexpr Index kFirst = 0, kCount = kFacePieces;
  template <class Sampler>
  MORTISE_HD static void show(const Sampler& sampler, int piece) {
    sampler.whole_face(piece);
  }
};
struct Fans {
  static constexpr Index kFirst = 0, kCount = 1;
  template <class Sampler>
  MORTISE_HD static void show(const Sampler& sampler, int) {
    sampler.fans();
  }
};
struct Edges {
  static constexpr Index kFirst = kFacePieces, kCount = 3;
  template <class Sampler>
  MORTISE_HD static void show(const Sampler& sampler, int piece) {
    sampler.edge(piece);
  }
};
struct Points {
  static constexpr Index kFirst = kFacePieces + 3, kCount = 3;
  template <class Sampler>
  MORTISE_HD static void show(const Sampler& sampler, int piece) {
    sampler.point(piece);
  }
};

// f(part) for all parts of the offers of triangles.
template <class Weights, class F>
void each_part(const Settings& set, const F& f) {
  if constexpr (Weights::kWhole) {
    if (set.quadrature == kMoments)
      f(WholeFaces());
    else
      f(Fans());
  } else {
    f(Fans());
  }
  f(Edges()), f(Points());
}

// Where offers are, and samples of them: those of piece `at` are offers first[at] ... first[at + 1] - 1, and offer o is sample kept[o], if any.
struct Places {
  View<const Index> first, kept;
  MORTISE_HD bool any(Index at) const { return kept[first[at + 1]] > kept[first[at]]; }
  MORTISE_HD Index sample(Index o) const { return kept[o + 1] > kept[o] ? kept[o] : -1; }
};

}  // namespace mortise::effects::mortar
