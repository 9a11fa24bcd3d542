#pragma once
// Everything a kernel needs of the tetrahedra.
#include "effects/effect.h"
#include "effects/elasticity/elasticity.h"
#include "model/model.h"

namespace mortise::effects::elasticity {

struct Tets {
  View<const Tet> tet;
  View<const geometry::Midsides> midsides;
  View<const Index> first_point;
  View<const Mat3> dm_inverse;
  View<const double> volume, mu, lambda, mean_lambda;
  View<const std::uint8_t> material;
  View<const Index> cluster;      // of_tet of the clusters
  View<const double> pressure{};  // of every cluster; none: not wanted
  explicit Tets(const model::Model& m)
      : tet(m.volume.tets.view()),
        midsides(m.volume.midsides.view()),
        first_point(m.volume.first_point.view()),
        dm_inverse(m.volume.dm_inverse.view()),
        volume(m.volume.rest_volume.view()),
        mu(m.volume.lame_mu.view()),
        lambda(m.volume.lame_lambda.view()),
        mean_lambda(m.volume.mean_lambda.view()),
        material(m.volume.material.view()),
        cluster(m.clusters.of_tet.view()) {}

  Index size() const { return tet.n; }
  MORTISE_HD bool quadratic(Index t) const { return first_point[t + 1] - first_point[t] > 1; }
  MORTISE_HD Index node(Index t, int a) const { return a < 4 ? tet[t].v[a] : midsides[t].v[a - 4]; }
  MORTISE_HD model::MaterialModel model(Index t) const { return static_cast<model::MaterialModel>(material[t]); }
  // Of a linear tetrahedron with the pressure of its cluster.
  MORTISE_HD Element element(Index t, int point) const {
    const Index p = first_point[t] + point, c = pressure.n > 0 ? cluster[t] : -1;
    return {dm_inverse[p], volume[p], mu[t], lambda[t], model(t), c < 0 ? 0 : pressure[c]};
  }
  // Of a linear tetrahedron.
  MORTISE_HD Mat3 deformation(Index t, Positions q) const {
    const Tet v = tet[t];
    return deformation_gradient(dm_inverse[first_point[t]], q[v.v[0]], q[v.v[1]], q[v.v[2]], q[v.v[3]]);
  }
  MORTISE_HD void nodes(Index t, Positions q, Vec3 x[10]) const {
    for (int a = 0; a < 10; ++a) x[a] = q[node(t, a)];
  }
};

// Mean change of volume of a quadratic tetrahedron with nodes x, and its volume [m^3].
struct Mean {
  double dilation = 0, volume = 0;
};
MORTISE_HD inline Mean mean_of_quadratic(const Tets& tets, Index t, const Vec3 x[10]) {
  Vec3 g[10];
  Mean mean;
  for (int p = 0; p < geometry::kTetPoints; ++p) {
    const Element e = tets.element(t, p);
    quadratic_gradients(e.dm_inverse, p, g);
    mean.dilation += e.volume * dilation(e.model, quadratic_deformation(g, x));
    mean.volume += e.volume;
  }
  mean.dilation /= mean.volume;
  return mean;
}

// Deformation gradient at every point of integration, and the point's properties: visit(point, element, F).
template <class Visit>
MORTISE_HD inline void at_points(const Tets& tets, Index t, Positions q, Visit&& visit) {
  if (!tets.quadratic(t)) {
    visit(0, tets.element(t, 0), tets.deformation(t, q));
    return;
  }
  Vec3 x[10], g[10];
  tets.nodes(t, q, x);
  const double lambda = tets.mean_lambda[t], pressure = lambda > 0 ? lambda * mean_of_quadratic(tets, t, x).dilation : 0;
  for (int p = 0; p < geometry::kTetPoints; ++p) {
    Element e = tets.element(t, p);
    e.pressure = pressure;
    quadratic_gradients(e.dm_inverse, p, g);
    visit(p, e, quadratic_deformation(g, x));
  }
}

}  // namespace mortise::effects::elasticity
