#pragma once
// What mortar_contact keeps of a state: the samples of the field and the pairs of the guard.
#include "effects/contact/active.h"
#include "effects/effect.h"
#include "effects/mortar_contact/frozen.h"

namespace mortise::effects::mortar {

struct MortarLinearisation final : Linearisation {
  FrozenSamples frozen;
  Buffer<Vec3> normal;       // of all triangles there,
  Buffer<double> area, bow;  // their areas, and how far their quadratic faces stand off
  contact::ActiveSet guard;
  linalg::StencilSet guard_stencils;
  Buffer<Index> origin;                 // of contact.samples, where the guard has some (contact/join.h)
  std::vector<double> alpha, farthest;  // of the way that was asked for last: as far as it may be gone; how far it moves points [m]
  explicit MortarLinearisation(Index envs) { guard.env_offset.assign(envs + 1, 0); }
  // Places of sample i of the field and of the guard in contact.samples: in every environment those of the guard come last.
  Index place(Index env, Index i) const { return i + guard.env_offset[env]; }
  Index guard_place(Index env, Index i) const { return i + frozen.env_samples[env + 1]; }
  View<const Vec3> y() const { return frozen.y.view(); }
  std::size_t bytes() const override {
    return Linearisation::bytes() + frozen.pairs.bytes() + frozen.samples.bytes() + frozen.moving.bytes() + frozen.y.bytes() + normal.bytes() +
           area.bytes() + guard.terms.bytes() + guard_stencils.bytes() + origin.bytes();
  }
};
inline MortarLinearisation& of_mortar(Linearisation& at) { return static_cast<MortarLinearisation&>(at); }
inline const MortarLinearisation& of_mortar(const Linearisation& at) { return static_cast<const MortarLinearisation&>(at); }

}  // namespace mortise::effects::mortar
