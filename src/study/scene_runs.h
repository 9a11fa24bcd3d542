#pragma once
// The runs of a study of a scene.
#include "study/study.h"

namespace mortise::study {

using Settings = std::vector<std::pair<std::string, std::string>>;

// Settings to --set, with as many time steps as the runs need to end when the scene does: where time.step is varied and time.steps is
// not, time.steps follows. Error(Exit::usage) where runs would end at different times.
std::vector<std::string> overrides_of(const Study& study, const Settings& settings);

// Runs all combinations and compares them; `references` tells with what, quantity by quantity.
void run_scenes(const Study& study, const std::vector<Settings>& runs, std::vector<Point>& points, std::vector<std::string>& references);

}  // namespace mortise::study
