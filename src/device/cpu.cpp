// CPU backend: host memory, oneTBB threads, serial scans and an in-order radix sort.
#ifndef __CUDACC__
#include <sched.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <memory>
#include <new>
#include <vector>

#include "base/error.h"
#include "device/device.h"
#include "device/memory.h"

namespace mortise::device {
namespace {

std::unique_ptr<tbb::global_control> limit;
int thread_count = 0;

int allowed_threads() {
  if (const char* slurm = std::getenv("SLURM_CPUS_PER_TASK"))
    if (const int n = std::atoi(slurm); n > 0) return n;
  cpu_set_t set;
  if (sched_getaffinity(0, sizeof set, &set) == 0) return CPU_COUNT(&set);
  return 1;
}

std::string cpu_name() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);)
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  return "unknown CPU";
}

}  // namespace

void set_threads(int n) {
  thread_count = n > 0 ? n : allowed_threads();
  limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism, thread_count);
}
int threads() { return thread_count > 0 ? thread_count : allowed_threads(); }

std::vector<DeviceInfo> devices(std::string*) {
  const std::size_t memory = static_cast<std::size_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::size_t>(sysconf(_SC_PAGE_SIZE));
  DeviceInfo cpu{"cpu", cpu_name(), threads(), memory, "", "", ""};
  if (trap::on) cpu.kind = "debug", cpu.memory = trap::memory();
  return {cpu};
}

std::vector<std::string> architectures() { return {MORTISE_ARCHITECTURES}; }

void select(int number, bool debug) {
  if (number != 0) throw Error(Exit::device, "there is one CPU device, number 0");
  if (debug) trap::start();
}

void* allocate(std::size_t bytes) {
  void* p = trap::on ? trap::allocate(bytes) : std::malloc(bytes);
  if (!p) throw out_of_memory(bytes, trap::on ? trap::memory() : 0);
  account(static_cast<std::ptrdiff_t>(bytes));
  return p;
}
void release(void* p, std::size_t bytes) {
  if (trap::owns(p))
    trap::release(p, bytes);
  else
    std::free(p);
  account(-static_cast<std::ptrdiff_t>(bytes));
}
void copy_in(void* device, const void* host, std::size_t bytes) {
  count_to_device(bytes);
  trap::check_range(device, bytes, "upload");
  const trap::Open open("upload");
  std::memcpy(device, host, bytes);
}
void copy_out(void* host, const void* device, std::size_t bytes, std::string_view who) {
  count_to_host(bytes, who);
  trap::check_range(device, bytes, "download");
  const trap::Open open("download");
  std::memcpy(host, device, bytes);
}
void copy(void* to, const void* from, std::size_t bytes) {
  trap::check_range(to, bytes, "copy");
  trap::check_range(from, bytes, "copy");
  const trap::Open open("copy");
  std::memmove(to, from, bytes);
}
void clear(void* p, std::size_t bytes) {
  trap::check_range(p, bytes, "clear");
  const trap::Open open("clear");
  std::memset(p, 0, bytes);
}
void forget(void* p, std::size_t bytes) {
  if (trap::on) trap::forget(p, bytes);
}

void scan(Buffer<Index>& counts) {
  const trap::Open open("scan");
  std::uint32_t total = 0;  // wraps around where callers find out afterwards that there are too many
  View<Index> c = counts.view();
  for (Index i = 0; i + 1 < c.n; ++i) {
    const Index here = c[i];
    c[i] = static_cast<Index>(total);
    total += static_cast<std::uint32_t>(here);
  }
  c[c.n - 1] = static_cast<Index>(total);
}

// Least-significant-digit radix sort, 11 bits a pass; passes in which all keys agree are skipped. Parts of the list are counted and moved side by
// side: as every pass keeps the order of equal digits, the result does not depend on how many there are.
void sort_pairs(Buffer<std::uint64_t>& keys, Buffer<Index>& values, int) {
  constexpr int kBits = 11, kDigits = 1 << kBits;
  constexpr std::uint64_t kMask = kDigits - 1;
  constexpr Index kPart = 1 << 15;  // terms: as long as counting takes far longer than adding the counts up
  const Index n = keys.size(), parts = (n + kPart - 1) / kPart;
  if (n < 2) return;
  Buffer<std::uint64_t> other_keys(n);
  Buffer<Index> other_values(n);
  const trap::Open open("sort");
  std::vector<std::array<Index, kDigits>> at(parts);
  const auto each_part = [&](const auto& f) {
    tbb::parallel_for(Index(0), parts, [&](Index p) { f(at[p], p * kPart, std::min(n, (p + 1) * kPart)); });
  };
  for (int shift = 0; shift < 64; shift += kBits) {
    const View<std::uint64_t> k = keys.view(), ok = other_keys.view();
    const View<Index> v = values.view(), ov = other_values.view();
    each_part([&](std::array<Index, kDigits>& count, Index from, Index to) {
      count.fill(0);
      for (Index i = from; i < to; ++i) ++count[(k[i] >> shift) & kMask];
    });
    Index first = 0, all = 0;  // of the first key's digit
    for (const auto& count : at) all += count[(k[0] >> shift) & kMask];
    if (all == n) continue;
    for (int digit = 0; digit < kDigits; ++digit)
      for (auto& count : at) {
        const Index here = count[digit];
        count[digit] = first;
        first += here;
      }
    each_part([&](std::array<Index, kDigits>& next, Index from, Index to) {
      for (Index i = from; i < to; ++i) {
        const Index place = next[(k[i] >> shift) & kMask]++;
        ok[place] = k[i];
        ov[place] = v[i];
      }
    });
    keys.swap(other_keys);
    values.swap(other_values);
  }
}

}  // namespace mortise::device
#endif
