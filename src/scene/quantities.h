#pragma once
// `quantities`: numbers of a run that somebody is after, in scenes and in studies. src/study measures them, and says how wrong they are.
#include <set>
#include <string>

#include "base/param_table.h"
#include "base/params.h"
#include "scene/diagnostics.h"

namespace mortise::scene {

const ParamTable& quantity_table();
// What belongs together; `what` is what messages call it.
void check_quantity(const Params& quantity, const SourceLoc& at, const std::string& what, Diagnostics& errors);
void check_quantities(const Params& root, const std::set<std::string>& incomplete, Diagnostics& errors);

}  // namespace mortise::scene
