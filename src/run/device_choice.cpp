#include "run/device_choice.h"

#include <fmt/format.h>

#include "base/error.h"

namespace mortise::run {

const engine::Api& choose_device(const std::string& wanted, int threads, Record& record) {
  std::string why_not;
  if (wanted != "cpu") {
    if (const engine::Api* cuda = engine::cuda_api(why_not)) {
      const auto devices = cuda->devices();
      if (!devices.empty()) {
        record.device = "cuda: " + devices.front().name;
        return *cuda;
      }
      why_not = "no NVIDIA GPU (or driver) on this machine";
    }
    if (wanted != "auto") throw Error(Exit::device, "--device " + wanted + ": " + why_not);
  }
  const engine::Api& cpu = engine::cpu_api();
  cpu.set_threads(threads);
  const auto devices = cpu.devices();
  record.device = fmt::format("cpu: {} threads", devices.front().threads);
  return cpu;
}

}  // namespace mortise::run
