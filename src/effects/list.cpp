#include "effects/list.h"

namespace mortise::effects {

// The list: a line per effect, in the order in which they act within a step. x_kind() stands at the end of effects/x/x.cpp.
// clang-format off
#define MORTISE_EFFECTS(effect) \
  effect(pin) \
  effect(joint)    /* after pins: what they hold cannot be tied */ \
  effect(drive)    /* after joints */ \
  effect(bond) \
  effect(mortar_tie) \
  effect(inertia) \
  effect(gravity) \
  effect(elasticity) \
  effect(affine_body) \
  effect(barrier_contact) \
  effect(mortar_contact) \
  effect(pressure_load) \
  effect(friction) /* after the contact effects, whose forces it reads */
// clang-format on

#define MORTISE_DECLARE(name) const Kind& name##_kind();
MORTISE_EFFECTS(MORTISE_DECLARE)

namespace {

KindList& kinds() {
#define MORTISE_ENTRY(name) name##_kind(),
  static KindList all = {MORTISE_EFFECTS(MORTISE_ENTRY)};
  return all;
}

}  // namespace

const KindList& list() { return kinds(); }

void add(const Kind& kind) { kinds().push_back(kind); }

const Kind* find_kind(std::string_view name) {
  for (const Kind& kind : kinds())
    if (name == kind.name) return &kind;
  return nullptr;
}

}  // namespace mortise::effects
