#include "linalg/rank_ones.h"

namespace mortise::linalg {

void multiply(const RankOnes& pieces, bool transposed, device::View<const Vec3> d, StencilSet& set) {
  const StencilView v = set.view();
  const Index rank = pieces.rank, blocks = v.block.n;
  const device::View<const Vec3> l = (transposed ? pieces.right : pieces.left).view(), r = (transposed ? pieces.left : pieces.right).view();
  device::parallel_for("linalg.rank_ones", v.n, [=] MORTISE_HD(Index s) {
    for (Index a = v.offset[s]; a < v.offset[s + 1]; ++a) v.grad[a] = Vec3::Zero();
    for (Index c = 0; c < rank; ++c) {
      const Index at = c * blocks;
      double along = 0;
      for (Index b = v.offset[s]; b < v.offset[s + 1]; ++b)
        if (v.block[b] >= 0) along += r[at + b].dot(d[v.block[b]]);
      for (Index a = v.offset[s]; a < v.offset[s + 1]; ++a) v.grad[a] += along * l[at + a];
    }
  });
}

}  // namespace mortise::linalg
