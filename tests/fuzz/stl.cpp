// libFuzzer target: .stl. Whatever the bytes, the reader returns a mesh with indices within its points or throws Error.
#include <cstdint>
#include <string_view>

#include "base/error.h"
#include "check.h"
#include "geometry/io/stl.h"
#include "geometry/io/read.h"

using namespace mortise;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) try {
  const auto file = geometry::parse_stl("fuzz.stl", {reinterpret_cast<const char*>(data), size});
  const geometry::VisualMesh visual = geometry::visual_from("fuzz.stl", file);
  within(visual.triangles, visual.points.size());
  const geometry::TriMesh surface = geometry::weld(geometry::surface_from(file), 0);
  within(surface.triangles, surface.points.size());
  return 0;
} catch (const Error&) {
  return 0;
}
