#pragma once
// CUDA backend: a launch is a grid of one thread per index, or, where terms are added up, of one warp per sum.
#include <cuda_runtime.h>

namespace mortise::device {

// Kernels run on a GPU.
inline constexpr bool kHostThreads = false;

void check(cudaError_t status, const char* what);  // throws Error(Exit::device) naming the launch

// Where launches go: the default stream, except while a Graph records.
inline cudaStream_t launch_stream = nullptr;

inline constexpr Index kWarps = 4;  // of a block

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

// The lanes of a warp find terms side by side, the first of them adds them in their order: sums have the bits that one thread would give them, and
// what takes time is to find the terms.
template <class T, class Segment, class Term, class Combine, class Put>
__global__ void fold_kernel(Index n, Segment segment, Term term, Combine combine, Put put) {
  constexpr Index kRoom = 3072 / sizeof(T) >= 128  ? 128
                          : 3072 / sizeof(T) >= 64 ? 64
                                                   : 32;  // terms of a warp at once: 12 kB of shared memory per block
  __shared__ __align__(16) unsigned char memory[kWarps * kRoom * sizeof(T)];
  const auto warp = static_cast<Index>(threadIdx.x) / 32, lane = static_cast<Index>(threadIdx.x) % 32;
  const Index k = static_cast<Index>(blockIdx.x) * kWarps + warp;
  if (k >= n) return;
  T* const found = reinterpret_cast<T*>(memory) + warp * kRoom;
  Index from = 0, to = 0;
  segment(k, from, to);
  T sum = combine.start();
  for (; from < to; from += kRoom) {
    const Index here = to - from < kRoom ? to - from : kRoom;
    for (Index j = lane; j < here; j += 32) found[j] = term(from + j);
    __syncwarp();
    if (lane == 0)
      for (Index j = 0; j < here; ++j) combine.take(sum, found[j]);
    __syncwarp();
  }
  if (lane == 0) put(k, sum);
}

// See cpu.h.
template <class Segment, class Term, class Combine, class Put>
void fold(const char* name, Index n, Segment segment, Term term, Combine combine, Put put) {
  if (n <= 0) return;
  count_launch(name);
  using T = decltype(combine.start());
  fold_kernel<T><<<(n - 1) / kWarps + 1, 32 * kWarps, 0, launch_stream>>>(n, segment, term, combine, put);
  check(cudaGetLastError(), name);
}

}  // namespace mortise::device
