#pragma once
// Sums over the rows of every environment at once, by a tree whose shape depends on the environment's own size only: chunks of
// device::kChunk rows, chunks of chunks, until one value per environment is left. Nothing returns to the host.
#include <vector>

#include "device/device.h"

namespace mortise::linalg {

using device::Buffer;
using device::View;

class EnvSums {
 public:
  // Environment e owns rows [offset[e], offset[e+1]); offset[0] = 0.
  explicit EnvSums(const std::vector<Index>& offset);

  // Pairs of sums [first, second] of term(row) for every environment; valid until the next call. finish(environment, sums) follows on the device.
  template <class F, class Finish>
  View<const Vec2> operator()(const char* name, F term, Finish finish);
  template <class F>
  View<const Vec2> operator()(const char* name, F term) {
    return (*this)(name, term, [] MORTISE_HD(Index, const Vec2&) {});
  }

 private:
  std::vector<Buffer<Index>> start_;  // of every level: chunk c adds places [start[c], start[c+1]) of the level below
  std::vector<Buffer<Vec2>> value_;
};

template <class F, class Finish>
View<const Vec2> EnvSums::operator()(const char* name, F term, Finish finish) {
  for (std::size_t level = 0; level < start_.size(); ++level) {
    const View<const Index> start = start_[level].view();
    const View<Vec2> out = value_[level].view();
    const bool last = level + 1 == start_.size();
    const auto chunk = [=] MORTISE_HD(Index c, Index & from, Index & to) { from = start[c], to = start[c + 1]; };
    const auto keep = [=] MORTISE_HD(Index c, const Vec2& sum) {
      out[c] = sum;
      if (last) finish(c, sum);
    };
    if (level == 0) {
      device::fold(name, out.n, chunk, term, device::AddUp<Vec2>(), keep);
    } else {
      const View<const Vec2> below = value_[level - 1].view();
      device::fold(
          "env_sums.tree", out.n, chunk, [=] MORTISE_HD(Index i) -> Vec2 { return below[i]; }, device::AddUp<Vec2>(), keep);
    }
  }
  return value_.back().view();
}

}  // namespace mortise::linalg
