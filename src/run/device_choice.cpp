#include "run/device_choice.h"

#include "base/error.h"

namespace mortise::run {

const engine::Api& choose_device(const std::string& wanted, int threads, device::DeviceInfo& chosen) {
  std::string why_not;
  if (wanted != "cpu") {
    if (const engine::Api* cuda = engine::cuda_api(why_not)) {
      const auto devices = cuda->devices();
      if (!devices.empty()) {
        chosen = devices.front();
        return *cuda;
      }
      why_not = "no NVIDIA GPU (or driver) on this machine";
    }
    if (wanted != "auto") throw Error(Exit::device, "--device " + wanted + ": " + why_not);
  }
  const engine::Api& cpu = engine::cpu_api();
  cpu.set_threads(threads);
  chosen = cpu.devices().front();
  return cpu;
}

}  // namespace mortise::run
