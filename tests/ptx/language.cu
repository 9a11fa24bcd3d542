// What instructions do together: memory spaces, calls, loops and tables of jumps, and threads that meet; against the same on the host.
#include <gtest/gtest.h>

#include <cstdint>
#include <numeric>
#include <vector>

namespace {

template <class T>
struct OnDevice {
  T* p = nullptr;
  std::size_t n;
  explicit OnDevice(const std::vector<T>& host) : n(host.size()) {
    EXPECT_EQ(cudaMallocAsync(reinterpret_cast<void**>(&p), n * sizeof(T), nullptr), cudaSuccess);
    EXPECT_EQ(cudaMemcpy(p, host.data(), n * sizeof(T), cudaMemcpyHostToDevice), cudaSuccess);
  }
  ~OnDevice() { cudaFreeAsync(p, nullptr); }
  std::vector<T> host() const {
    std::vector<T> out(n);
    EXPECT_EQ(cudaMemcpy(out.data(), p, n * sizeof(T), cudaMemcpyDeviceToHost), cudaSuccess);
    return out;
  }
};
std::vector<int> count(int n) {
  std::vector<int> out(n);
  std::iota(out.begin(), out.end(), 0);
  return out;
}

struct Pair {
  double x;
  int k;
  unsigned char tag[4];
};
__host__ __device__ __noinline__ Pair shuffled(Pair p, int by, const double* table) {
  p.x += table[by & 3];
  for (int i = 0; i < 4; ++i) p.tag[i] = static_cast<unsigned char>(p.tag[i] * 3 + by);
  p.k -= by;
  return p;
}
__host__ __device__ int chosen(int k, int x) {
  switch (k) {
    case 0:
      return x * 3;
    case 1:
      return x ^ 0x55;
    case 2:
      return x - 100;
    case 3:
      return x * x;
    case 4:
      return ~x;
    case 5:
      return x / 7;
    case 6:
      return x << 3;
    default:
      return 1;
  }
}
__host__ __device__ double work(int i, const double* table) {
  double local[24];  // indexed at run time: stays in local memory
  for (int k = 0; k < 24; ++k) local[(k * 5) % 24] = k * 0.25 + i;
  Pair p{local[i % 24], i, {1, 2, 3, 4}};
  for (int k = 0; k < i % 5; ++k) p = shuffled(p, k + i, table);
  return p.x + p.k + p.tag[i & 3] + chosen(i % 9, i) + local[(i * 7) % 24];
}
__global__ void run_work(double* out, const double* table, int n) {
  const int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (i < n) out[i] = work(i, table);
}
TEST(Language, LocalArraysCallsLoopsAndTables) {
  const std::vector<double> table{0.5, -2, 8, 1e-3};
  OnDevice<double> t(table), out(std::vector<double>(1000));
  run_work<<<8, 128>>>(out.p, t.p, 1000);
  const std::vector<double> got = out.host();
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(got[i], work(i, table.data())) << i;
}

__global__ void move_vectors(const double2* d, const uint4* w, const uchar4* b, double2* d_out, uint4* w_out, unsigned char* b_out, short* s_out) {
  const unsigned i = threadIdx.x;
  d_out[i] = {d[i].y, d[i].x};
  w_out[i] = {w[i].w, w[i].z, w[i].y, w[i].x};
  b_out[i] = static_cast<unsigned char>(b[i].x + b[i].w);
  s_out[i] = static_cast<short>(b[i].y - 300);
}
TEST(Language, VectorsAndSmallTypes) {
  std::vector<double2> d;
  std::vector<uint4> w;
  std::vector<uchar4> b;
  for (unsigned i = 0; i < 64; ++i)
    d.push_back({i + 0.5, -1.0 * i}), w.push_back({i, i + 1, i + 2, i + 3}),
        b.push_back({static_cast<unsigned char>(i), 7, 0, static_cast<unsigned char>(200 + i)});
  OnDevice<double2> dd(d), dr(d);
  OnDevice<uint4> wd(w), wr(w);
  OnDevice<uchar4> bd(b);
  OnDevice<unsigned char> br(std::vector<unsigned char>(64));
  OnDevice<short> sr(std::vector<short>(64));
  move_vectors<<<1, 64>>>(dd.p, wd.p, bd.p, dr.p, wr.p, br.p, sr.p);
  for (unsigned i = 0; i < 64; ++i) {
    EXPECT_EQ(dr.host()[i].x, d[i].y);
    EXPECT_EQ(wr.host()[i].y, w[i].z);
    EXPECT_EQ(br.host()[i], static_cast<unsigned char>(200 + 2 * i));
    EXPECT_EQ(sr.host()[i], -293);
  }
}

// A function of a block: sums through shared memory, votes and shuffles, each as the host would do it.
constexpr unsigned kAll = ~0u;
__global__ void meet(const int* in, int* out) {
  __shared__ int part[128];
  extern __shared__ int more[];
  const int i = static_cast<int>(threadIdx.x), v = in[blockIdx.x * 128 + i];
  part[i] = v, more[i] = -v;
  __syncthreads();
  int* o = out + (blockIdx.x * 128 + i) * 14;
  o[0] = part[127 - i] + more[(i + 1) % 128];
  o[1] = __syncthreads_or(v == 77) + 2 * __syncthreads_and(v < 1000) + 4 * __syncthreads_count(v % 3 == 0);
  o[2] = __shfl_up_sync(kAll, v, 3);
  o[3] = __shfl_down_sync(kAll, v, 5, 16);
  o[4] = __shfl_xor_sync(kAll, v, 9);
  o[5] = __shfl_sync(kAll, v, i * 7, 8);
  o[6] = static_cast<int>(__ballot_sync(kAll, v & 1));
  o[7] = __any_sync(kAll, v == 33) + 2 * __all_sync(kAll, v < 100);
  o[8] = static_cast<int>(__match_any_sync(kAll, v % 5));
  if (i % 32 < 16)
    o[9] = __shfl_sync(0xffff, v, 3);
  else
    o[9] = __shfl_sync(0xffff0000u, v, 20);
  __syncwarp();
  unsigned lower;
  asm("mov.u32 %0, %%lanemask_lt;" : "=r"(lower));
  o[10] = static_cast<int>(lower);
  int uniform;
  asm volatile("{ .reg .pred p, q; setp.lt.s32 p, %1, 40; vote.sync.uni.pred q, p, -1; selp.s32 %0, 1, 0, q; }" : "=r"(uniform) : "r"(v));
  o[11] = uniform;
  __nanosleep(100);
  __threadfence();
  o[12] = static_cast<int>(blockDim.x * gridDim.x);
  o[13] = atomicAdd(&part[0], 0) >= 0 ? 1 : 2;
}
TEST(Language, ThreadsThatMeet) {
  const std::vector<int> in = count(256);
  OnDevice<int> d(in), out(std::vector<int>(256 * 14));
  meet<<<2, 128, 128 * sizeof(int)>>>(d.p, out.p);
  const std::vector<int> o = out.host();
  for (int b = 0; b < 2; ++b) {
    for (int i = 0; i < 128; ++i) {
      const int v = b * 128 + i, lane = i % 32, warp = v - lane;
      const int* got = &o[v * 14];
      const auto of_warp = [&](auto each) {
        for (int l = 0; l < 32; ++l) each(l, warp + l);
      };
      EXPECT_EQ(got[0], b * 128 + 127 - i - (b * 128 + (i + 1) % 128));
      int thirds = 0;
      for (int k = 0; k < 128; ++k) thirds += (b * 128 + k) % 3 == 0;
      EXPECT_EQ(got[1], (b == 0 ? 1 : 0) + 2 + 4 * thirds);
      EXPECT_EQ(got[2], lane >= 3 ? v - 3 : v);
      EXPECT_EQ(got[3], lane % 16 + 5 < 16 ? v + 5 : v);
      EXPECT_EQ(got[4], warp + (lane ^ 9));
      EXPECT_EQ(got[5], warp + lane / 8 * 8 + (i * 7) % 8);
      EXPECT_EQ(static_cast<unsigned>(got[6]), 0xaaaaaaaau);
      EXPECT_EQ(got[7], (warp == 32 ? 1 : 0) + (warp + 31 < 100 ? 2 : 0));
      unsigned equal = 0;
      of_warp([&](int l, int w) { equal |= (w % 5 == v % 5 ? 1u : 0u) << l; });
      EXPECT_EQ(static_cast<unsigned>(got[8]), equal);
      EXPECT_EQ(got[9], warp + (lane < 16 ? 3 : 20));
      EXPECT_EQ(static_cast<unsigned>(got[10]), (1u << lane) - 1);
      EXPECT_EQ(got[11], warp == 32 ? 0 : 1);
      EXPECT_EQ(got[12], 256);
    }
  }
}

__global__ void leave_early(int* out) {
  if (threadIdx.x % 3 == 1) asm volatile("exit;");
  out[threadIdx.x] = 1;
}
TEST(Language, ThreadsMayExit) {
  OnDevice<int> out(std::vector<int>(32));
  leave_early<<<1, 32>>>(out.p);
  for (int i = 0; i < 32; ++i) EXPECT_EQ(out.host()[i], i % 3 == 1 ? 0 : 1);
}

__global__ void atomics(unsigned* n, unsigned long long* wide) {
  atomicAdd(&n[0], 1u);
  atomicMax(&n[1], threadIdx.x * 3);
  atomicMin(&n[2], 100u - threadIdx.x);
  atomicAnd(&n[3], ~(1u << (threadIdx.x % 8)));
  atomicOr(&n[4], 1u << (threadIdx.x % 8));
  atomicXor(&n[5], threadIdx.x);
  atomicCAS(&n[6], threadIdx.x, threadIdx.x + 1);
  atomicExch(&n[7], 5u);
  atomicAdd(wide, 1ull << 40);
}
TEST(Language, Atomics) {
  OnDevice<unsigned> n(std::vector<unsigned>{0, 0, 1000, 0xffff, 0, 0, 0, 0});
  OnDevice<unsigned long long> wide(std::vector<unsigned long long>{3});
  atomics<<<2, 32>>>(n.p, wide.p);
  const std::vector<unsigned> got = n.host();
  EXPECT_EQ(got[0], 64u);
  EXPECT_EQ(got[1], 93u);
  EXPECT_EQ(got[2], 69u);
  EXPECT_EQ(got[3], 0xff00u);
  EXPECT_EQ(got[4], 0xffu);
  EXPECT_EQ(got[5], 0u);
  EXPECT_GT(got[6], 0u);
  EXPECT_EQ(got[7], 5u);
  EXPECT_EQ(wide.host()[0], 3 + (64ull << 40));
}

__global__ void add_one(int* p, int n) {
  const int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (i < n) p[i] += 1;
}
TEST(Language, GraphsAreRecordedAndReplayed) {
  OnDevice<int> p(count(100));
  cudaStream_t stream;
  cudaGraph_t graph;
  cudaGraphExec_t exec;
  ASSERT_EQ(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking), cudaSuccess);
  ASSERT_EQ(cudaStreamBeginCapture(stream, cudaStreamCaptureModeThreadLocal), cudaSuccess);
  add_one<<<1, 128, 0, stream>>>(p.p, 100);
  add_one<<<1, 128, 0, stream>>>(p.p, 50);
  ASSERT_EQ(cudaStreamEndCapture(stream, &graph), cudaSuccess);
  ASSERT_EQ(cudaGraphInstantiate(&exec, graph, 0), cudaSuccess);
  EXPECT_EQ(p.host()[7], 7);  // nothing has run yet
  for (int k = 0; k < 3; ++k) cudaGraphLaunch(exec, nullptr);
  EXPECT_EQ(p.host()[7], 13);
  EXPECT_EQ(p.host()[70], 73);
  cudaGraphExecDestroy(exec), cudaGraphDestroy(graph), cudaStreamDestroy(stream);
}

}  // namespace
