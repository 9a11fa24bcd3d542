#include "engine/choose.h"

#include <optional>

#include "base/error.h"

namespace mortise::engine {
namespace {

std::optional<Choice> last;

void check(const Outcome& o) {
  if (o.code != 0) throw Error(static_cast<Exit>(o.code), o.message);
}

Choice choose_cpu(bool debug, int threads) {
  const Api& cpu = cpu_api();
  check(cpu.select(0, debug));
  cpu.set_threads(threads);
  return last.emplace(Choice{&cpu, cpu.devices(nullptr).front()});
}

// The number in "cuda:3"; 0 for "cuda". -1 when the name is no GPU's.
int gpu_number(const std::string& name) {
  if (name == "cuda") return 0;
  const std::string digits = name.rfind("cuda:", 0) == 0 ? name.substr(5) : "";
  if (digits.empty() || digits.size() > 3 || digits.find_first_not_of("0123456789") != std::string::npos) return -1;
  return std::stoi(digits);
}

}  // namespace

bool is_device_name(const std::string& name) { return name == "auto" || name == "cpu" || name == "debug" || gpu_number(name) >= 0; }

const Choice& chosen() {
  if (!last) choose_cpu(false, 0);
  return *last;
}

Choice choose(const std::string& wanted, int threads) {
  if (wanted == "cpu" || wanted == "debug") return choose_cpu(wanted == "debug", threads);
  if (!is_device_name(wanted)) throw Error(Exit::usage, "no device '" + wanted + "'; must be " + kDeviceHelp);
  const bool automatic = wanted == "auto";
  const int number = automatic ? 0 : gpu_number(wanted);

  std::string why_not;
  if (const Api* cuda = cuda_api(why_not)) {
    const std::vector<device::DeviceInfo> found = cuda->devices(&why_not);
    const auto n = static_cast<int>(found.size());
    if (number < n) {
      check(cuda->select(number, false));
      return last.emplace(Choice{cuda, found[number]});
    }
    if (n > 0) why_not = "this machine has " + std::to_string(n) + (n == 1 ? " GPU" : " GPUs");
  }
  if (automatic) return choose_cpu(false, threads);
  throw Error(Exit::device, "--device " + wanted + ": " + why_not);
}

}  // namespace mortise::engine
