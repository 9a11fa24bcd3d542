// libFuzzer target: the mesh formats that assimp reads for us. The first byte chooses the extension; whatever follows, a mesh with indices
// within its points is returned or Error is thrown. assimp itself is the system's and not instrumented.
//   build/fuzz/bin/fuzz_mesh_assimp -max_total_time=600 CORPUS
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>

#include "base/error.h"
#include "geometry/io/read.h"

using namespace mortise;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  static const char* const kExtensions[] = {".stl", ".ply", ".dae", ".glb"};
  const std::string path = "/dev/shm/mortise_fuzz_" + std::to_string(getpid()) + kExtensions[data[0] % 4];
  std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(data) + 1, static_cast<std::streamsize>(size - 1));
  try {
    const geometry::TriMesh mesh = geometry::read_surface(path);
    for (const Triangle& t : mesh.triangles)
      for (Index v : t.v)
        if (v < 0 || static_cast<std::size_t>(v) >= mesh.points.size()) std::abort();
  } catch (const Error&) {
  }
  unlink(path.c_str());
  return 0;
}
