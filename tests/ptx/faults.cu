// Planted faults: each kind has to be reported, in checked mode and with either order of the threads. Every case runs in a process of its own
// (the test program again), which has to end with exit code 70 and the words; the sound ones without either.
#include <gtest/gtest.h>

#include <cstdlib>
#include <functional>
#include <iostream>
#include <string>
#include <vector>

namespace {

template <class T>
T* buffer(std::size_t n) {
  void* p = nullptr;
  cudaMallocAsync(&p, n * sizeof(T), nullptr);
  return static_cast<T*>(p);
}
template <class T>
T* filled(std::size_t n) {
  T* p = buffer<T>(n);
  cudaMemsetAsync(p, 0, n * sizeof(T));
  return p;
}

__global__ void write_at(double* p, int n) {
  if (static_cast<int>(threadIdx.x) < n) p[threadIdx.x] = 1;
}
__global__ void write_bytes(unsigned char* p, int n) {
  if (static_cast<int>(threadIdx.x) < n) p[threadIdx.x] = 1;
}
__global__ void read_at(const double* p, double* out, int k) { out[threadIdx.x] = p[k + static_cast<int>(threadIdx.x)]; }
__global__ void misaligned(const char* p, int* out) { out[threadIdx.x] = *reinterpret_cast<const int*>(p + 2 + 4 * threadIdx.x); }
__global__ void through_pointer(double** p) { **p = 1; }
__global__ void neighbour(int* p) { p[threadIdx.x + 1] = p[threadIdx.x]; }
__global__ void all_to_one(int* p) { p[0] = static_cast<int>(threadIdx.x); }
__global__ void add_all(int* p) { atomicAdd(p, 1); }
__global__ void beyond_shared(int* out, int k) {
  __shared__ int s[32];
  s[threadIdx.x + k] = 1;
  __syncthreads();
  out[threadIdx.x] = s[threadIdx.x];
}
__global__ void unwritten_local(double* out, int k) {
  double a[16];
  for (int i = 0; i < k; ++i) a[i * 3 % 16] = i;
  out[threadIdx.x] = a[(k + 5) % 16];
}
__global__ void wrong_mask(int* out) {
  if (threadIdx.x < 8) out[threadIdx.x] = __shfl_sync(0xff00, 1, 9);
}

struct Case {
  const char* name;
  const char* words;  // none: sound
  std::function<void()> run;
};
const std::vector<Case>& cases() {
  static const std::vector<Case> all{
      {"sound", "",
       [] {
         double* p = buffer<double>(10);
         write_at<<<1, 32>>>(p, 10);
         read_at<<<1, 10>>>(p, filled<double>(10), 0);
         add_all<<<2, 32>>>(filled<int>(1));
         write_bytes<<<1, 32>>>(buffer<unsigned char>(13), 13);
         std::vector<double> host(10);
         cudaMemcpy(host.data(), p, 80, cudaMemcpyDeviceToHost);
       }},
      {"write_outside", "access outside a buffer \\(writes\\) in .*write_at.*: thread 10, byte 80 of a buffer of 80 bytes",
       [] { write_at<<<1, 32>>>(buffer<double>(10), 11); }},
      {"byte_outside", "access outside a buffer \\(writes\\) in .*write_bytes", [] { write_bytes<<<1, 32>>>(buffer<unsigned char>(13), 14); }},
      {"read_before", "access outside a buffer \\(reads\\)", [] { read_at<<<1, 4>>>(filled<double>(10), filled<double>(10), -1); }},
      {"released", "access outside a buffer",
       [] {
         double* p = buffer<double>(10);
         cudaFreeAsync(p, nullptr);
         write_at<<<1, 32>>>(p, 10);
       }},
      {"never_written", "value that nobody wrote \\(reads\\) in .*read_at", [] { read_at<<<1, 4>>>(buffer<double>(10), filled<double>(10), 0); }},
      {"misaligned", "misaligned access \\(reads\\)", [] { misaligned<<<1, 4>>>(filled<char>(64), filled<int>(4)); }},
      {"host_pointer", "access to host memory \\(writes\\)",
       [] {
         static double host = 0;
         static double* const address = &host;
         double** p = buffer<double*>(1);
         cudaMemcpy(p, &address, sizeof address, cudaMemcpyHostToDevice);
         through_pointer<<<1, 1>>>(p);
       }},
      {"host_stack", "access to host memory \\(writes\\)",
       [] {
         double host = 0;
         double* const address = &host;
         double** p = buffer<double*>(1);
         cudaMemcpy(p, &address, sizeof address, cudaMemcpyHostToDevice);
         through_pointer<<<1, 1>>>(p);
       }},
      {"read_write_race", "race with a thread that (wrote|read)", [] { neighbour<<<1, 8>>>(filled<int>(9)); }},
      {"write_write_race", "race with a thread that wrote \\(writes\\) in .*all_to_one", [] { all_to_one<<<1, 2>>>(filled<int>(1)); }},
      {"shared", "access outside shared memory", [] { beyond_shared<<<1, 32>>>(filled<int>(32), 1); }},
      {"mask", "a lane outside the mask takes part", [] { wrong_mask<<<1, 16>>>(filled<int>(32)); }},
      {"download", "download of bytes that nobody wrote: 80 of 80",
       [] {
         std::vector<double> host(10);
         cudaMemcpy(host.data(), buffer<double>(10), 80, cudaMemcpyDeviceToHost);
       }},
      {"copy_outside", "copy outside a buffer",
       [] {
         std::vector<double> host(11);
         cudaMemcpy(filled<double>(10), host.data(), 88, cudaMemcpyHostToDevice);
       }},
      {"copy_direction", "copy in a direction that its pointers do not have",
       [] {
         std::vector<double> host(11);
         cudaMemcpy(host.data(), host.data() + 1, 8, cudaMemcpyHostToDevice);
       }},
      {"capture", "cudaMallocAsync while a stream is being captured",
       [] {
         cudaStream_t s;
         cudaStreamCreateWithFlags(&s, cudaStreamNonBlocking);
         cudaStreamBeginCapture(s, cudaStreamCaptureModeThreadLocal);
         buffer<int>(1);
       }},
      {"other_stream", "work for the default stream while another is being captured",
       [] {
         int* p = filled<int>(1);
         cudaStream_t s;
         cudaStreamCreateWithFlags(&s, cudaStreamNonBlocking);
         cudaStreamBeginCapture(s, cudaStreamCaptureModeThreadLocal);
         add_all<<<1, 1>>>(p);
       }},
      {"empty_launch", "empty launch of .*add_all", [] { add_all<<<0, 1>>>(filled<int>(1)); }},
      {"large_block", "too large a launch of .*add_all", [] { add_all<<<1, 2048>>>(filled<int>(1)); }},
      {"twice_released", "release of what is no buffer",
       [] {
         int* p = buffer<int>(1);
         cudaFreeAsync(p, nullptr), cudaFreeAsync(p, nullptr);
       }},
  };
  return all;
}

class Fault : public testing::TestWithParam<std::tuple<int, const char*>> {};

TEST_P(Fault, IsReported) {
  const auto [k, order] = GetParam();
  const Case& c = cases()[static_cast<std::size_t>(k)];
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  setenv("MORTISE_PTX_CHECK", "1", 1);
  setenv("MORTISE_PTX_ORDER", order, 1);
  const auto child = [&] {
    c.run();
    std::exit(0);
  };
  if (*c.words)
    EXPECT_EXIT(child(), testing::ExitedWithCode(70), c.words);
  else
    EXPECT_EXIT(child(), testing::ExitedWithCode(0), "^$");
}
INSTANTIATE_TEST_SUITE_P(Both, Fault, testing::Combine(testing::Range(0, static_cast<int>(cases().size())), testing::Values("forwards", "backwards")),
                         [](const auto& info) {
                           return std::string(cases()[static_cast<std::size_t>(std::get<0>(info.param))].name) + "_" + std::get<1>(info.param);
                         });

// Local memory is filled with NaN, so that what was never written shows in the result.
TEST(UnwrittenLocal, IsNan) {
  if (!std::getenv("MORTISE_PTX_CHECK")) GTEST_SKIP() << "checked mode only";
  double* p = filled<double>(1);
  unwritten_local<<<1, 1>>>(p, 2);
  double host = 0;
  cudaMemcpy(&host, p, 8, cudaMemcpyDeviceToHost);
  EXPECT_NE(host, host);
}

// Errors that a test plans (MORTISE_PTX_FAIL) come at their call; a kernel's stay.
TEST(PlannedError, ComesOnceOrStays) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto codes = [] {
    void* p = nullptr;
    std::string out;
    for (int k = 0; k < 4; ++k) out += std::to_string(cudaMallocAsync(&p, 8, nullptr)) + " ";
    std::cerr << out;
    std::exit(0);
  };
  setenv("MORTISE_PTX_FAIL", "cudaMallocAsync:2:2", 1);
  EXPECT_EXIT(codes(), testing::ExitedWithCode(0), "0 2 0 0");
  setenv("MORTISE_PTX_FAIL", "cudaMallocAsync:3:700", 1);
  EXPECT_EXIT(codes(), testing::ExitedWithCode(0), "0 0 700 700");
  unsetenv("MORTISE_PTX_FAIL");
}

}  // namespace
