#pragma once
#include "study/run_study.h"

namespace mortise::study {

// As run_study, within study.budget [s of CPU time, of all processes together, those of earlier attempts included]: the ladders one knob at a time,
// level by level, without what would not fit; then the knobs together, always the one that takes away most error of the first quantity per CPU
// second.
Results run_with_budget(const Study& study, const Place& place, const Told& told);

}  // namespace mortise::study
