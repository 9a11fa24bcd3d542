#include "effects/list.h"

namespace mortise::effects {

// Each is defined at the end of effects/<name>/<name>.cpp.
Kind pin_kind();
Kind inertia_kind();
Kind gravity_kind();
Kind elasticity_kind();
Kind affine_body_kind();
Kind barrier_contact_kind();
Kind mortar_contact_kind();
Kind pressure_load_kind();
Kind friction_kind();  // after the contact effects, whose forces it reads

std::span<const Kind> list() {
  static const Kind kinds[] = {
      pin_kind(),
      inertia_kind(),
      gravity_kind(),
      elasticity_kind(),
      affine_body_kind(),
      barrier_contact_kind(),
      mortar_contact_kind(),
      pressure_load_kind(),
      friction_kind(),
  };
  return kinds;
}

}  // namespace mortise::effects
