#include "device/device.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "device/runs.h"

using namespace mortise;
using namespace mortise::device;

namespace {

std::vector<double> random_values(Index n) {
  std::mt19937_64 rng(7);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<double> v(n);
  for (double& x : v) x = u(rng);
  return v;
}

}  // namespace

TEST(Device, SumIsTheSameForAnyThreadCount) {
  const Buffer<double> values(random_values(100'003));
  const View<const double> v = values.view();
  std::vector<double> sums;
  for (int n : {1, 2, 3}) {
    set_threads(n);
    sums.push_back(sum("test", v.n, [=] MORTISE_HD(Index i) { return v[i]; }));
  }
  set_threads(0);
  EXPECT_EQ(sums[0], sums[1]);
  EXPECT_EQ(sums[0], sums[2]);
  long double exact = 0;
  for (double x : values.download()) exact += x;
  EXPECT_NEAR(sums[0], static_cast<double>(exact), 1e-11);
}

// However terms are found, they are added as one thread adds them: the bits say so.
TEST(Device, FoldsAddInOrder) {
  const std::vector<Index> offset{0, 0, 1, 33, 96, 1000, 1000, 1128, 9001};
  const std::vector<double> host = random_values(offset.back());
  const Buffer<double> values(host);
  const Buffer<Index> starts(offset);
  const auto n = static_cast<Index>(offset.size()) - 1;
  Buffer<double> sums(n), most(n);
  const View<const double> v = values.view();
  const View<const Index> start = starts.view();
  const View<double> s = sums.view(), m = most.view();
  const auto segment = [=] MORTISE_HD(Index k, Index & from, Index & to) { from = start[k], to = start[k + 1]; };
  const auto term = [=] MORTISE_HD(Index i) { return v[i]; };
  fold("test", n, segment, term, Add(), [=] MORTISE_HD(Index k, double sum) { s[k] = sum; });
  fold("test", n, segment, term, Larger(), [=] MORTISE_HD(Index k, double largest) { m[k] = largest; });
  const std::vector<double> got = sums.download(), largest = most.download();
  for (Index k = 0; k < n; ++k) {
    double want = 0, high = -INFINITY;
    for (Index i = offset[k]; i < offset[k + 1]; ++i) want += host[i], high = std::max(high, host[i]);
    EXPECT_EQ(got[k], want) << k;
    EXPECT_EQ(largest[k], high) << k;
  }
}

TEST(Device, EnvironmentSumDoesNotDependOnItsNeighbours) {
  const std::vector<double> one = random_values(777);
  std::vector<double> both = random_values(901);
  both.insert(both.end(), one.begin(), one.end());
  const Buffer<double> a(one), b(both);
  const View<const double> va = a.view(), vb = b.view();
  std::vector<double> alone{0}, batch{0, 0};
  env_sum(
      "test", {0, 777}, [=] MORTISE_HD(Index i) { return va[i]; }, alone);
  env_sum(
      "test", {0, 901, 901 + 777}, [=] MORTISE_HD(Index i) { return vb[i]; }, batch);
  EXPECT_EQ(alone[0], batch[1]);
}

// Kernels and sums over the parts of some environments: every element once, nothing of the others, and the bits that each has among all.
TEST(Device, EnvironmentsMayBeLeftOut) {
  const std::vector<Index> offset{0, 5, 5, 905, 910, 1700, 1701};
  const std::vector<double> host = random_values(offset.back());
  const Buffer<double> values(host);
  const View<const double> v = values.view();
  std::vector<double> all(6, 0.25);
  env_sum(
      "test", offset, [=] MORTISE_HD(Index i) { return v[i]; }, all);
  for (unsigned marks = 0; marks < 64; ++marks) {
    std::vector<std::uint8_t> whose(6);
    for (int e = 0; e < 6; ++e) whose[e] = marks >> e & 1;
    const Ranges some(offset, whose);
    Buffer<Index> times(offset.back());
    times.zero();
    const View<Index> t = times.view();
    parallel_for("test", some, [=] MORTISE_HD(Index i) { ++t[i]; });
    std::vector<double> sums(6, 0.25);
    env_sum(
        "test", some, [=] MORTISE_HD(Index i) { return v[i]; }, sums);
    const std::vector<Index> visited = times.download();
    Index elements = 0;
    for (int e = 0; e < 6; ++e) {
      EXPECT_EQ(sums[e], whose[e] ? all[e] : 0.25) << marks << " " << e;
      for (Index i = offset[e]; i < offset[e + 1]; ++i) EXPECT_EQ(visited[i], whose[e]) << marks << " " << i;
      elements += whose[e] ? offset[e + 1] - offset[e] : 0;
    }
    EXPECT_EQ(some.size(), elements);
  }
}

TEST(Device, MaxKeepsNan) {
  const Buffer<double> values(std::vector<double>{1, std::nan(""), 3});
  const View<const double> v = values.view();
  EXPECT_TRUE(std::isnan(device::max("test", 3, 0, [=] MORTISE_HD(Index i) { return v[i]; })));
}

TEST(Device, SortIsStableAndAscending) {
  std::mt19937_64 rng(3);
  std::vector<std::uint64_t> keys(100'000);  // on CPU threads: in several parts
  std::vector<Index> values(keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i) keys[i] = (rng() % 50) << 40 | rng() % 3, values[i] = static_cast<Index>(i);
  Buffer<std::uint64_t> k(keys);
  Buffer<Index> v(values);
  sort_pairs(k, v);
  const auto sk = k.download();
  const auto sv = v.download();
  for (std::size_t i = 1; i < sk.size(); ++i) {
    ASSERT_LE(sk[i - 1], sk[i]);
    if (sk[i - 1] == sk[i]) {
      ASSERT_LT(sv[i - 1], sv[i]);
    }
    ASSERT_EQ(keys[sv[i]], sk[i]);
  }
}

TEST(Device, RunsAndSegmentSums) {
  const Buffer<std::uint64_t> keys(std::vector<std::uint64_t>{2, 2, 5, 9, 9, 9});
  Buffer<Index> start;
  run_starts(keys, start);
  EXPECT_EQ(start.download(), (std::vector<Index>{0, 2, 3, 6}));
  Buffer<double> out;
  segment_sum<double>(
      "test", start, [=] MORTISE_HD(Index j) { return double(j); }, out);
  EXPECT_EQ(out.download(), (std::vector<double>{1, 2, 12}));
}

TEST(Device, RunsEndAtTheLimit) {
  const Buffer<std::uint64_t> keys(std::vector<std::uint64_t>{2, 2, 5, 9, 9, 9});
  Buffer<Index> start;
  run_starts(keys, start, 6);
  EXPECT_EQ(start.download(), (std::vector<Index>{0, 2, 3}));
  run_starts(keys, start, 1);
  EXPECT_EQ(start.download(), (std::vector<Index>{0}));
  run_starts(Buffer<std::uint64_t>(0), start);
  EXPECT_EQ(start.download(), (std::vector<Index>{0}));
}

// Nobody waits for the number of runs: places behind the last are runs without keys, and runs for which there is no room are left out.
TEST(Device, RunsMayBeFewerOrMoreThanThereIsRoomFor) {
  const Buffer<std::uint64_t> keys(std::vector<std::uint64_t>{2, 2, 5, 7, 7, 7, 9});
  Buffer<Index> place, start;
  const long long before = transfers().to_host;
  mark_runs(keys, place, 9);
  start_runs(keys, place, 5, start, 9);
  empty_runs(place, start);
  EXPECT_EQ(transfers().to_host, before);
  EXPECT_EQ(place.download().back(), 3);
  EXPECT_EQ(start.download(), (std::vector<Index>{0, 2, 3, 6, 6, 6}));
  start_runs(keys, place, 2, start, 9);
  empty_runs(place, start);
  EXPECT_EQ(start.download(), (std::vector<Index>{0, 2, 3}));
  start_runs(keys, place, 0, start, 9);
  EXPECT_EQ(start.download(), (std::vector<Index>{0}));
}

TEST(Device, FetchBringsEverythingInOneCopy) {
  const std::vector<double> host = random_values(10'000);
  const Buffer<double> values(host);
  const View<const double> v = values.view();
  Buffer<Index> counts(std::vector<Index>{3, 0, 4, 0});
  scan(counts);
  Fetch fetch;
  std::vector<double> sums(40, 1.0), all, least{2.0}, alone{1.0};
  std::vector<Index> offsets;
  std::vector<int> order;
  Index total = 0;
  const Transfers before = transfers();
  for (double& s : sums) {  // more than one launch gathers
    fetch.add(View<const double>{v.p + (&s - sums.data()), 1}, [&s, &order](const std::vector<double>& x) { s += x[0], order.push_back(1); });
  }
  env_min(
      "test", {0, v.n}, [=] MORTISE_HD(Index i) { return v[i]; }, EnvValues{least, fetch});
  fetch.then([&order] { order.push_back(2); });
  fetch.add(v, all);
  fetch.add(std::as_const(counts).view(), offsets);
  fetch.add_total(counts, total);
  EXPECT_EQ((transfers() - before).to_host, 0);
  fetch.now();
  EXPECT_EQ((transfers() - before).to_host, 1);
  for (std::size_t i = 0; i < sums.size(); ++i) EXPECT_EQ(sums[i], 1.0 + host[i]);
  EXPECT_EQ(least[0], *std::min_element(host.begin(), host.end()));
  EXPECT_EQ(all, host);
  EXPECT_EQ(offsets, (std::vector<Index>{0, 3, 3, 7}));
  EXPECT_EQ(total, 7);
  EXPECT_EQ(order.size(), 41u);
  EXPECT_EQ(order.back(), 2);

  fetch.now();  // nothing is wanted any more
  EXPECT_EQ((transfers() - before).to_host, 1);
  env_sum(
      "test", {0, 5}, [=] MORTISE_HD(Index) { return 2.0; }, EnvValues{alone, fetch});
  fetch.now();
  EXPECT_EQ(alone[0], 11);
}

TEST(Device, ScanReturnsTheTotal) {
  Buffer<Index> counts(std::vector<Index>{3, 0, 4, 0});
  EXPECT_EQ(exclusive_scan(counts), 7);
  EXPECT_EQ(counts.download(), (std::vector<Index>{0, 3, 3, 7}));
}

// The tree of sums, written down naively: chunks of kChunk terms, chunks of chunks.
static double tree_sum(std::vector<double> level) {
  while (level.size() > 1) {
    std::vector<double> next((level.size() + kChunk - 1) / kChunk, 0.0);
    for (std::size_t i = 0; i < level.size(); ++i) next[i / kChunk] += level[i];
    level.swap(next);
  }
  return level.empty() ? 0 : level[0];
}

TEST(Device, ReductionsOfManyEnvironmentsTakeOneUploadAndOneDownload) {
  const std::vector<Index> offset{3, 3, 70, 71, 9000, 9000, 300'000};
  const std::vector<double> host = random_values(offset.back());
  const Buffer<double> values(host);
  const View<const double> v = values.view();
  std::vector<double> sums(6, 0.5), most(6, 0.25);
  const Transfers before = transfers();
  env_sum(
      "test", offset, [=] MORTISE_HD(Index i) { return v[i]; }, sums);
  env_max(
      "test", offset, [=] MORTISE_HD(Index i) { return v[i]; }, most);
  const Transfers used = transfers() - before;
  EXPECT_EQ(used.to_device, 2);
  EXPECT_EQ(used.to_host, 2);
  EXPECT_EQ(used.bytes_to_host, 2 * 4 * 8);  // of those that have terms
  for (int e = 0; e < 6; ++e) {
    const std::vector<double> part(host.begin() + offset[e], host.begin() + offset[e + 1]);
    EXPECT_EQ(sums[e], 0.5 + tree_sum(part)) << e;
    EXPECT_EQ(most[e], part.empty() ? 0.25 : std::max(0.25, *std::max_element(part.begin(), part.end()))) << e;
  }
}

TEST(Device, SumOfOneEnvironmentDownloadsOneNumberHoweverManyTerms) {
  for (Index n : {10, 1000, 1'000'000}) {
    const Transfers before = transfers();
    const double s = sum("test", n, [=] MORTISE_HD(Index i) { return 1.0 / (1 + i); });
    const Transfers used = transfers() - before;
    EXPECT_GT(s, 2);
    EXPECT_EQ(used.to_host, 1);
    EXPECT_EQ(used.bytes_to_host, 8);
    EXPECT_EQ(used.to_device, 0);
  }
}
