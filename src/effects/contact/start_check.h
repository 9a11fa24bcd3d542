#pragma once
// Is the first configuration free of contact distance zero and of intersections?
#include "effects/contact/candidates.h"
#include "effects/contact/law.h"
#include "model/model.h"

namespace mortise::effects::contact {

// Throws Error(Exit::scene) naming both bodies and the primitives, the first in canonical order.
void check_start(const model::Model& model, const Scene& s, const Candidates& c, View<const Vec3> y);

}  // namespace mortise::effects::contact
