#pragma once
// The parts of a study's file.
#include <string>
#include <vector>

#include "scene/checker.h"
#include "scene/diagnostics.h"
#include "scene/yaml.h"
#include "study/study.h"

namespace mortise::study {

using Keys = std::vector<std::string>;

// Unknown and doubled keys; false where `node` is no block.
bool strict(const scene::Node& node, const std::string& what, const Keys& known, scene::Diagnostics& errors);

// A list of texts; one text stands for a list of one, null for none.
std::vector<std::string> texts(const scene::Node* node, const std::string& what, scene::Diagnostics& errors);

// Of a block of `PATH: value`.
Settings settings(const scene::Node& node, const std::string& what, scene::Diagnostics& errors);

Ladder ladder(const scene::Node& node, std::size_t number, scene::Diagnostics& errors);
Method method(const scene::Node& node, std::size_t number, scene::Diagnostics& errors);
Quantity quantity(const scene::Node& node, const std::string& what, scene::Checker& checker, scene::Diagnostics& errors);

}  // namespace mortise::study
