#pragma once
// Numbers of a scene that something may hang on: a path as in --set, and the settings that change it by a share.
#include <string>
#include <vector>

#include "base/params.h"
#include "study/study.h"

namespace mortise::study {

struct Parameter {
  std::string path;
  Params value;  // a number, or lists of numbers that are scaled together (a force's components, the values of a schedule)
  // NaN where it is not one number.
  double number() const;
  // path=value with all of it multiplied by `factor`.
  std::string scaled(double factor) const;
};

// Throws Error(Exit::usage) where the resolved scene has no such number, with what there is; `at`: who asks.
Parameter parameter(const Params& scene, const std::string& path, const SourceLoc& at);
// All that are one number or a schedule, and not zero, under materials and effects.
std::vector<Parameter> all_parameters(const Params& scene);

}  // namespace mortise::study
