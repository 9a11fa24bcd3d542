#pragma once
#include <string>

#include "study/study.h"

namespace mortise::study {

// What the results of a folder are of, by kind ("study", "effects", ...): studied.json. Noted when there are results, so that a study that was
// refused for a mistake keeps no folder to itself.
//
// Throws Error(Exit::usage) where the folder's results of this kind are of something else: of another scene, other --set values, or ladders of which
// this study would lose steps. One that asks for more than the one before goes on with its runs.
void refuse_another_study(const Study& study, const std::string& kind, const std::string& folder);
void note_study(const Study& study, const std::string& kind, const std::string& folder);

}  // namespace mortise::study
