#include "run/libraries.h"

#include <cholmod.h>

#include <sstream>

extern "C" {
char* openblas_get_config(void);  // "OpenBLAS 0.3.21 ..."
char* openblas_get_corename(void);
}

namespace mortise::run {
namespace {

// With the processor that its kernels in use are made for.
std::string openblas() {
  std::string name, version;
  std::istringstream(openblas_get_config()) >> name >> version;
  return version + ", " + openblas_get_corename() + " kernels";
}

}  // namespace

std::map<std::string, std::string> libraries() {
  const std::string cholmod =
      std::to_string(CHOLMOD_MAIN_VERSION) + "." + std::to_string(CHOLMOD_SUB_VERSION) + "." + std::to_string(CHOLMOD_SUBSUB_VERSION);
  return {{"Eigen", MORTISE_EIGEN}, {"oneTBB", MORTISE_TBB},        {"CHOLMOD", cholmod},       {"OpenBLAS", openblas()},
          {"HDF5", MORTISE_HDF5},   {"assimp", MORTISE_ASSIMP},     {"yaml-cpp", MORTISE_YAML}, {"CLI11", MORTISE_CLI11},
          {"fmt", MORTISE_FMT},     {"nlohmann_json", MORTISE_JSON}};
}

}  // namespace mortise::run
