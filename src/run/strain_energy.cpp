#include "run/strain_energy.h"

#include <algorithm>

#include "run/tuning.h"
#include "run/vector_at.h"

namespace mortise::run {

StrainEnergy::StrainEnergy(const model::BodyInput& body, std::size_t first) : first_(first), tets_(body.tets) {
  if (tets_.empty()) return;
  const double E = body.material.number("youngs_modulus"), nu = std::min(body.material.number("poisson_ratio"), tuning::kCompressible);
  mu_ = E / (2 * (1 + nu)), lambda_ = E * nu / ((1 + nu) * (1 - 2 * nu));
  for (const Tet& t : tets_) {
    Mat3 edges;
    for (int k = 0; k < 3; ++k) edges.col(k) = body.nodes[t.v[k + 1]] - body.nodes[t.v[0]];
    inverse_.push_back(edges.inverse()), volume_.push_back(edges.determinant() / 6);
  }
}

double StrainEnergy::at(const std::vector<double>& points) const {
  double sum = 0;
  for (std::size_t t = 0; t < tets_.size(); ++t) {
    const auto x = [&](int k) { return run::at(points, first_ + static_cast<std::size_t>(tets_[t].v[k])); };
    Mat3 edges;
    for (int k = 0; k < 3; ++k) edges.col(k) = x(k + 1) - x(0);
    const Mat3 F = edges * inverse_[t], G = 0.5 * (F.transpose() * F - Mat3::Identity());
    sum += volume_[t] * (mu_ * G.squaredNorm() + 0.5 * lambda_ * G.trace() * G.trace());
  }
  return sum;
}

}  // namespace mortise::run
