#include "effects/list.h"

namespace mortise::effects {

// Each is defined at the end of effects/<name>/<name>.cpp.
Kind elasticity_kind();

std::span<const Kind> list() {
  static const Kind kinds[] = {
      elasticity_kind(),
  };
  return kinds;
}

}  // namespace mortise::effects
