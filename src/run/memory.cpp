#include "run/memory.h"

#include <fmt/format.h>

#include "base/error.h"
#include "run/tuning.h"

namespace mortise::run {

std::string compare_memory(std::size_t needed, const device::DeviceInfo& device, const std::string& remedy) {
  const auto need = static_cast<double>(needed), have = static_cast<double>(device.memory);
  if (have <= 0 || need < tuning::kNearlyAll * have) return "";
  const std::string text = fmt::format("the scene needs about {:.0f} MiB of device memory, {} ({}) has {:.0f} MiB", need / (1 << 20), device.kind,
                                       device.name, have / (1 << 20));
  if (need > have) throw Error(Exit::device, text + "; " + remedy);
  return text;
}

}  // namespace mortise::run
