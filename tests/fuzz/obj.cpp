// libFuzzer target: .obj. Whatever the bytes, the reader returns a mesh with indices within its points or throws Error.
#include <cstdint>
#include <string_view>

#include "base/error.h"
#include "check.h"
#include "geometry/io/obj.h"

using namespace mortise;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) try {
  const geometry::ObjFile file = geometry::parse_obj("fuzz.obj", {reinterpret_cast<const char*>(data), size}, false);
  const geometry::TriMesh surface = geometry::surface_from(file);
  within(surface.triangles, surface.points.size());
  const geometry::VisualMesh visual = geometry::visual_from(file);
  within(visual.triangles, visual.points.size());
  return 0;
} catch (const Error&) {
  return 0;
}
