#pragma once
#include "base/param_table.h"

namespace mortise::effects {

// The block `where`, with which effects select points of a body; model::select_points reads it.
extern const ParamTable where_table;

}  // namespace mortise::effects
