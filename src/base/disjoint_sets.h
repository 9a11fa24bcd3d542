#pragma once
#include <numeric>
#include <vector>

namespace mortise {

// Things that belong together, by their numbers.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
  void join(std::size_t a, std::size_t b) { parent_[of(a)] = of(b); }
  // One of those that i belongs to, the same for all of them.
  std::size_t of(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }

 private:
  std::vector<std::size_t> parent_;
};

}  // namespace mortise
