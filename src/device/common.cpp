// What both backends share: the launch ledger and the memory account.
#include <atomic>
#include <map>

#include "device/device.h"
#include "device/memory.h"

namespace mortise::device {
namespace {

std::map<std::string, long long, std::less<>>& ledger() {
  static std::map<std::string, long long, std::less<>> counts;
  return counts;
}
MemoryUse use;

}  // namespace

void count_launch(std::string_view name) {
  auto& counts = ledger();
  const auto it = counts.find(name);
  if (it != counts.end())
    ++it->second;
  else
    counts.emplace(std::string(name), 1);
}

std::vector<LaunchCount> launch_counts() {
  std::vector<LaunchCount> out;
  for (const auto& [name, n] : ledger()) out.push_back({name, n});
  return out;
}

void reset_launch_counts() { ledger().clear(); }

MemoryUse memory_use() { return use; }

void account(std::ptrdiff_t bytes) {
  use.now += bytes;
  if (use.now > use.peak) use.peak = use.now;
}

}  // namespace mortise::device
