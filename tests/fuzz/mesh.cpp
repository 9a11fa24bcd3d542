// libFuzzer target: our own mesh readers. The first byte chooses the format; whatever follows, they return a mesh or throw Error, and a mesh
// that is returned has indices within its points. (.stl, .ply, .glb and .dae are read by assimp.)
//   build/fuzz/bin/fuzz_mesh -max_total_time=600 CORPUS
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "base/error.h"
#include "geometry/io/msh.h"
#include "geometry/io/obj.h"

using namespace mortise;
using namespace mortise::geometry;

namespace {

template <class Elements>
void within(const Elements& elements, std::size_t points) {
  for (const auto& e : elements)
    for (Index v : e.v)
      if (v < 0 || static_cast<std::size_t>(v) >= points) std::abort();
}

void obj(std::string_view text) {
  const ObjFile file = parse_obj("fuzz.obj", text, false);
  const TriMesh surface = surface_from(file);
  within(surface.triangles, surface.points.size());
  const VisualMesh visual = visual_from(file);
  (void)visual;
}

void msh(std::string_view text) {
  const MshFile file = parse_msh("fuzz.msh", text);
  within(file.triangles, file.points.size());
  within(file.tets, file.points.size());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
  try {
    if (data[0] & 1)
      obj(text);
    else
      msh(text);
  } catch (const Error&) {
  }
  return 0;
}
