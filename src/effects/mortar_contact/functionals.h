#pragma once
// What a sample hangs on, one number after the other (model::SampleChanges).
#include "effects/mortar_contact/moving.h"
#include "effects/mortar_contact/spot.h"

namespace mortise::effects::mortar {

// Functionals of a sample: its frozen gap, N_1, N_2, M_1, M_2, w, n . de_1, n . de_2; with the three-term gradient also what its gap changes by that
// J does not have, n_m . dE_1 and n_m . dE_2 of the master's sides, and de_1, de_2 by components.
inline constexpr Index kGap = 0, kFirstMoved = 1, kFirstTurn = kFirstMoved + kMoved, kFrozen = kFirstTurn + 2;
inline constexpr Index kRest = kFrozen, kFirstMasterTurn = kRest + 1, kFirstSide = kFirstMasterTurn + 2, kTurning = kFirstSide + 6;
MORTISE_HD inline Index functionals_of(const Settings& set) { return set.exact ? kTurning : kFrozen; }

MORTISE_HD inline bool turning(const Pair& p, const Sample& s) { return p.turning && s.kind == SampleKind::face; }

// What the gap changes by with functional c, along which it changes by itself (dg, moving.h).
MORTISE_HD inline double gap_by(const Pair& p, const Sample& s, Index c, View<const Vec3> y) {
  if (c == kGap || c == kRest) return 1;
  if (c >= kFirstMoved + 4) return 0;
  const bool slave = c < kFirstMoved + 2;
  if (!slave && p.master < 0) return 0;
  const Spot spot(slave ? p.on : p.under, slave ? s.N : s.M, y);
  return (slave ? -1 : 1) * p.n.dot(spot.x[(c - kFirstMoved) % 2]);
}

}  // namespace mortise::effects::mortar
