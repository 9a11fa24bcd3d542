#include "effects/list.h"

namespace mortise::effects {

// Each is defined at the end of effects/<name>/<name>.cpp.
const Kind& pin_kind();
const Kind& joint_kind();  // after pins: what they hold cannot be tied
const Kind& drive_kind();  // after joints
const Kind& bond_kind();
const Kind& mortar_tie_kind();
const Kind& inertia_kind();
const Kind& gravity_kind();
const Kind& elasticity_kind();
const Kind& affine_body_kind();
const Kind& barrier_contact_kind();
const Kind& mortar_contact_kind();
const Kind& pressure_load_kind();
const Kind& friction_kind();  // after the contact effects, whose forces it reads

namespace {

KindList& kinds() {
  static KindList all = {
      pin_kind(),        joint_kind(),       drive_kind(),           bond_kind(),           mortar_tie_kind(),    inertia_kind(),  gravity_kind(),
      elasticity_kind(), affine_body_kind(), barrier_contact_kind(), mortar_contact_kind(), pressure_load_kind(), friction_kind(),
  };
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
