// libFuzzer target: .msh. Whatever the bytes, the reader returns a mesh with indices within its points or throws Error.
#include <cstdint>
#include <string_view>

#include "base/error.h"
#include "check.h"
#include "geometry/io/msh.h"

using namespace mortise;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) try {
  const geometry::MshFile file = geometry::parse_msh("fuzz.msh", {reinterpret_cast<const char*>(data), size});
  within(file.triangles, file.points.size());
  within(file.tets, file.points.size());
  within(file.midsides, file.points.size());
  return 0;
} catch (const Error&) {
  return 0;
}
