#pragma once
// The one layer that knows which device runs the kernels. The same engine sources are compiled by g++ (CPU threads, oneTBB)
// and by nvcc (CUDA); everything outside this folder calls what is declared here and has no backend #if.
//
// Rules that keep one source honest:
//   * a kernel is a lambda `[=] MORTISE_HD(Index i) { ... }` that captures views and numbers by value (never `this`);
//   * kernels write disjoint memory; sums go through sum/env_sum/segment_sum, whose order never depends on the device,
//     the thread count or the number of environments;
//   * memory of a Buffer is touched on the host only through upload/download.
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "base/types.h"
#include "device/device_info.h"

namespace mortise::device {

// A range of device memory, passed by value into kernels.
template <class T>
struct View {
  T* p = nullptr;
  Index n = 0;
  MORTISE_HD T& operator[](Index i) const { return p[i]; }
  MORTISE_HD T* data() const { return p; }
  MORTISE_HD Index size() const { return n; }
  MORTISE_HD operator View<const T>() const { return {p, n}; }
};

// What every launch is counted under; `run.json` prints the table.
struct LaunchCount {
  std::string name;
  long long launches = 0;
};
void count_launch(std::string_view name);
const std::string& last_launch();  // empty before the first
std::vector<LaunchCount> launch_counts();
void reset_launch_counts();

// Copies between host and device since the start; backends count every one.
Transfers transfers();
// Those to the host, for each of which it waits, by who wanted them.
using Waits = std::map<std::string, long long, std::less<>>;
const Waits& waits();

// Bytes held by all Buffers now, and the most held at once.
struct MemoryUse {
  std::size_t now = 0, peak = 0;
};
MemoryUse memory_use();

// What this build can run on: the CPU, or the GPUs of this machine; where there are none, *why_none says why.
std::vector<DeviceInfo> devices(std::string* why_none = nullptr);
// What kernels were compiled for, e.g. "x86-64" or "sm_90".
std::vector<std::string> architectures();

// Where Buffers live and kernels run from now on; to be called before the first Buffer. CPU build: number 0, and `debug`
// keeps Buffers out of reach of the host (trap.h). CUDA build: the number of a GPU. Throws Error(Exit::device).
void select(int number, bool debug);

// Number of CPU threads that kernels use; 0 = what the affinity mask or SLURM_CPUS_PER_TASK allows.
void set_threads(int n);
int threads();

void* allocate(std::size_t bytes);  // throws Error(Exit::device) when memory runs out
void release(void* p, std::size_t bytes);
void copy_in(void* device, const void* host, std::size_t bytes);
void copy_out(void* host, const void* device, std::size_t bytes, std::string_view who = "download");
void copy(void* to, const void* from, std::size_t bytes);  // device to device
void clear(void* p, std::size_t bytes);
void forget(void* p, std::size_t bytes);  // values become undefined; the debug device makes them NaN

// Owns device memory of n values of a trivially copyable T.
template <class T>
class Buffer {
 public:
  Buffer() = default;
  explicit Buffer(Index n) { resize(n); }
  explicit Buffer(const std::vector<T>& host) { upload(host); }
  Buffer(Buffer&& o) noexcept { swap(o); }
  Buffer& operator=(Buffer&& o) noexcept {
    swap(o);
    return *this;
  }
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;
  ~Buffer() {
    if (p_) release(p_, capacity_ * sizeof(T));
  }

  // New values are undefined; old values survive only when the capacity suffices.
  void resize(Index n) {
    if (static_cast<std::size_t>(n) > capacity_) {
      if (p_) release(p_, capacity_ * sizeof(T));
      p_ = nullptr, capacity_ = 0;
      p_ = static_cast<T*>(allocate(static_cast<std::size_t>(n) * sizeof(T)));
      capacity_ = static_cast<std::size_t>(n);
    } else if (n > n_) {
      forget(p_ + n_, static_cast<std::size_t>(n - n_) * sizeof(T));
    }
    n_ = n;
  }
  void zero() {
    if (n_) clear(p_, n_ * sizeof(T));
  }
  void upload(const std::vector<T>& host) {
    resize(static_cast<Index>(host.size()));
    if (n_) copy_in(p_, host.data(), n_ * sizeof(T));
  }
  std::vector<T> download() const {
    std::vector<T> host(n_);
    if (n_) copy_out(host.data(), p_, n_ * sizeof(T));
    return host;
  }
  void copy_from(const Buffer& o) {
    resize(o.n_);
    if (n_) copy(p_, o.p_, n_ * sizeof(T));
  }
  Index size() const { return n_; }
  bool empty() const { return n_ == 0; }
  std::size_t bytes() const { return capacity_ * sizeof(T); }
  View<T> view() { return {p_, n_}; }
  View<const T> view() const { return {p_, n_}; }
  void swap(Buffer& o) noexcept { std::swap(p_, o.p_), std::swap(n_, o.n_), std::swap(capacity_, o.capacity_); }

 private:
  T* p_ = nullptr;
  Index n_ = 0;
  std::size_t capacity_ = 0;
};

// Sums of fixed shape: chunks of this many terms, then chunks of chunks. The same on every device.
inline constexpr Index kChunk = 64;

}  // namespace mortise::device

#ifdef __CUDACC__
#include "device/cuda.h"
#else
#include "device/cpu.h"
#endif
#include "device/ranges.h"

namespace mortise::device {

// out[e] <- combine(out[e], f(i) over offset[e] <= i < offset[e+1]) for every environment e: chunks of kChunk terms, chunks of
// chunks, until one value per environment is left (reduce.h).
struct Add {
  MORTISE_HD static double start() { return 0; }
  MORTISE_HD double operator()(double a, double b) const { return a + b; }
  MORTISE_HD void take(double& sum, double b) const { sum += b; }
};
struct Larger {
  MORTISE_HD static double start() { return -std::numeric_limits<double>::infinity(); }
  MORTISE_HD double operator()(double a, double b) const { return b > a || b != b ? b : a; }  // a NaN wins, so that it is seen
  MORTISE_HD void take(double& most, double b) const { most = (*this)(most, b); }
};
struct Smaller {
  MORTISE_HD static double start() { return std::numeric_limits<double>::infinity(); }
  MORTISE_HD double operator()(double a, double b) const { return b < a || b != b ? b : a; }
  MORTISE_HD void take(double& least, double b) const { least = (*this)(least, b); }
};
// Of vectors and matrices of fixed size.
template <class V>
struct AddUp {
  MORTISE_HD static V start() { return V::Zero(); }
  MORTISE_HD void take(V& sum, const V& b) const { sum += b; }
};
class Fetch;  // fetch.h
struct EnvValues;
template <class Combine, class F>
void env_reduce(const char* name, const Ranges& over, F f, EnvValues out);
template <class Combine, class F>
void env_reduce(const char* name, const Ranges& over, F f, std::vector<double>& out);

// Sum of f(i), i < n, in the fixed order.
template <class F>
double sum(const char* name, Index n, F f) {
  std::vector<double> out{0.0};
  env_reduce<Add>(name, std::vector<Index>{0, n}, f, out);
  return out[0];
}
// Largest f(i), i < n; `least` when n is 0.
template <class F>
double max(const char* name, Index n, double least, F f) {
  std::vector<double> out{least};
  env_reduce<Larger>(name, std::vector<Index>{0, n}, f, out);
  return out[0];
}
// Adds the sum of f(i) over the part of environment e to out[e], each environment in its own fixed order, so that the result of environment e does
// not depend on its neighbours; of those that are not among `over`, which may be the offsets of all, nothing is added. `out`: std::vector<double>&,
// changed here, or EnvValues, changed by the fetch.
template <class F, class Out>
void env_sum(const char* name, const Ranges& over, F f, Out&& out) {
  env_reduce<Add>(name, over, f, out);
}
// Raises out[e] to the largest f(i) of environment e, or lowers it to the smallest.
template <class F, class Out>
void env_max(const char* name, const Ranges& over, F f, Out&& out) {
  env_reduce<Larger>(name, over, f, out);
}
template <class F, class Out>
void env_min(const char* name, const Ranges& over, F f, Out&& out) {
  env_reduce<Smaller>(name, over, f, out);
}

// Exclusive prefix sum in place of n counts stored in a buffer of n+1 values; the last becomes the total.
void scan(Buffer<Index>& counts);
Index exclusive_scan(Buffer<Index>& counts);  // returns the total too

// Stable ascending sort of keys, carrying values along. A GPU's time goes by the number of bits, which callers may know: only the lower `bits`
// of a key are looked at.
void sort_pairs(Buffer<std::uint64_t>& keys, Buffer<Index>& values, int bits = 64);

// Start of every run of equal keys below `limit` in a sorted buffer, followed by the end of the last: run k is [start[k], start[k+1]).
inline constexpr std::uint64_t kNoKey = ~0ull;
void run_starts(const Buffer<std::uint64_t>& sorted_keys, Buffer<Index>& start, std::uint64_t limit = kNoKey);

// out[k] = sum over j in [start[k], start[k+1]) of term(j), in order.
template <class T, class F>
void segment_sum(const char* name, const Buffer<Index>& start, F term, Buffer<T>& out) {
  const Index n = start.size() - 1;
  out.resize(n);
  View<const Index> s = start.view();
  View<T> o = out.view();
  parallel_for(name, n, [=] MORTISE_HD(Index k) {
    T t = term(s[k]);
    for (Index j = s[k] + 1; j < s[k + 1]; ++j) t += term(j);
    o[k] = t;
  });
}

}  // namespace mortise::device

#include "device/fetch.h"
#include "device/reduce.h"
