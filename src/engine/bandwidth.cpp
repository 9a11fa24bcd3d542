#include "engine/bandwidth.h"

#include <algorithm>
#include <chrono>
#include <functional>

#include "linalg/block_matrix.h"

namespace mortise::engine {
namespace {

using device::Buffer;
using device::View;

std::vector<std::uint64_t> grid_keys(Index edge) {
  const Index rows = edge * edge * edge;
  std::vector<std::uint64_t> keys;
  for (Index r = 0; r < rows; ++r) {
    const Index at[3] = {r % edge, r / edge % edge, r / (edge * edge)};
    for (Index dz = -1; dz <= 1; ++dz)
      for (Index dy = -1; dy <= 1; ++dy)
        for (Index dx = -1; dx <= 1; ++dx) {
          const Index to[3] = {at[0] + dx, at[1] + dy, at[2] + dz};
          if (std::any_of(to, to + 3, [&](Index k) { return k < 0 || k >= edge; })) continue;
          const Index c = to[0] + edge * (to[1] + edge * to[2]);
          if (c >= r) keys.push_back(linalg::block_key(r, c, rows));
        }
  }
  return keys;
}

// Seconds of one piece of work: the best of several rounds, each long enough to hide what a round costs. `finish` waits.
double seconds_of(const std::function<void()>& work, const std::function<void()>& finish) {
  using Time = std::chrono::steady_clock;
  constexpr int kRounds = 5;
  int repeats = 1;
  double best = 1e300;
  for (int round = 0; round < kRounds;) {
    const auto begin = Time::now();
    for (int i = 0; i < repeats; ++i) work();
    finish();
    const double seconds = std::chrono::duration<double>(Time::now() - begin).count();
    if (seconds < 0.02) {
      repeats *= 2;
      continue;
    }
    best = std::min(best, seconds / repeats);
    ++round;
  }
  return best;
}

}  // namespace

void measure_bandwidth(Index edge, Bandwidth& out) {
  const std::vector<std::uint64_t> keys = grid_keys(edge);
  linalg::BlockMatrix A;
  linalg::set_pattern(Buffer<std::uint64_t>(keys), edge * edge * edge, A);
  const View<Mat3> value = A.value.view();
  device::parallel_for("bandwidth.fill", value.n, [=] MORTISE_HD(Index k) { value[k] = Mat3::Constant(1.0 / (1 + k % 7)); });
  Buffer<Vec3> x(std::vector<Vec3>(A.rows, Vec3(1, 2, 3))), y(A.rows);
  // Nobody can read less: every upper block once, both structures, both vectors.
  const double bytes = 72.0 * A.upper_blocks() + 8.0 * A.full_col.size() + 4.0 * (A.rows + 1) + 48.0 * A.rows;
  const auto finish = [&] {
    double last;
    device::copy_out(&last, y.view().p, sizeof last);
  };
  out.rows = A.rows, out.blocks = A.full_col.size();
  out.multiply_bytes = bytes;
  out.multiply_seconds = seconds_of([&] { linalg::multiply(A, std::as_const(x).view(), y.view()); }, finish);

  const std::size_t half = static_cast<std::size_t>(bytes / 2) / sizeof(double) * sizeof(double);
  Buffer<double> from(static_cast<Index>(half / sizeof(double))), to(from.size());
  from.zero();
  out.copy_bytes = 2.0 * static_cast<double>(half);  // read and written
  out.copy_seconds = seconds_of([&] { device::copy(to.view().p, from.view().p, half); }, finish);
}

}  // namespace mortise::engine
