#pragma once
// The scene that a run of a study computes.
#include <string>

#include "scene/scene.h"
#include "study/study.h"

namespace mortise::study {

struct Variant {
  std::string yaml;  // everything resolved, paths absolute: what `mortise run` is given
  std::string id;    // of the scene with the content of its files: equal scenes have equal ids
};

// The study's scene by this method with these settings. It ends when the study's scene does: where time.step is varied and time.steps is not,
// time.steps follows. as_written: without what is added for the study's sake (steps and digits that are written). Throws Error(Exit::usage) where
// runs would end at different times or have several environments, and what reading a scene throws.
Variant variant_of(const Study& study, const Method& method, const Settings& settings, bool as_written = false);

// Without these effects and without what may speak of them: checks, and unless they are kept pictures.
Params without_effects(const Params& root, const std::vector<std::string>& effects, bool keep_pictures = false);

}  // namespace mortise::study
