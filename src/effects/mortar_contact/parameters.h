#pragma once
// What a scene says of mortar_contact.
#include "base/param_table.h"
#include "effects/mortar_contact/view.h"

namespace mortise::effects::mortar {

const ParamTable& parameters();

// How samples are taken. quadratic: some faces are. Throws Error (Exit::scene) where options do not go together.
Settings settings_of(const Params& p, bool quadratic);

}  // namespace mortise::effects::mortar
