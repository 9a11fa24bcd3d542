#pragma once
// CUDA backend: a launch is a grid of one thread per index.
#include <cuda_runtime.h>

namespace mortise::device {

// Kernels run on a GPU.
inline constexpr bool kHostThreads = false;

void check(cudaError_t status, const char* what);  // throws Error(Exit::device) naming the launch

// Where launches go: the default stream, except while a Graph records.
inline cudaStream_t launch_stream = nullptr;

template <class F>
__global__ void run_kernel(Index n, F f) {
  const Index i = static_cast<Index>(blockIdx.x) * static_cast<Index>(blockDim.x) + static_cast<Index>(threadIdx.x);
  if (i < n) f(i);
}

template <class F>
void parallel_for(const char* name, Index n, F f) {
  if (n <= 0) return;
  count_launch(name);
  constexpr int kBlock = 128;
  run_kernel<<<(n - 1) / kBlock + 1, kBlock, 0, launch_stream>>>(n, f);
  check(cudaGetLastError(), name);
}

}  // namespace mortise::device
