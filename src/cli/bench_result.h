#pragma once
#include <nlohmann/json.hpp>
#include <string>

namespace mortise::cli {

// What a committed result looks like: `rows` (an array) and the machine they were measured on. Throws Error(Exit::file).
void write_result(const std::string& path, const std::string& benchmark, const nlohmann::ordered_json& rows);

}  // namespace mortise::cli
