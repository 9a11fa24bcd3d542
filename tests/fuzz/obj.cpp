// libFuzzer target: .obj. Whatever the bytes, the reader returns a mesh with indices within its points or throws Error.
#include "geometry/io/obj.h"

#include "check.h"

using namespace mortise;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return try_bytes(data, size, [](std::string_view bytes) {
    const geometry::ObjFile file = geometry::parse_obj("fuzz.obj", bytes, false);
    sound(geometry::surface_from(file));
    sound(geometry::visual_from(file));
  });
}
