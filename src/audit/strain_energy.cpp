#include "audit/strain_energy.h"

#include <algorithm>

#include "audit/tuning.h"
#include "audit/vector_at.h"
#include "geometry/quadratic.h"

namespace mortise::audit {

static std::vector<StrainEnergy::Place> everywhere(const model::BodyInput& body) {
  const int each = body.midsides.empty() ? 1 : geometry::kTetPoints;
  std::vector<StrainEnergy::Place> out;
  for (std::size_t t = 0; t < body.tets.size(); ++t)
    for (int g = 0; g < each; ++g) {
      StrainEnergy::Place place{t, {0.25, 0.25, 0.25, 0.25}, 1.0 / each};
      if (each > 1) geometry::tet_point(g, place.l.data());
      out.push_back(place);
    }
  return out;
}

StrainEnergy::StrainEnergy(const model::BodyInput& body, std::size_t first) : StrainEnergy(body, first, everywhere(body)) {}

StrainEnergy::StrainEnergy(const model::BodyInput& body, std::size_t first, const std::vector<Place>& places) : first_(first) {
  if (body.tets.empty()) return;
  const double E = body.material.number("youngs_modulus"), nu = std::min(body.material.number("poisson_ratio"), tuning::kCompressible);
  mu_ = E / (2 * (1 + nu)), lambda_ = E * nu / ((1 + nu) * (1 - 2 * nu));
  const bool quadratic = !body.midsides.empty();
  for (std::size_t t = 0; t < body.tets.size(); ++t) {
    std::vector<std::size_t>& nodes = nodes_.emplace_back();
    for (const Index v : body.tets[t].v) nodes.push_back(static_cast<std::size_t>(v));
    for (int k = 0; quadratic && k < 6; ++k) nodes.push_back(static_cast<std::size_t>(body.midsides[t].v[k]));
  }
  for (const Place& place : places) {
    const std::vector<std::size_t>& nodes = nodes_[place.tet];
    Point& point = points_.emplace_back(Point{place.tet, {}, 0});
    Mat3 X = Mat3::Zero();  // by the barycentrics
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      const Vec3 linear = k == 0 ? Vec3(-1, -1, -1) : Vec3(Vec3::Unit(static_cast<int>(std::min<std::size_t>(k, 3)) - 1));
      point.slopes.push_back(quadratic ? geometry::tet_slope(static_cast<int>(k), place.l.data()) : linear);
      X += body.nodes[nodes[k]] * point.slopes.back().transpose();
    }
    point.volume = place.share * X.determinant() / 6;
    for (Vec3& slope : point.slopes) slope = X.inverse().transpose() * slope;
  }
}

double StrainEnergy::at(const std::vector<double>& points) const {
  double sum = 0;
  for (const Point& p : points_) {
    const std::vector<std::size_t>& nodes = nodes_[p.tet];
    Mat3 F = Mat3::Zero();
    for (std::size_t k = 0; k < nodes.size(); ++k) F += audit::at(points, first_ + nodes[k]) * p.slopes[k].transpose();
    const Mat3 G = 0.5 * (F.transpose() * F - Mat3::Identity());
    sum += p.volume * (mu_ * G.squaredNorm() + 0.5 * lambda_ * G.trace() * G.trace());
  }
  return sum;
}

}  // namespace mortise::audit
