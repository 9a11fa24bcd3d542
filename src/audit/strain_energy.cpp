#include "audit/strain_energy.h"

#include <algorithm>

#include "audit/tuning.h"
#include "audit/vector_at.h"
#include "geometry/quadratic.h"

namespace mortise::audit {

StrainEnergy::StrainEnergy(const model::BodyInput& body, std::size_t first) : first_(first) {
  if (body.tets.empty()) return;
  const double E = body.material.number("youngs_modulus"), nu = std::min(body.material.number("poisson_ratio"), tuning::kCompressible);
  mu_ = E / (2 * (1 + nu)), lambda_ = E * nu / ((1 + nu) * (1 - 2 * nu));
  const bool quadratic = !body.midsides.empty();
  for (std::size_t t = 0; t < body.tets.size(); ++t) {
    std::vector<std::size_t>& nodes = nodes_.emplace_back();
    for (const Index v : body.tets[t].v) nodes.push_back(static_cast<std::size_t>(v));
    for (int k = 0; quadratic && k < 6; ++k) nodes.push_back(static_cast<std::size_t>(body.midsides[t].v[k]));
    std::vector<Point>& points = points_.emplace_back(quadratic ? geometry::kTetPoints : 1);
    for (std::size_t g = 0; g < points.size(); ++g) {
      double l[4] = {0.25, 0.25, 0.25, 0.25};
      if (quadratic) geometry::tet_point(static_cast<int>(g), l);
      Mat3 X = Mat3::Zero();  // by the barycentrics
      for (std::size_t k = 0; k < nodes.size(); ++k) {
        const Vec3 linear = k == 0 ? Vec3(-1, -1, -1) : Vec3(Vec3::Unit(static_cast<int>(std::min<std::size_t>(k, 3)) - 1));
        points[g].slopes.push_back(quadratic ? geometry::tet_slope(static_cast<int>(k), l) : linear);
        X += body.nodes[nodes[k]] * points[g].slopes.back().transpose();
      }
      points[g].volume = X.determinant() / 6 / static_cast<double>(points.size());
      for (Vec3& slope : points[g].slopes) slope = X.inverse().transpose() * slope;
    }
  }
}

double StrainEnergy::at(const std::vector<double>& points) const {
  double sum = 0;
  for (std::size_t t = 0; t < nodes_.size(); ++t)
    for (const Point& p : points_[t]) {
      Mat3 F = Mat3::Zero();
      for (std::size_t k = 0; k < nodes_[t].size(); ++k) F += audit::at(points, first_ + nodes_[t][k]) * p.slopes[k].transpose();
      const Mat3 G = 0.5 * (F.transpose() * F - Mat3::Identity());
      sum += p.volume * (mu_ * G.squaredNorm() + 0.5 * lambda_ * G.trace() * G.trace());
    }
  return sum;
}

}  // namespace mortise::audit
