#pragma once
#include <string>
#include <utility>
#include <vector>

namespace mortise::output {

// One environment of a batch as the file below sees it.
struct EnvironmentFields {
  std::string folder;                                  // beside the file
  int exit_code = -1;                                  // -1: it never began
  std::vector<std::string> runs;                       // folders of its episodes one after the other, or its own; their fields.vtkhdf may be missing
  std::vector<std::pair<std::string, double>> values;  // drawn for it: path and number
};

// Writes FOLDER/fields.vtkhdf, which holds no fields of its own (schemas/fields.md): a VTKHDF collection whose blocks are links to the environments'
// files, and under /environments one virtual dataset per field, table of steps and scalar with the environment as its first axis. Throws
// Error(Exit::file).
void write_environment_fields(const std::string& folder, const std::vector<EnvironmentFields>& all);

}  // namespace mortise::output
