#pragma once
#include <map>
#include <string>

namespace mortise::run {

// Name and version of the libraries that this program was built with: for `mortise info` and run.json.
std::map<std::string, std::string> libraries();

}  // namespace mortise::run
