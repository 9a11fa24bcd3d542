#include "run/stress_error.h"

#include <cmath>
#include <limits>

namespace mortise::run {
namespace {

using Stress = Eigen::Matrix<double, 6, 1>;

// w(a) of the header.
double energy_density(const Stress& s, double E, double nu) {
  const double trace = s[0] + s[1] + s[2], square = s.head<3>().squaredNorm() + 2 * s.tail<3>().squaredNorm();
  return ((1 + nu) * square - nu * trace * trace) / (2 * E);
}

// Mean over a tetrahedron of w of a linear field with these values at its corners.
double mean_of_linear(const Stress (&corner)[4], double E, double nu) {
  Stress sum = Stress::Zero();
  double mean = 0;
  for (const Stress& c : corner) sum += c, mean += energy_density(c, E, nu);
  return (mean + energy_density(sum, E, nu)) / 20;
}

}  // namespace

StressError::StressError(const model::ModelInput& input) {
  std::size_t cell = 0;
  for (const model::BodyInput& in : input.bodies) {
    if (in.type == model::BodyType::soft && in.midsides.empty()) {
      Body b{cell, in.tets, {}, in.nodes.size(), in.material.number("youngs_modulus"), in.material.number("poisson_ratio")};
      for (const Tet& t : in.tets) {
        Mat3 edges;
        for (int k = 0; k < 3; ++k) edges.col(k) = in.nodes[t.v[k + 1]] - in.nodes[t.v[0]];
        b.volume.push_back(edges.determinant() / 6);
      }
      bodies_.push_back(std::move(b));
    }
    if (in.type != model::BodyType::half_space) cell += in.type == model::BodyType::soft ? in.tets.size() : in.triangles.size();
  }
}

double StressError::of(std::span<const double> stress) const {
  double missed = 0, all = 0;
  for (const Body& b : bodies_) {
    const auto at = [&](std::size_t t) { return Stress(Eigen::Map<const Stress>(stress.data() + 6 * (b.first_cell + t))); };
    std::vector<Stress> mean(b.nodes, Stress::Zero());
    std::vector<double> weight(b.nodes, 0.0);
    for (std::size_t t = 0; t < b.tets.size(); ++t)
      for (Index v : b.tets[t].v) mean[v] += b.volume[t] * at(t), weight[v] += b.volume[t];
    for (std::size_t i = 0; i < mean.size(); ++i)
      if (weight[i] > 0) mean[i] /= weight[i];
    for (std::size_t t = 0; t < b.tets.size(); ++t) {
      const Stress here = at(t);
      Stress smooth[4], jump[4];
      for (int k = 0; k < 4; ++k) smooth[k] = mean[b.tets[t].v[k]], jump[k] = smooth[k] - here;
      missed += b.volume[t] * mean_of_linear(jump, b.E, b.nu);
      all += b.volume[t] * mean_of_linear(smooth, b.E, b.nu);
    }
  }
  return all > 0 ? missed / (missed + all) : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace mortise::run
