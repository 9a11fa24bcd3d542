#include "effects/list.h"

namespace mortise::effects {

// Each is defined at the end of effects/<name>/<name>.cpp.
Kind inertia_kind();
Kind gravity_kind();
Kind elasticity_kind();
Kind affine_body_kind();

std::span<const Kind> list() {
  static const Kind kinds[] = {
      inertia_kind(),
      gravity_kind(),
      elasticity_kind(),
      affine_body_kind(),
  };
  return kinds;
}

}  // namespace mortise::effects
