// libFuzzer target: .glb, .gltf and .dae, which assimp reads in a process of its own. Whatever the bytes, a mesh with indices within its points is
// returned or Error is thrown. The first byte chooses the format. The other process is not observed, so coverage does not guide this one: it needs
// files to start from.
#include <unistd.h>

#include <cstdint>
#include <fstream>
#include <string>

#include "check.h"
#include "geometry/io/read.h"

using namespace mortise;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  static const char* const kExtensions[] = {".dae", ".glb", ".gltf"};
  const std::string path = "/dev/shm/mortise_fuzz_" + std::to_string(getpid()) + kExtensions[data[0] % 3];
  std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(data) + 1, static_cast<std::streamsize>(size - 1));
  try {
    sound(geometry::read_visual(path));
  } catch (const Error&) {
  }
  unlink(path.c_str());
  return 0;
}
