// What the debug device catches. Each case runs in a process of its own, because a trap ends the program.
#include "device/trap.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <functional>
#include <iostream>

#include "base/error.h"
#include "device/device.h"

#ifndef __CUDACC__  // a GPU needs no imitation
using namespace mortise;
using namespace mortise::device;

namespace {

void debug() {
  set_threads(2);
  select(0, true);
}

// Runs the work on the debug device and ends with its error code, 0 without one.
[[noreturn]] void run(const std::function<void()>& work) {
  try {
    debug();
    work();
  } catch (const Error& e) {
    std::cerr << e.what() << "\n";
    std::exit(static_cast<int>(e.code()));
  }
  std::exit(0);
}

class Trap : public testing::Test {
 protected:
  void SetUp() override { GTEST_FLAG_SET(death_test_style, "threadsafe"); }
};
constexpr int kInternal = static_cast<int>(Exit::internal);

}  // namespace

TEST_F(Trap, KernelsCopiesSortsAndSumsMayTouchDeviceMemory) {
  EXPECT_EXIT(run([] {
                Buffer<double> a(std::vector<double>(1000, 2.0)), b;
                b.copy_from(a);
                const View<double> v = b.view();
                parallel_for("twice", v.n, [=](Index i) { v[i] *= 2; });
                if (sum("sum", v.n, [=](Index i) { return v[i]; }) != 4000) std::exit(9);
                Buffer<std::uint64_t> keys(std::vector<std::uint64_t>{3, 1, 3});
                Buffer<Index> values(std::vector<Index>{0, 1, 2}), start;
                sort_pairs(keys, values);
                run_starts(keys, start);
                if (values.download() != std::vector<Index>{1, 0, 2} || start.download() != std::vector<Index>{0, 1, 3}) std::exit(9);
                if (exclusive_scan(start) != 1) std::exit(9);
              }),
              testing::ExitedWithCode(0), "");
}

TEST_F(Trap, HostReadOfDeviceMemoryEndsTheProgram) {
  EXPECT_EXIT(run([] {
                const Buffer<double> a(std::vector<double>(10, 1.0));
                volatile double x = a.view()[3];
                (void)x;
              }),
              testing::ExitedWithCode(kInternal),
              "host code reads from device memory \\(byte 24 of a buffer of 80 bytes\\); last kernel or copy: 'upload'");
}

TEST_F(Trap, HostWriteToDeviceMemoryEndsTheProgram) {
  EXPECT_EXIT(run([] {
                Buffer<double> a(10);
                parallel_for("fill", 10, [v = a.view()](Index i) { v[i] = 0; });
                a.view()[0] = 1;
              }),
              testing::ExitedWithCode(kInternal), "host code writes to device memory .* last kernel or copy: 'fill'");
}

TEST_F(Trap, KernelsMayNotCaptureHostMemory) {
  EXPECT_EXIT(run([] {
                const std::vector<double> host(10, 1.0);
                Buffer<double> a(10);
                parallel_for("by value", 10, [v = a.view(), host](Index i) { v[i] = host[i]; });
              }),
              testing::ExitedWithCode(kInternal), "kernel 'by value' captures an address of host memory");
  EXPECT_EXIT(run([] {
                double here = 1;
                Buffer<double> a(10);
                parallel_for("by reference", 10, [v = a.view(), &here](Index i) { v[i] = here; });
              }),
              testing::ExitedWithCode(kInternal), "kernel 'by reference' captures an address of host memory");
}

TEST_F(Trap, NumbersAreNoAddresses) {
  EXPECT_EXIT(run([] {
                Buffer<double> a(std::vector<double>(10, 1.0));
                const double x = 1e-300, y = -3.7e12, z = std::nan("");
                const Index m = 0x7fffffff, n = -1;
                const std::uint64_t k = ~0ull;
                parallel_for("numbers", 10, [=, v = a.view()](Index i) { v[i] += x + y + z + m + n + static_cast<double>(k); });
              }),
              testing::ExitedWithCode(0), "");
}

// The second of two integers side by side can be the upper half of the addresses of buffers.
TEST_F(Trap, PairsOfIntegersAreNoAddresses) {
  EXPECT_EXIT(run([] {
                Buffer<double> a(std::vector<double>(10, 1.0)), released(1 << 20);
                released = Buffer<double>();
                const auto upper = static_cast<Index>(reinterpret_cast<std::uint64_t>(a.view().p) >> 32);
                for (const Index lower : {4, 30000, 5000000}) {
                  struct Pair {
                    Index lower, upper;
                  } pair{lower, upper};
                  parallel_for("pairs", 10, [pair, v = a.view()](Index i) { v[i] += pair.lower + pair.upper; });
                }
              }),
              testing::ExitedWithCode(0), "");
}

TEST_F(Trap, ViewsOfReleasedBuffersAreStale) {
  EXPECT_EXIT(run([] {
                Buffer<double> a(10);
                const View<double> old = a.view();
                a.resize(1000);
                parallel_for("stale", 10, [=](Index i) { old[i] = 0; });
              }),
              testing::ExitedWithCode(kInternal), "kernel 'stale' captures a stale address: byte 0 of a released buffer of 80 bytes");
}

TEST_F(Trap, FreshValuesAreNan) {
  EXPECT_EXIT(run([] {
                Buffer<double> a(std::vector<double>(10, 1.0));
                a.resize(4);
                a.resize(8);
                const std::vector<double> v = a.download();
                if (v[3] != 1 || !std::isnan(v[4]) || !std::isnan(Buffer<double>(1).download()[0])) std::exit(9);
              }),
              testing::ExitedWithCode(0), "");
}

TEST_F(Trap, WritesBehindTheEndShowAtTheLatestOnRelease) {
  EXPECT_EXIT(run([] {
                Buffer<double> a(10);
                parallel_for("too far", 11, [v = a.view()](Index i) { v[i] = 0; });
              }),
              testing::ExitedWithCode(kInternal), "a kernel wrote behind the end of a buffer of 80 bytes");
}

// An address that hides in device memory is no captured one; what it does shows later.
TEST_F(Trap, WritesIntoReleasedMemoryShowWhenItIsUsedAgain) {
  EXPECT_EXIT(run([] {
                Buffer<double> a(10);
                const Buffer<double*> hidden(std::vector<double*>{a.view().p});
                a = Buffer<double>(20);  // the old one is gone at the end of this statement
                parallel_for("late", 1, [h = hidden.view()](Index i) { *h[i] = 0; });
                for (int k = 0; k < 8; ++k) Buffer<double>(1 << 20);
              }),
              testing::ExitedWithCode(kInternal), "a kernel wrote into a released buffer of 80 bytes");
}

TEST_F(Trap, CopiesStayWithinOneBuffer) {
  EXPECT_EXIT(run([] {
                Buffer<double> a(10);
                std::vector<double> host(20);
                copy_out(host.data(), a.view().p, 20 * sizeof(double));
              }),
              testing::ExitedWithCode(kInternal), "download of 160 bytes at byte 0 of a buffer of 80 bytes");
  EXPECT_EXIT(run([] {
                std::vector<double> one(10), two(10);
                copy(one.data(), two.data(), 80);
              }),
              testing::ExitedWithCode(kInternal), "copy of 80 bytes at host memory, where device memory is meant");
}

TEST_F(Trap, MemoryIsLimited) {
  setenv("MORTISE_DEBUG_MEMORY_MIB", "10", 1);  // the child starts with it
  EXPECT_EXIT(run([] {
                const Buffer<double> a(1 << 20), b(1 << 20);  // 8 MiB each
              }),
              testing::ExitedWithCode(static_cast<int>(Exit::device)), "out of device memory: 8 MiB more asked for, 8 MiB in use of 10 MiB");
  EXPECT_EXIT(run([] {
                const Buffer<double> a(1 << 20);
                parallel_for("fill", 10, [v = a.view()](Index) {});
                const Buffer<double> b(1 << 20);
              }),
              testing::ExitedWithCode(static_cast<int>(Exit::device)), "8 MiB more asked for \\(after 'fill'\\), 8 MiB in use of 10 MiB");
  unsetenv("MORTISE_DEBUG_MEMORY_MIB");
}
#endif
