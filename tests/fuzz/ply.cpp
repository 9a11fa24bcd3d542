// libFuzzer target: .ply. Whatever the bytes, the reader returns a mesh with indices within its points or throws Error.
#include "geometry/io/ply.h"

#include "check.h"
#include "geometry/io/read.h"

using namespace mortise;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return try_bytes(data, size, [](std::string_view bytes) {
    const auto file = geometry::parse_ply("fuzz.ply", bytes);
    sound(geometry::visual_from("fuzz.ply", file));
    sound(geometry::weld(geometry::surface_from(file), 0));
  });
}
