#pragma once
// Scalars that a scene names (`quantities`, conditions of environments.reset), held against what is reported at its start: so that hours of work do
// not end with a number that nothing reports.
#include <string>

#include "base/params.h"
#include "base/snapshot.h"
#include "model/input.h"

namespace mortise::run {

// Will "group/name" be reported, as far as the start tells? What ties, motors and supports bear is known only after a step.
bool may_report(const std::string& scalar, const Params& scene, const Snapshot& start);
// Throws Error(Exit::scene): "WHAT: nothing reports 'SCALAR'", and what was probably meant.
[[noreturn]] void not_reported(const SourceLoc& where, const std::string& what, const std::string& scalar, const Params& scene, const Snapshot& said);
// Of the scene's `quantities` and the scalars of its `checks`, and whether places that quantities name are on their bodies. Throws
// Error(Exit::scene).
void check_quantities(const model::ModelInput& input, const Snapshot& start);

}  // namespace mortise::run
