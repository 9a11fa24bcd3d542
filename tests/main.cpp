// main() of every test program. MORTISE_TEST_DEVICE=cpu|cuda[:N]|debug chooses what the tests run on; the CPU without it.
//
//   programs that call the engine (scenes, run, study, cli)     engine::choose, and MORTISE_DEVICE for the processes they start
//   programs whose tests hold kernels (device, linalg, ...)     the CPU build runs cpu and debug; for cuda its twin test_x_cuda,
//                                                               compiled by nvcc, takes over
//   all others                                                  any device is as good as another
//
// A device that is not there ends the program with exit code 4 (as `--device cuda` does) before any test has run.
#include <gtest/gtest.h>
#include <unistd.h>

#include <climits>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <string>

#include "base/error.h"
#if defined(MORTISE_TEST_ENGINE)
#include "engine/choose.h"
#elif defined(MORTISE_TEST_KERNELS)
#include "device/device.h"
#endif

namespace {

#if defined(MORTISE_TEST_ENGINE)
void choose(const std::string& wanted, char**) {
  mortise::engine::choose(wanted);
  setenv("MORTISE_DEVICE", wanted.c_str(), 1);
}
#elif defined(MORTISE_TEST_KERNELS)
void choose(const std::string& wanted, char** argv) {
  using namespace mortise;
  if (wanted.rfind("cuda", 0) != 0) return device::select(0, wanted == "debug");
#ifdef __CUDACC__
  (void)argv;
  const int number = wanted.size() > 5 ? std::atoi(wanted.c_str() + 5) : 0;
  std::string why_none = "too few GPUs";
  if (number >= static_cast<int>(device::devices(&why_none).size())) throw Error(Exit::device, why_none);
  device::select(number, false);
#else
  char self[PATH_MAX] = {};
  if (readlink("/proc/self/exe", self, sizeof self - 1) > 0) execv((std::string(self) + "_cuda").c_str(), argv);
  throw Error(Exit::device, "this build has no CUDA tests");
#endif
}
#else
void choose(const std::string&, char**) {}
#endif

// What the tests of this process, and the programs it starts, write for a while: ctest runs tests side by side, and two of them may choose
// one name.
class Scratch {
 public:
  Scratch() {
    if (!mkdtemp(path_.data())) return;
    for (const char* name : {"TMPDIR", "TEST_TMPDIR"}) setenv(name, path_.c_str(), 1);
  }
  ~Scratch() {
    std::error_code left;
    std::filesystem::remove_all(path_, left);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

 private:
  std::string path_ = (std::filesystem::temp_directory_path() / "mortise-test-XXXXXX").string();
};

}  // namespace

int main(int argc, char** argv) {
  const char* wanted = std::getenv("MORTISE_TEST_DEVICE");
  // Listing needs no device.
  for (int i = 1; i < argc; ++i)
    if (std::string(argv[i]).rfind("--gtest_list_tests", 0) == 0) wanted = nullptr;
  try {
    choose(wanted ? wanted : "cpu", argv);
  } catch (const mortise::Error& e) {
    std::cerr << "error: MORTISE_TEST_DEVICE=" << (wanted ? wanted : "") << ": " << e.what() << "\n";
    return static_cast<int>(e.code());
  }
  testing::InitGoogleTest(&argc, argv);
  const Scratch scratch;
  return RUN_ALL_TESTS();
}
