#pragma once
#include <nlohmann/json.hpp>
#include <string>

namespace mortise {

// Names, paths and messages of others need not be UTF-8, as JSON has to be: other bytes become U+FFFD. indent < 0: on one line.
template <class Json>
std::string json_text(const Json& j, int indent = -1) {
  return j.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace mortise
