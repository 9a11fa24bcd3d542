#pragma once
#include <string>

#include "model/model.h"

namespace mortise::solver {

// In statics a body that its supports let move as a whole hangs on contact alone, and often that is what fails. Names such bodies of an environment
// and what would help, as lines to add to an error; "" where there is none.
//
// Supports hold point x in the directions d for which (I - P) d = d. A rigid motion v(x) = t + w x (x - c) is free when it moves no held
// point in a held direction, so when  sum over held points |(I - P) v(x)|^2 = 0: the number of free motions is the nullity of that form.
std::string unsupported(const model::Model& model, Index env);

}  // namespace mortise::solver
