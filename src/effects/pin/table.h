#pragma once
#include "base/param_table.h"

namespace mortise::effects::pin {

const ParamTable& table();  // of an entry of the scene's list `pin`

}  // namespace mortise::effects::pin
