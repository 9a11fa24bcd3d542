#include "effects/elasticity/mean_volume.h"

#include "device/reduce.h"

namespace mortise::effects::elasticity {
namespace {

struct Members {
  View<const Index> first, tet;
  View<const double> lambda, volume;
  explicit Members(const model::Clusters& c) : first(c.first_tet.view()), tet(c.tet.view()), lambda(c.lambda.view()), volume(c.volume.view()) {}
  // <theta>_c
  MORTISE_HD double mean(const Tets& tets, Index c, Positions q) const {
    double sum = 0;
    for (Index i = first[c]; i < first[c + 1]; ++i) {
      const Index t = tet[i];
      sum += tets.volume[tets.first_point[t]] * dilation(tets.model(t), tets.deformation(t, q));
    }
    return sum / volume[c];
  }
};

}  // namespace

void cluster_pressures(const Tets& tets, const model::Clusters& clusters, Positions q, const Whose& whose, device::Buffer<double>& pressure) {
  const Members all(clusters);
  pressure.resize(clusters.size());
  const View<double> p = pressure.view();
  device::parallel_for("elasticity.cluster_pressures", {clusters.env_offset, whose},
                       [=] MORTISE_HD(Index c) { p[c] = all.lambda[c] * all.mean(tets, c, q); });
}

void cluster_energy(const Tets& tets, const model::Clusters& clusters, Positions q, const Whose& whose, device::EnvValues per_env) {
  const Members all(clusters);
  device::env_sum(
      "elasticity.cluster_energy", {clusters.env_offset, whose},
      [=] MORTISE_HD(Index c) {
        const double mean = all.mean(tets, c, q);
        return 0.5 * all.volume[c] * all.lambda[c] * mean * mean;
      },
      per_env);
}

void cluster_stencils(const Tets& tets, const model::Clusters& clusters, Positions q, Index first, bool hessian, const Whose& whose,
                      const linalg::StencilView& out) {
  if (clusters.size() == 0) return;
  const device::Ranges nodes(clusters.env_nodes, whose);
  device::parallel_for("elasticity.cluster_forces", nodes, [=] MORTISE_HD(Index i) { out.grad[out.offset[first] + i] = Vec3::Zero(); });
  if (!hessian) return;
  const Members all(clusters);
  const View<const Index> slot = clusters.slot.view(), first_node = clusters.first_node.view(), owner = clusters.owner.view();
  device::Buffer<Vec3> slopes(clusters.node.size());
  const View<Vec3> g = slopes.view();
  device::parallel_for("elasticity.cluster_slopes", {clusters.env_offset, whose}, [=] MORTISE_HD(Index c) {
    for (Index i = first_node[c]; i < first_node[c + 1]; ++i) g[i] = Vec3::Zero();
    for (Index i = all.first[c]; i < all.first[c + 1]; ++i) {
      const Index t = all.tet[i], p = tets.first_point[t];
      const Mat3 dm_inverse = tets.dm_inverse[p], slope = (tets.volume[p] / all.volume[c]) * dilation_slope(tets.model(t), tets.deformation(t, q));
      Vec3 sum = Vec3::Zero();
      for (int a = 1; a < 4; ++a) {
        const Vec3 of_corner = slope * shape_gradient(dm_inverse, a);
        g[slot[4 * i + a]] += of_corner;
        sum += of_corner;
      }
      g[slot[4 * i]] -= sum;
    }
  });
  device::parallel_for("elasticity.cluster_hessians", nodes, [=] MORTISE_HD(Index i) {  // a row of pieces each
    const Index c = owner[i], n = first_node[c + 1] - first_node[c], a = i - first_node[c];
    Mat3* row = out.hess.p + out.hess_offset[first + c] + linalg::pair_place(a, a, n);
    const Vec3 left = (all.lambda[c] * all.volume[c]) * g[i];
    for (Index b = a; b < n; ++b) *row++ = left * g[first_node[c] + b].transpose();
  });
}

}  // namespace mortise::effects::elasticity
