#pragma once
// Studies as they are written: a file, or flags of the command line.
#include <string>

#include "base/param_table.h"
#include "base/params.h"
#include "study/study.h"

namespace mortise::study {

// Whether the file is a study's and no scene: its first key is `mortise_study`.
bool is_study(const std::string& path);

// Reads such a file (README.md). Throws SceneErrors with all that is wrong in it, Error(Exit::file).
Study read_study(const std::string& path);

// --vary key=v1,v2,...; commas inside brackets belong to a value. Throws Error(Exit::usage).
Ladder ladder_of_flag(const std::string& text);

// --qoi group/name, or a block as in a study's file: '{value: contact_pressure, body: pad, over: max}'. Throws SceneErrors.
Quantity quantity_of_flag(const std::string& text);

// The `quantities` of a scene.
std::vector<Quantity> quantities_of(const Params& scene);

}  // namespace mortise::study
