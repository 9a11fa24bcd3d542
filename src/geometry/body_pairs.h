#pragma once
// Where tables over pairs of bodies keep their values: a row per body with a column per body of its environment, then a row per half-space (they
// are in all environments) with a column per body. Memory grows with the number of environments, not with its square.
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <vector>

#include "device/device.h"

namespace mortise::geometry {

struct BodyPairsView {
  device::View<const Index> row;  // per body: where its row would begin if it had a column for every body before those of its environment too
  Index bodies = 0, pairs = 0;    // pairs: of bodies; rows of half-spaces follow

  // Place of body a and body b of the same environment, or half-space b - bodies.
  MORTISE_HD Index of(Index a, Index b) const { return b < bodies ? row[a] + b : pairs + (b - bodies) * bodies + a; }
};

class BodyPairs {
 public:
  BodyPairs() = default;
  // env: of every body; the bodies of an environment follow one another.
  explicit BodyPairs(const std::vector<Index>& env) : row_(env.size()) {
    long long begin = 0;
    for (std::size_t first = 0, end = 0; first < env.size(); first = end) {
      while (end < env.size() && env[end] == env[first]) ++end;
      for (std::size_t a = first; a < end; ++a, begin += static_cast<long long>(end - first))
        row_[a] = static_cast<Index>(begin - static_cast<long long>(first));
      if (begin > std::numeric_limits<Index>::max()) throw std::length_error("too many pairs of bodies");
    }
    pairs_ = static_cast<Index>(begin);
    on_device_.upload(row_);
  }
  Index bodies() const { return static_cast<Index>(row_.size()); }
  Index of(Index a, Index b) const { return b < bodies() ? row_[a] + b : pairs_ + (b - bodies()) * bodies() + a; }
  std::size_t size(std::size_t half_spaces) const { return static_cast<std::size_t>(pairs_) + half_spaces * row_.size(); }
  BodyPairsView view() const { return {on_device_.view(), bodies(), pairs_}; }

 private:
  std::vector<Index> row_;
  device::Buffer<Index> on_device_;
  Index pairs_ = 0;
};

}  // namespace mortise::geometry
