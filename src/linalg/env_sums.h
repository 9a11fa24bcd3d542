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

  // Pairs of sums [first, second] of term(row) for every environment; valid until the next call.
  template <class F>
  View<const Vec2> operator()(const char* name, F term);

 private:
  std::vector<Buffer<Index>> start_;  // of every level: chunk c adds places [start[c], start[c+1]) of the level below
  std::vector<Buffer<Vec2>> value_;
};

template <class F>
View<const Vec2> EnvSums::operator()(const char* name, F term) {
  for (std::size_t level = 0; level < start_.size(); ++level) {
    const View<const Index> s = start_[level].view();
    const View<Vec2> out = value_[level].view();
    if (level == 0) {
      device::parallel_for(name, out.n, [=] MORTISE_HD(Index c) {
        Vec2 t = Vec2::Zero();
        for (Index i = s[c]; i < s[c + 1]; ++i) t += term(i);
        out[c] = t;
      });
    } else {
      const View<const Vec2> below = value_[level - 1].view();
      device::parallel_for("env_sums.tree", out.n, [=] MORTISE_HD(Index c) {
        Vec2 t = Vec2::Zero();
        for (Index i = s[c]; i < s[c + 1]; ++i) t += below[i];
        out[c] = t;
      });
    }
  }
  return value_.back().view();
}

}  // namespace mortise::linalg
