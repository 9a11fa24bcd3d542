// libFuzzer target: .stl. Whatever the bytes, the reader returns a mesh with indices within its points or throws Error.
#include "geometry/io/stl.h"

#include "check.h"
#include "geometry/io/read.h"

using namespace mortise;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return try_bytes(data, size, [](std::string_view bytes) {
    const auto file = geometry::parse_stl("fuzz.stl", bytes);
    sound(geometry::visual_from("fuzz.stl", file));
    sound(geometry::weld(geometry::surface_from(file), 0));
  });
}
