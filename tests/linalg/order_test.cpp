// Orders of elimination: what libraries do to signals meanwhile.
#include "linalg/cholesky/order.h"

#include <gtest/gtest.h>
#include <pthread.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <numeric>
#include <thread>

namespace mortise::linalg {
namespace {

volatile std::sig_atomic_t heard = 0;
extern "C" void on_signal(int) { heard = heard + 1; }

// Each row is coupled to the next ones in x, y and z.
struct Cube {
  std::vector<Index> row_start{0}, col;
  explicit Cube(Index side) {
    for (Index r = 0; r < side * side * side; ++r) {
      const Index x = r % side, y = r / side % side, z = r / (side * side);
      col.push_back(r);
      if (x + 1 < side) col.push_back(r + 1);
      if (y + 1 < side) col.push_back(r + side);
      if (z + 1 < side) col.push_back(r + side * side);
      row_start.push_back(static_cast<Index>(col.size()));
    }
  }
};

TEST(Order, HasEveryRowOnce) {
  for (Index side : {1, 2, 3, 12}) {
    const Cube cube(side);
    std::vector<Index> order = cholesky::find_order(cube.row_start, cube.col), all(order.size());
    EXPECT_EQ(order.size(), static_cast<std::size_t>(side * side * side));
    std::sort(order.begin(), order.end()), std::iota(all.begin(), all.end(), 0);
    EXPECT_EQ(order, all);
  }
  EXPECT_EQ(cholesky::find_order({0, 1, 2, 3}, {0, 1, 2}), (std::vector<Index>{0, 1, 2})) << "rows that know nobody";
}

// A run that is asked to stop while an order is found has to hear it, and to go on with the same bits later.
TEST(Order, LeavesSignalsToTheProgram) {
  struct sigaction ours = {}, before = {};
  ours.sa_handler = on_signal;
  sigaction(SIGTERM, &ours, &before);
  const Cube cube(16);
  const std::vector<Index> undisturbed = cholesky::find_order(cube.row_start, cube.col);
  std::atomic<bool> done = false;
  std::atomic<int> sent = 0, foreign = 0;
  const pthread_t here = pthread_self();
  std::thread other([&] {
    for (; !done; std::this_thread::sleep_for(std::chrono::microseconds(100))) {
      struct sigaction now = {};
      sigaction(SIGTERM, nullptr, &now);
      if (now.sa_handler != on_signal)
        ++foreign;
      else
        sent += pthread_kill(here, SIGTERM) == 0;
    }
  });
  while (sent + foreign < 100) EXPECT_EQ(cholesky::find_order(cube.row_start, cube.col), undisturbed);
  done = true;
  other.join();
  sigaction(SIGTERM, &before, nullptr);
  EXPECT_EQ(foreign, 0);
  EXPECT_GT(heard, 0);
}

}  // namespace
}  // namespace mortise::linalg
