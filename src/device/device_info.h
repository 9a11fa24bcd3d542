#pragma once
#include <cstddef>
#include <string>

namespace mortise::device {

struct DeviceInfo {
  std::string kind;  // "cpu", "debug" (the CPU, with Buffers out of reach of the host) or "cuda"
  std::string name;
  int threads = 0;         // CPU threads, or multiprocessors
  std::size_t memory = 0;  // bytes
  std::string driver;      // CUDA versions, "13.0": of the driver, and of the runtime this was built with
  std::string runtime;
  std::string architecture;  // "sm_90"
};

// Copies between host and device.
struct Transfers {
  long long to_device = 0, to_host = 0;  // how many
  long long bytes_to_device = 0, bytes_to_host = 0;
};
inline Transfers operator-(const Transfers& a, const Transfers& b) {
  return {a.to_device - b.to_device, a.to_host - b.to_host, a.bytes_to_device - b.bytes_to_device, a.bytes_to_host - b.bytes_to_host};
}
inline Transfers operator+(const Transfers& a, const Transfers& b) {
  return {a.to_device + b.to_device, a.to_host + b.to_host, a.bytes_to_device + b.bytes_to_device, a.bytes_to_host + b.bytes_to_host};
}

}  // namespace mortise::device
