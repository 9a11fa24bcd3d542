#include "run/libraries.h"

#include <cholmod.h>

namespace mortise::run {

std::map<std::string, std::string> libraries() {
  const std::string cholmod =
      std::to_string(CHOLMOD_MAIN_VERSION) + "." + std::to_string(CHOLMOD_SUB_VERSION) + "." + std::to_string(CHOLMOD_SUBSUB_VERSION);
  return {{"Eigen", MORTISE_EIGEN},   {"oneTBB", MORTISE_TBB},  {"CHOLMOD", cholmod}, {"HDF5", MORTISE_HDF5},         {"assimp", MORTISE_ASSIMP},
          {"yaml-cpp", MORTISE_YAML}, {"CLI11", MORTISE_CLI11}, {"fmt", MORTISE_FMT}, {"nlohmann_json", MORTISE_JSON}};
}

}  // namespace mortise::run
