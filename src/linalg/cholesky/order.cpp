#include "linalg/cholesky/order.h"

#include <metis.h>

#include <mutex>
#include <numeric>
#include <string>

#include "base/error.h"

namespace mortise::linalg::cholesky {
namespace {

// Neighbours of every row, ascending.
struct Neighbours {
  std::vector<idx_t> start, neighbour;

  Neighbours(const std::vector<Index>& row_start, const std::vector<Index>& col) : start(row_start.size(), 0) {
    const std::size_t rows = row_start.size() - 1;
    const auto each_edge = [&](auto visit) {
      for (std::size_t r = 0; r < rows; ++r)
        for (Index k = row_start[r] + 1; k < row_start[r + 1]; ++k) visit(r, static_cast<std::size_t>(col[k]));
    };
    each_edge([&](std::size_t r, std::size_t c) { ++start[r + 1], ++start[c + 1]; });
    std::partial_sum(start.begin(), start.end(), start.begin());
    neighbour.resize(start.back());
    std::vector<idx_t> at(start.begin(), start.end() - 1);
    each_edge([&](std::size_t r, std::size_t c) {
      neighbour[at[r]++] = static_cast<idx_t>(c);
      neighbour[at[c]++] = static_cast<idx_t>(r);
    });
  }
};

}  // namespace

std::vector<Index> find_order(const std::vector<Index>& row_start, const std::vector<Index>& col) {
  Neighbours graph(row_start, col);
  const auto rows = static_cast<idx_t>(row_start.size() - 1);
  std::vector<Index> order(rows);
  std::iota(order.begin(), order.end(), 0);
  if (graph.neighbour.empty()) return order;
  // METIS ends the program where it gets no memory; what it takes, by CHOLMOD's estimate, is asked for before.
  constexpr std::size_t kTakes = 10;
  std::vector<idx_t>().reserve(kTakes * (graph.neighbour.size() + rows + 4096));
  // METIS draws from the C library's one sequence of random numbers, which it begins anew: two at once would disturb each other.
  static std::mutex one_at_a_time;
  const std::lock_guard<std::mutex> lock(one_at_a_time);
  // METIS_NodeND finds the same order, but takes SIGTERM for an error of its own meanwhile: it would end without an order, and a run that is asked to
  // stop would go on.
  std::vector<idx_t> place(rows), sizes(1);
  const int answer = METIS_NodeNDP(rows, graph.start.data(), graph.neighbour.data(), nullptr, 1, nullptr, order.data(), place.data(), sizes.data());
  if (answer != METIS_OK) throw Error(Exit::internal, "METIS error " + std::to_string(answer));
  return order;
}

}  // namespace mortise::linalg::cholesky
