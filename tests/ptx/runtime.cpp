// The functions of the CUDA runtime that the module calls, with kernels run by threads.cpp as soon as they are launched. What CUDA forbids
// (a call while a stream is being captured, a copy in a direction its pointers do not have, a launch that is too large) is reported.
#include <cuda_runtime_api.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "memory.h"
#include "report.h"
#include "threads.h"

using namespace ptx;

namespace {

constexpr std::uint32_t kSharedBytes = 48 << 10, kParameterBytes = 4096;

using Work = std::function<void()>;
struct Recording {
  std::vector<Work> work;
  bool on = false;
};
Recording* recording = nullptr;

struct Configuration {
  dim3 grid, block;
  std::size_t shared;
  cudaStream_t stream;
};
std::vector<Configuration> configurations;

// Filled by the constructors of other objects, and used until the very end.
std::map<std::string, const Kernel*>& kernels() {
  static auto* k = new std::map<std::string, const Kernel*>;
  return *k;
}
std::map<const void*, std::string>& names() {
  static auto* n = new std::map<const void*, std::string>;
  return *n;
}

cudaError_t last = cudaSuccess, for_good = cudaSuccess;

// Faults of a kernel stay with the process.
bool stays(int error) { return error >= cudaErrorIllegalAddress && error <= cudaErrorLaunchFailure; }

// The error that MORTISE_PTX_FAIL plans for this call.
cudaError_t planned(const std::string& function) {
  struct Plan {
    long left = 0;
    int error = 0;
  };
  static std::map<std::string, Plan> plans = [] {
    std::map<std::string, Plan> out;
    std::istringstream all(settings().fail);
    for (std::string one; std::getline(all, one, ',');) {
      std::istringstream parts(one);
      std::string name;
      char colon;
      Plan p;
      if (std::getline(parts, name, ':') && parts >> p.left >> colon >> p.error) out[name] = p;
    }
    return out;
  }();
  const auto it = plans.find(function);
  return it != plans.end() && --it->second.left == 0 ? static_cast<cudaError_t>(it->second.error) : cudaSuccess;
}

enum When { kAlways, kNotWhileCapturing };
cudaError_t enter(const char* function, When when = kAlways) {
  count_call(function);
  if (when == kNotWhileCapturing && recording) report(std::string(function) + " while a stream is being captured");
  if (for_good != cudaSuccess) return last = for_good;
  const cudaError_t error = planned(function);
  if (error == cudaSuccess) return error;
  if (stays(error)) for_good = error;
  return last = error;
}

cudaError_t wrong(cudaError_t error, const std::string& what) {
  report(what);
  return last = error;
}

cudaError_t submit(cudaStream_t stream, Work work) {
  auto* r = reinterpret_cast<Recording*>(stream);
  if (r && r->on)
    r->work.push_back(std::move(work));
  else {
    if (recording && !r) report("work for the default stream while another is being captured");
    work();
  }
  return cudaSuccess;
}

int architecture() { return kernels().empty() ? 0 : kernels().begin()->second->architecture; }

}  // namespace

void ptx_know(const Kernel* k, int count) {
  for (int i = 0; i < count; ++i)
    if (kernels().emplace(k[i].name, &k[i]).second) count_known(&k[i]);  // the same template in several objects: the same code
}

extern "C" {

void** __cudaRegisterFatBinary(void*) {
  static void* handle;
  return &handle;
}
void __cudaRegisterFatBinaryEnd(void**) {}
void __cudaUnregisterFatBinary(void**) {}
void __cudaRegisterVar(void**, char*, char*, const char*, int, std::size_t, int, int) {}
void __cudaRegisterFunction(void**, const char* host, char*, const char* name, int, uint3*, uint3*, dim3*, dim3*, int*) { names()[host] = name; }
unsigned __cudaPushCallConfiguration(dim3 grid, dim3 block, std::size_t shared, CUstream_st* stream) {
  configurations.push_back({grid, block, shared, stream});
  return 0;
}
cudaError_t __cudaPopCallConfiguration(dim3* grid, dim3* block, std::size_t* shared, void* stream) {
  const Configuration c = configurations.back();
  configurations.pop_back();
  *grid = c.grid, *block = c.block, *shared = c.shared, *static_cast<cudaStream_t*>(stream) = c.stream;
  return cudaSuccess;
}
cudaError_t __cudaGetKernel(cudaKernel_t* kernel, const void* host) {
  *kernel = reinterpret_cast<cudaKernel_t>(const_cast<void*>(host));
  return cudaSuccess;
}

cudaError_t cudaLaunchKernel(const void* host, dim3 grid, dim3 block, void** arguments, std::size_t shared, cudaStream_t stream) {
  if (const cudaError_t e = enter("cudaLaunchKernel")) return e;
  const auto it = kernels().find(names()[host]);
  if (it == kernels().end()) return wrong(cudaErrorInvalidDeviceFunction, "launch of a kernel that was not translated: " + names()[host]);
  const Kernel* k = it->second;
  const std::size_t threads = std::size_t{block.x} * block.y * block.z;
  if (threads == 0 || grid.x == 0 || grid.y == 0 || grid.z == 0)
    return wrong(cudaErrorInvalidConfiguration, std::string("empty launch of ") + k->name);
  if (threads > k->most_threads || grid.x > 0x7fffffffu || grid.y > 65535 || grid.z > 65535)
    return wrong(cudaErrorInvalidConfiguration, std::string("too large a launch of ") + k->name);
  if (k->shared_bytes + shared > kSharedBytes) return wrong(cudaErrorInvalidConfiguration, std::string("too much shared memory for ") + k->name);
  Launch l{k, {grid.x, grid.y, grid.z}, {block.x, block.y, block.z}, static_cast<std::uint32_t>(shared), {}};
  for (int i = 0; i < k->parameter_count; ++i) {
    l.parameters.resize(k->parameter[i].offset + k->parameter[i].size);
    std::memcpy(l.parameters.data() + k->parameter[i].offset, arguments[i], k->parameter[i].size);
  }
  if (l.parameters.size() > kParameterBytes) return wrong(cudaErrorInvalidValue, std::string("too many parameters for ") + k->name);
  return submit(stream, [l]() mutable { run(l); });
}
cudaError_t __cudaLaunchKernel(cudaKernel_t kernel, dim3 grid, dim3 block, void** arguments, std::size_t shared, cudaStream_t stream) {
  return cudaLaunchKernel(kernel, grid, block, arguments, shared, stream);
}

// --- the device ---

cudaError_t cudaGetDeviceCount(int* n) {
  *n = 0;
  if (const cudaError_t e = enter("cudaGetDeviceCount")) return e;
  *n = 1;
  return cudaSuccess;
}
cudaError_t cudaGetDeviceProperties(cudaDeviceProp* p, int) {
  *p = {};
  if (const cudaError_t e = enter("cudaGetDeviceProperties")) return e;
  std::strcpy(p->name, "PTX on the CPU (tests/ptx)");
  p->multiProcessorCount = 4, p->totalGlobalMem = settings().memory, p->major = architecture() / 10, p->minor = architecture() % 10;
  return cudaSuccess;
}
cudaError_t cudaDeviceGetAttribute(int* value, cudaDeviceAttr a, int) {
  const std::map<int, int> known{{cudaDevAttrMultiProcessorCount, 4},
                                 {cudaDevAttrComputeCapabilityMajor, architecture() / 10},
                                 {cudaDevAttrComputeCapabilityMinor, architecture() % 10},
                                 {cudaDevAttrMaxGridDimX, 0x7fffffff},
                                 {cudaDevAttrMaxThreadsPerBlock, 1024},
                                 {cudaDevAttrMaxSharedMemoryPerBlock, kSharedBytes},
                                 {cudaDevAttrWarpSize, 32},
                                 {cudaDevAttrMaxSharedMemoryPerBlockOptin, kSharedBytes}};
  const auto it = known.find(a);
  if (it == known.end()) return wrong(cudaErrorInvalidValue, "device attribute " + std::to_string(a) + " is not known to tests/ptx");
  *value = it->second;
  return enter("cudaDeviceGetAttribute");
}
cudaError_t cudaSetDevice(int n) {
  if (const cudaError_t e = enter("cudaSetDevice")) return e;
  return n == 0 ? cudaSuccess : last = cudaErrorInvalidDevice;
}
cudaError_t cudaGetDevice(int* n) {
  *n = 0;
  return enter("cudaGetDevice");
}
cudaError_t cudaDriverGetVersion(int* v) {
  const cudaError_t e = enter("cudaDriverGetVersion");
  *v = e == cudaSuccess ? CUDART_VERSION : 0;
  return e;
}
cudaError_t cudaRuntimeGetVersion(int* v) {
  *v = CUDART_VERSION;
  return enter("cudaRuntimeGetVersion");
}
cudaError_t cudaDeviceGetDefaultMemPool(cudaMemPool_t* pool, int) {
  *pool = nullptr;
  return enter("cudaDeviceGetDefaultMemPool");
}
cudaError_t cudaMemPoolSetAttribute(cudaMemPool_t, cudaMemPoolAttr, void*) { return enter("cudaMemPoolSetAttribute"); }
cudaError_t cudaFuncGetAttributes(cudaFuncAttributes* a, const void* host) {
  *a = {};
  const auto it = kernels().find(names()[host]);
  a->binaryVersion = a->ptxVersion = architecture();
  a->maxThreadsPerBlock = it != kernels().end() ? static_cast<int>(it->second->most_threads) : 1024;
  return enter("cudaFuncGetAttributes");
}
cudaError_t cudaOccupancyMaxActiveBlocksPerMultiprocessorWithFlags(int* n, const void*, int, std::size_t, unsigned) {
  *n = 2;
  return enter("cudaOccupancyMaxActiveBlocksPerMultiprocessorWithFlags");
}

const char* cudaGetErrorString(cudaError_t e) {
  switch (e) {
    case cudaErrorMemoryAllocation:
      return "out of memory";
    case cudaErrorInsufficientDriver:
      return "CUDA driver version is insufficient for CUDA runtime version";
    case cudaErrorNoDevice:
      return "no CUDA-capable device is detected";
    case cudaErrorNoKernelImageForDevice:
      return "no kernel image is available for execution on the device";
    case cudaErrorIllegalAddress:
      return "an illegal memory access was encountered";
    default: {
      static thread_local char text[32];
      std::snprintf(text, sizeof text, "CUDA error %d", static_cast<int>(e));
      return text;
    }
  }
}
const char* cudaGetErrorName(cudaError_t e) { return cudaGetErrorString(e); }
cudaError_t cudaGetLastError() {
  const cudaError_t e = last;
  last = for_good;
  return e;
}
cudaError_t cudaPeekAtLastError() { return last; }

// --- memory ---

cudaError_t cudaMallocAsync(void** p, std::size_t bytes, cudaStream_t) {
  *p = nullptr;
  if (const cudaError_t e = enter("cudaMallocAsync", kNotWhileCapturing)) return e;
  if (bytes == 0) return cudaSuccess;
  *p = allocate(bytes);
  return *p ? cudaSuccess : last = cudaErrorMemoryAllocation;
}
cudaError_t cudaFreeAsync(void* p, cudaStream_t) {
  if (const cudaError_t e = enter("cudaFreeAsync", kNotWhileCapturing)) return e;
  return !p || release(p) ? cudaSuccess : wrong(cudaErrorInvalidValue, "release of what is no buffer");
}
cudaError_t cudaMemGetInfo(std::size_t* free, std::size_t* total) {
  *total = settings().memory, *free = settings().memory - in_use();
  return enter("cudaMemGetInfo");
}
cudaError_t cudaMemcpyAsync(void* to, const void* from, std::size_t bytes, cudaMemcpyKind kind, cudaStream_t stream) {
  if (const cudaError_t e = enter("cudaMemcpyAsync")) return e;
  if (bytes == 0) return cudaSuccess;
  const bool to_device = kind == cudaMemcpyHostToDevice || kind == cudaMemcpyDeviceToDevice,
             from_device = kind == cudaMemcpyDeviceToHost || kind == cudaMemcpyDeviceToDevice;
  if (to_device != on_device(to) || from_device != on_device(from))
    return wrong(cudaErrorInvalidValue, "copy in a direction that its pointers do not have");
  if ((to_device && !one_buffer(to, bytes)) || (from_device && !one_buffer(from, bytes)))
    return wrong(cudaErrorInvalidValue, "copy outside a buffer");
  if (to_device && from_device && static_cast<char*>(to) < static_cast<const char*>(from) + bytes &&
      static_cast<const char*>(from) < static_cast<char*>(to) + bytes)
    report("copy within the device between ranges that overlap");
  return submit(stream, [=] {
    std::memmove(to, from, bytes);
    if (to_device && from_device) mark_copied(to, from, bytes);
    if (to_device && !from_device) mark_written(to, bytes);
    if (from_device && !to_device)
      if (const std::size_t n = never_written(from, bytes))
        report("download of bytes that nobody wrote", std::to_string(n) + " of " + std::to_string(bytes) + ", " + place(from));
  });
}
cudaError_t cudaMemcpy(void* to, const void* from, std::size_t bytes, cudaMemcpyKind kind) {
  if (const cudaError_t e = enter("cudaMemcpy", kNotWhileCapturing)) return e;
  count_wait();
  return cudaMemcpyAsync(to, from, bytes, kind, nullptr);
}
cudaError_t cudaMemsetAsync(void* p, int value, std::size_t bytes, cudaStream_t stream) {
  if (const cudaError_t e = enter("cudaMemsetAsync")) return e;
  if (bytes == 0) return cudaSuccess;
  if (!one_buffer(p, bytes)) return wrong(cudaErrorInvalidValue, "memset outside a buffer");
  return submit(stream, [=] {
    std::memset(p, value, bytes);
    mark_written(p, bytes);
  });
}

// --- streams and graphs ---

cudaError_t cudaStreamCreateWithFlags(cudaStream_t* s, unsigned) {
  *s = nullptr;
  if (const cudaError_t e = enter("cudaStreamCreateWithFlags", kNotWhileCapturing)) return e;
  *s = reinterpret_cast<cudaStream_t>(new Recording);
  return cudaSuccess;
}
cudaError_t cudaStreamDestroy(cudaStream_t s) {
  delete reinterpret_cast<Recording*>(s);
  return enter("cudaStreamDestroy");
}
cudaError_t cudaStreamSynchronize(cudaStream_t) {
  count_wait();
  return enter("cudaStreamSynchronize", kNotWhileCapturing);
}
cudaError_t cudaDeviceSynchronize() {
  count_wait();
  return enter("cudaDeviceSynchronize", kNotWhileCapturing);
}
cudaError_t cudaStreamBeginCapture(cudaStream_t s, cudaStreamCaptureMode) {
  if (const cudaError_t e = enter("cudaStreamBeginCapture", kNotWhileCapturing)) return e;
  if (!s) return wrong(cudaErrorStreamCaptureUnsupported, "capture of the default stream");
  recording = reinterpret_cast<Recording*>(s);
  recording->on = true, recording->work.clear();
  return cudaSuccess;
}
cudaError_t cudaStreamEndCapture(cudaStream_t s, cudaGraph_t* graph) {
  *graph = nullptr;
  auto* r = reinterpret_cast<Recording*>(s);
  if (!r || !r->on) return wrong(cudaErrorIllegalState, "end of a capture that did not begin");
  r->on = false, recording = nullptr;
  if (const cudaError_t e = enter("cudaStreamEndCapture")) return e;
  *graph = reinterpret_cast<cudaGraph_t>(new std::vector<Work>(std::move(r->work)));
  return cudaSuccess;
}
cudaError_t cudaGraphInstantiate(cudaGraphExec_t* exec, cudaGraph_t graph, unsigned long long) {
  *exec = nullptr;
  if (const cudaError_t e = enter("cudaGraphInstantiate", kNotWhileCapturing)) return e;
  *exec = reinterpret_cast<cudaGraphExec_t>(new std::vector<Work>(*reinterpret_cast<std::vector<Work>*>(graph)));
  return cudaSuccess;
}
cudaError_t cudaGraphDestroy(cudaGraph_t graph) {
  delete reinterpret_cast<std::vector<Work>*>(graph);
  return enter("cudaGraphDestroy");
}
cudaError_t cudaGraphExecDestroy(cudaGraphExec_t exec) {
  delete reinterpret_cast<std::vector<Work>*>(exec);
  return enter("cudaGraphExecDestroy");
}
cudaError_t cudaGraphLaunch(cudaGraphExec_t exec, cudaStream_t) {
  if (const cudaError_t e = enter("cudaGraphLaunch", kNotWhileCapturing)) return e;
  for (Work& w : *reinterpret_cast<std::vector<Work>*>(exec)) w();
  return cudaSuccess;
}

}  // extern "C"
