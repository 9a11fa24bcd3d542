#pragma once
#include <cstddef>
#include <string>

namespace mortise::device {

struct DeviceInfo {
  std::string kind;  // "cpu" or "cuda"
  std::string name;
  int threads = 0;         // CPU threads, or multiprocessors
  std::size_t memory = 0;  // bytes
  std::string driver;
};

}  // namespace mortise::device
