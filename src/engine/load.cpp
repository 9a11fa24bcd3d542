// Front-end side: the CPU build is linked in, the CUDA build is looked for beside the program.
#include <dlfcn.h>
#include <unistd.h>

#include <climits>

#include "engine/build.h"

namespace mortise::engine {

const Api& cpu_api() { return build_api(); }

const Api* cuda_api(std::string& why_not) {
  static const Api* api = nullptr;
  static std::string reason;
  static bool tried = false;
  if (!tried) {
    tried = true;
    char exe[PATH_MAX];
    const ssize_t n = readlink("/proc/self/exe", exe, sizeof exe - 1);
    std::string dir = n > 0 ? std::string(exe, static_cast<std::size_t>(n)) : std::string();
    dir = dir.substr(0, dir.rfind('/') + 1);
    void* handle = dlopen((dir + "../lib/libmortise_cuda.so").c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!handle) {
      const char* error = dlerror();
      reason = access((dir + "../lib/libmortise_cuda.so").c_str(), F_OK) != 0 ? "this build has no CUDA module"
                                                                              : std::string(error ? error : "unknown error");
    } else if (const auto get = reinterpret_cast<const Api* (*)()>(dlsym(handle, "mortise_engine_api"))) {
      if (get()->version == kApiVersion)
        api = get();
      else
        reason = "the CUDA module is of another version";
    } else {
      reason = "the CUDA module has no entry point";
    }
  }
  why_not = reason;
  return api;
}

}  // namespace mortise::engine
