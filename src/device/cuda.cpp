// CUDA backend: device memory, CUB radix sort and integer scan (both exact, so order does not matter).
#ifdef __CUDACC__
#include <cstdlib>
#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_scan.cuh>
#include <sstream>

#include "base/error.h"
#include "device/device.h"
#include "device/memory.h"

namespace mortise::device {

namespace {

// Kernels are loaded when the module is, not by their first launch: that may come while a graph is recorded, where loading is forbidden. Has to
// be asked for before the first call of the runtime.
[[maybe_unused]] const int eager = setenv("CUDA_MODULE_LOADING", "EAGER", 0);

std::string version_text(int version) { return std::to_string(version / 1000) + "." + std::to_string(version % 1000 / 10); }

}  // namespace

// A GPU runs behind: what a kernel did wrong shows at some later call.
void check(cudaError_t status, const char* what) {
  if (status == cudaSuccess) return;
  const bool earlier = status >= cudaErrorIllegalAddress && status <= cudaErrorLaunchFailure;
  throw Error(Exit::device, std::string("CUDA: ") + cudaGetErrorString(status) + " in " + what +
                                (earlier ? ", by it or a kernel before it (the last launch: '" + last_launch() +
                                               "'; CUDA_LAUNCH_BLOCKING=1 in the environment names the kernel)"
                                         : ""));
}

void set_threads(int) {}
int threads() { return 1; }

std::vector<DeviceInfo> devices(std::string* why_none) {
  int n = 0, driver = 0, runtime = 0;
  const cudaError_t status = cudaGetDeviceCount(&n);
  if (status != cudaSuccess) n = 0;
  cudaDriverGetVersion(&driver);
  cudaRuntimeGetVersion(&runtime);
  if (n == 0 && why_none) {
    if (driver == 0)
      *why_none = "no NVIDIA driver on this machine";
    else if (status == cudaErrorInsufficientDriver)
      *why_none = "the NVIDIA driver is too old: it knows CUDA " + version_text(driver) + ", this build needs " + version_text(runtime) +
                  "; update the driver";
    else if (status == cudaSuccess || status == cudaErrorNoDevice)
      *why_none = "no NVIDIA GPU on this machine (or CUDA_VISIBLE_DEVICES hides it)";
    else
      *why_none = std::string("the NVIDIA driver reports: ") + cudaGetErrorString(status);
  }
  std::vector<DeviceInfo> out;
  for (int d = 0; d < n; ++d) {
    cudaDeviceProp p{};
    check(cudaGetDeviceProperties(&p, d), "devices");
    out.push_back({"cuda", p.name, p.multiProcessorCount, p.totalGlobalMem, version_text(driver), version_text(runtime),
                   "sm_" + std::to_string(10 * p.major + p.minor)});
  }
  return out;
}

std::vector<std::string> architectures() {
  std::vector<std::string> out;
  std::istringstream names(MORTISE_ARCHITECTURES);
  for (std::string name; names >> name;) out.push_back(name);
  return out;
}

void select(int number, bool) {
  check(cudaSetDevice(number), "select");
  // Released memory stays with the process: solvers ask for the same sizes again and again.
  cudaMemPool_t pool;
  std::uint64_t keep = ~std::uint64_t{0};
  check(cudaDeviceGetDefaultMemPool(&pool, number), "select");
  check(cudaMemPoolSetAttribute(pool, cudaMemPoolAttrReleaseThreshold, &keep), "select");
}

void* allocate(std::size_t bytes) {
  void* p = nullptr;
  const cudaError_t status = cudaMallocAsync(&p, bytes, nullptr);
  if (status == cudaErrorMemoryAllocation) {
    cudaGetLastError();
    std::size_t free = 0, total = 0;
    cudaMemGetInfo(&free, &total);
    throw out_of_memory(bytes, total);
  }
  check(status, "allocate");
  account(static_cast<std::ptrdiff_t>(bytes));
  return p;
}
void release(void* p, std::size_t bytes) {
  cudaFreeAsync(p, nullptr);
  account(-static_cast<std::ptrdiff_t>(bytes));
}
void copy_in(void* device, const void* host, std::size_t bytes) {
  count_to_device(bytes);
  check(cudaMemcpy(device, host, bytes, cudaMemcpyHostToDevice), "upload");
}
void copy_out(void* host, const void* device, std::size_t bytes, std::string_view who) {
  count_to_host(bytes, who);
  check(cudaMemcpy(host, device, bytes, cudaMemcpyDeviceToHost), "download");
}
void copy(void* to, const void* from, std::size_t bytes) { check(cudaMemcpyAsync(to, from, bytes, cudaMemcpyDeviceToDevice), "copy"); }
void clear(void* p, std::size_t bytes) { check(cudaMemsetAsync(p, 0, bytes), "clear"); }
void forget(void*, std::size_t) {}

void scan(Buffer<Index>& counts) {
  const Index n = counts.size();
  clear(counts.view().p + (n - 1), sizeof(Index));
  count_launch("scan");
  std::size_t bytes = 0;
  check(cub::DeviceScan::ExclusiveSum(nullptr, bytes, counts.view().p, counts.view().p, n), "scan");
  Buffer<double> scratch(static_cast<Index>((bytes + 7) / 8));
  check(cub::DeviceScan::ExclusiveSum(scratch.view().p, bytes, counts.view().p, counts.view().p, n), "scan");
}

void sort_pairs(Buffer<std::uint64_t>& keys, Buffer<Index>& values, int bits) {
  const Index n = keys.size();
  if (n < 2) return;
  count_launch("sort");
  Buffer<std::uint64_t> other_keys(n);
  Buffer<Index> other_values(n);
  std::size_t bytes = 0;
  check(cub::DeviceRadixSort::SortPairs(nullptr, bytes, keys.view().p, other_keys.view().p, values.view().p, other_values.view().p, n, 0, bits),
        "sort");
  Buffer<double> scratch(static_cast<Index>((bytes + 7) / 8));
  check(cub::DeviceRadixSort::SortPairs(scratch.view().p, bytes, keys.view().p, other_keys.view().p, values.view().p, other_values.view().p, n, 0,
                                        bits),
        "sort");
  keys.swap(other_keys);
  values.swap(other_values);
}

}  // namespace mortise::device
#endif
