#pragma once
#include <string>
#include <vector>

#include "base/param_table.h"
#include "base/params.h"
#include "scene/diagnostics.h"

namespace mortise::scene {

// What a path of environments.vary names: its parameter, and its number in the scene where it has one.
struct Place {
  Param param;
  const Params* value = nullptr;
  bool found = false;
};

// `cited`: the path as written. Adds an error, with what was meant, where it names no number that may differ between environments.
Place find_place(const Params& cited, const Params& root, const ParamTable& table, Diagnostics& errors);

std::vector<std::string> split_path(const std::string& path);  // at its dots
std::vector<std::string> keys_of(const Params& block);

}  // namespace mortise::scene
