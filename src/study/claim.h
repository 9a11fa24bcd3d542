#pragma once
#include <string>

#include "study/study.h"

namespace mortise::study {

// Notes in the folder what is studied there. Throws Error(Exit::usage) where its results of this kind ("study", "effects", ...) are of something
// else, unless they may be overwritten: of another scene, other --set values, or ladders of which this study would lose steps. A study that asks for
// more than the one before goes on with its runs.
void claim_folder(const Study& study, const std::string& kind, const std::string& folder, bool overwrite);

}  // namespace mortise::study
