#pragma once
// Distributions of parameters, by the inverse of their distribution function: u in (0, 1) gives a value.
#include <string>
#include <vector>

#include "scene/diagnostics.h"
#include "scene/yaml.h"

namespace mortise::sweep {

class Distribution {
 public:
  enum class Kind { uniform, log_uniform, normal, choice };
  std::string at(double u) const;  // as --set takes it; numbers in SI

  Kind kind = Kind::uniform;
  double a = 0, b = 1;               // ends; of normal: mean and standard deviation
  std::vector<std::string> choices;  // all equally probable
};

// {uniform: [a, b]}, {log_uniform: [a, b]}, {normal: [mean, deviation]}, {choice: [...]}; numbers may have units.
Distribution read_distribution(const scene::Node& node, const std::string& what, scene::Diagnostics& errors);

}  // namespace mortise::sweep
