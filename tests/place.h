#pragma once
// Where tests find the sources and the programs: where they were built, unless the environment names another place, as it does in
// an unpacked bundle.
#include <cstdlib>
#include <string>

namespace mortise::test_place {

inline std::string place(const char* variable, const char* built) {
  const char* moved = std::getenv(variable);
  return moved ? moved : built;
}
inline const std::string kSourceFolder = place("MORTISE_TEST_SOURCE", MORTISE_SOURCE_DIR);
inline const std::string kBuildFolder = place("MORTISE_TEST_BUILD", MORTISE_BINARY_DIR);  // bin/ is in it

}  // namespace mortise::test_place
