#pragma once
// From points to degrees of freedom. A stencil of contact or friction is written in positions y of a few points; y = W q, so
//     dE/dq_b = sum_k X_kb dE/dy_k,      and a Hessian term c v v^T in y is c V V^T in q with V_b = sum_k X_kb v_k,
// where X_kb is the weight of block b in point k: one block of weight 1 for a soft node, four for a point of a stiff body. Points
// of one stiff body share its blocks, so a stencil of N points has at most 4 N blocks, and fewer as soon as points share them.
#include "linalg/stencils.h"
#include "model/model.h"

namespace mortise::model {

template <int N>
struct Expansion {
  Index points = 0, blocks = 0;
  Index block[kPointTerms * N];   // distinct, in the order in which the points mention them
  int slot[N][kPointTerms];       // place of point k's term j in `block`; -1 where the point has fewer terms
  double weight[N][kPointTerms];  // X_kb of that term

  // V_b = sum_k X_kb v_k.
  MORTISE_HD void chain(const Vec3* v, Vec3* V) const {
    for (Index b = 0; b < blocks; ++b) V[b] = Vec3::Zero();
    for (Index k = 0; k < points; ++k)
      for (int j = 0; j < kPointTerms; ++j)
        if (slot[k][j] >= 0) V[slot[k][j]] += weight[k][j] * v[k];
  }
  // The same for one number per point.
  MORTISE_HD void chain(const double* w, double* W) const {
    for (Index b = 0; b < blocks; ++b) W[b] = 0;
    for (Index k = 0; k < points; ++k)
      for (int j = 0; j < kPointTerms; ++j)
        if (slot[k][j] >= 0) W[slot[k][j]] += weight[k][j] * w[k];
  }
};

// The distinct blocks behind n <= N points; points of id -1 are skipped (no terms).
template <int N>
MORTISE_HD inline Expansion<N> expand(const PointMapView& map, const Index* point, Index n) {
  Expansion<N> e;
  e.points = n;
  for (Index k = 0; k < n; ++k) {
    for (int j = 0; j < kPointTerms; ++j) e.slot[k][j] = -1, e.weight[k][j] = 0;
    if (point[k] < 0) continue;
    const Index begin = map.offset[point[k]], terms = map.offset[point[k] + 1] - begin;
    for (Index j = 0; j < terms; ++j) {
      const Index id = map.block[begin + j];
      Index s = 0;
      while (s < e.blocks && e.block[s] != id) ++s;
      if (s == e.blocks) e.block[e.blocks++] = id;
      e.slot[k][j] = static_cast<int>(s);
      e.weight[k][j] = map.weight[begin + j];
    }
  }
  return e;
}

// Hessian of stencil s: H(a,b) += c V_a V_b^T over the pairs a <= b of its nb blocks.
MORTISE_HD inline void add_rank_one(const linalg::StencilView& out, Index s, Index nb, double c, const Vec3* V) {
  Mat3* h = out.hess.p + out.hess_offset[s];
  for (Index a = 0; a < nb; ++a)
    for (Index b = a; b < nb; ++b) *h++ += (c * V[a]) * V[b].transpose();
}

// H(a,b) += W_a W_b K, K symmetric.
MORTISE_HD inline void add_weighted(const linalg::StencilView& out, Index s, Index nb, const double* W, const Mat3& K) {
  Mat3* h = out.hess.p + out.hess_offset[s];
  for (Index a = 0; a < nb; ++a)
    for (Index b = a; b < nb; ++b) *h++ += (W[a] * W[b]) * K;
}

MORTISE_HD inline void zero_hessian(const linalg::StencilView& out, Index s, Index nb) {
  Mat3* h = out.hess.p + out.hess_offset[s];
  for (Index i = 0; i < linalg::pair_count(nb); ++i) h[i] = Mat3::Zero();
}

}  // namespace mortise::model
