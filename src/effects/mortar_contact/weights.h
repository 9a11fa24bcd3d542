#pragma once
// The two weightings of the same samples, and the one place that tells them apart.
#include "effects/mortar_contact/consistent.h"
#include "effects/mortar_contact/tapered.h"

namespace mortise::effects::mortar {

// f(weighting) with the weighting that the scene asks for: on the host, so that every kernel holds one of them.
template <class F>
inline void weighted(const Settings& set, const F& f) {
  set.tapered() ? f(Tapered(set)) : f(Consistent(set));
}

// How much a master face with normal nm counts for a slave with normal n.
MORTISE_HD inline double facing(const Settings& set, const Vec3& n, const Vec3& nm) {
  const double cosine = -n.dot(nm);
  return set.tapered() ? Tapered(set).facing(cosine) : Consistent(set).facing(cosine);
}

}  // namespace mortise::effects::mortar
