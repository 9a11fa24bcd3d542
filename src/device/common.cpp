// What both backends share: the ledgers of launches and copies, the memory account, and what scans are good for.
#include <map>

#include "device/device.h"
#include "device/memory.h"
#include "device/runs.h"

namespace mortise::device {
namespace {

std::map<std::string, long long, std::less<>>& ledger() {
  static std::map<std::string, long long, std::less<>> counts;
  return counts;
}
const std::string none;
const std::string* last = &none;  // a key of the ledger
MemoryUse use;
Transfers moved;
Waits waited;

}  // namespace

void count_launch(std::string_view name) {
  auto& counts = ledger();
  auto it = counts.find(name);
  if (it == counts.end()) it = counts.emplace(std::string(name), 0).first;
  ++it->second;
  last = &it->first;
}
const std::string& last_launch() { return *last; }

std::vector<LaunchCount> launch_counts() {
  std::vector<LaunchCount> out;
  for (const auto& [name, n] : ledger()) out.push_back({name, n});
  return out;
}

void reset_launch_counts() {
  ledger().clear();
  last = &none;
}

Transfers transfers() { return moved; }
const Waits& waits() { return waited; }

void count_to_device(std::size_t bytes) { ++moved.to_device, moved.bytes_to_device += static_cast<long long>(bytes); }
void count_to_host(std::size_t bytes, std::string_view who) {
  ++moved.to_host, moved.bytes_to_host += static_cast<long long>(bytes);
  auto it = waited.find(who);
  if (it == waited.end()) it = waited.emplace(std::string(who), 0).first;
  ++it->second;
}

MemoryUse memory_use() { return use; }

void account(std::ptrdiff_t bytes) {
  use.now += bytes;
  if (use.now > use.peak) use.peak = use.now;
}

Index exclusive_scan(Buffer<Index>& counts) {
  scan(counts);
  Index total = 0;
  copy_out(&total, counts.view().p + (counts.size() - 1), sizeof total, "scan");
  return total;
}

// Head flags, a scan, then every head writes its own place.
void mark_runs(const Buffer<std::uint64_t>& sorted_keys, Buffer<Index>& place, std::uint64_t limit) {
  const Index n = sorted_keys.size();
  place.resize(n + 1);
  const View<const std::uint64_t> k = sorted_keys.view();
  const View<Index> p = place.view();
  parallel_for("run_starts", n, [=] MORTISE_HD(Index i) { p[i] = k[i] < limit && (i == 0 || k[i] != k[i - 1]) ? 1 : 0; });
  scan(place);
}

void start_runs(const Buffer<std::uint64_t>& sorted_keys, const Buffer<Index>& place, Index most, Buffer<Index>& start, std::uint64_t limit) {
  const Index n = sorted_keys.size();
  start.resize(most + 1);
  const View<const std::uint64_t> k = sorted_keys.view();
  const View<const Index> p = place.view();
  const View<Index> s = start.view();
  parallel_for("run_starts", n + 1, [=] MORTISE_HD(Index i) {
    if (i < n && p[i + 1] > p[i] && p[i] < s.n) s[p[i]] = i;
    if ((i == n || k[i] >= limit) && (i == 0 || k[i - 1] < limit) && p[n] < s.n) s[p[n]] = i;
  });
}

void empty_runs(const Buffer<Index>& place, Buffer<Index>& start) {
  const View<const Index> runs{place.view().p + (place.size() - 1), 1};
  const View<Index> s = start.view();
  parallel_for("run_starts", s.n, [=] MORTISE_HD(Index r) {
    if (r > runs[0]) s[r] = s[runs[0]];
  });
}

void run_starts(const Buffer<std::uint64_t>& sorted_keys, Buffer<Index>& start, std::uint64_t limit) {
  Buffer<Index> place;
  mark_runs(sorted_keys, place, limit);
  Index runs = 0;
  copy_out(&runs, place.view().p + (place.size() - 1), sizeof runs, "runs");
  start_runs(sorted_keys, place, runs, start, limit);
}

Error out_of_memory(std::size_t asked, std::size_t memory) {
  const auto mib = [](std::size_t bytes) { return std::to_string((bytes + (1 << 20) - 1) >> 20) + " MiB"; };
  return Error(Exit::device, "out of device memory: " + mib(asked) + " more asked for" +
                                 (last_launch().empty() ? "" : " (after '" + last_launch() + "')") + ", " + mib(use.now) + " in use" +
                                 (memory > 0 ? " of " + mib(memory) : ""));
}

}  // namespace mortise::device
