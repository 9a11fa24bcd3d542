#pragma once
// Distributions of parameters, by the inverse of their distribution function: u in (0, 1) gives a value.
#include <algorithm>
#include <string>
#include <vector>

#include "scene/diagnostics.h"
#include "scene/yaml.h"

namespace mortise::scene {

class Distribution {
 public:
  enum class Kind { uniform, log_uniform, normal, choice };
  std::string at(double u) const;  // as --set takes it; numbers in SI
  double number(double u) const;   // the same, of all kinds but a choice
  static std::size_t one_of(double u, std::size_t n) { return std::min(static_cast<std::size_t>(u * static_cast<double>(n)), n - 1); }

  Kind kind = Kind::uniform;
  double a = 0, b = 1;               // ends; of normal: mean and standard deviation
  std::vector<std::string> choices;  // all equally probable
};

// {uniform: [a, b]}, {log_uniform: [a, b]}, {normal: [mean, deviation]}, {choice: [...]}; numbers may have units.
Distribution read_distribution(const Node& node, const std::string& what, Diagnostics& errors);

}  // namespace mortise::scene
