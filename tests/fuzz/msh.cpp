// libFuzzer target: .msh. Whatever the bytes, the reader returns a mesh with indices within its points or throws Error.
#include "geometry/io/msh.h"

#include "check.h"

using namespace mortise;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return try_bytes(data, size, [](std::string_view bytes) {
    const geometry::MshFile file = geometry::parse_msh("fuzz.msh", bytes);
    within(file.triangles, file.points.size());
    within(file.tets, file.points.size());
    within(file.midsides, file.points.size());
  });
}
