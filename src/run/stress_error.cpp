#include "run/stress_error.h"

#include <cmath>
#include <limits>

#include "model/volumetric.h"

namespace mortise::run {
namespace {

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
  std::size_t cell = 0, point = 0;
  for (const model::BodyInput& in : input.bodies) {
    if (in.type == model::BodyType::half_space) continue;
    if (in.type == model::BodyType::soft) {
      const bool quadratic = !in.midsides.empty();
      Body b{cell,
             point,
             in.tets,
             in.midsides,
             quadratic ? in.nodes : std::vector<Vec3>{},
             {},
             in.nodes.size(),
             in.material.number("youngs_modulus"),
             in.material.number("poisson_ratio"),
             quadratic && model::averages_volume(in.material)};
      for (const Tet& t : in.tets) {
        Mat3 edges;
        for (int k = 0; k < 3; ++k) edges.col(k) = in.nodes[t.v[k + 1]] - in.nodes[t.v[0]];
        b.volume.push_back(edges.determinant() / 6);
      }
      bodies_.push_back(std::move(b));
    }
    cell += in.type == model::BodyType::soft ? in.tets.size() : in.triangles.size();
    point += in.nodes.size();
  }
}

CornerStress StressError::of_quadratic(const Body& b, std::size_t tet, std::span<const double> displacement) {
  std::array<Vec3, 10> rest, u;
  for (int k = 0; k < 10; ++k) {
    const Index node = k < 4 ? b.tets[tet].v[k] : b.midsides[tet].v[k - 4];
    rest[k] = b.rest[node], u[k] = Eigen::Map<const Vec3>(displacement.data() + 3 * (b.first_point + node));
  }
  return stress_of_quadratic(rest, u, {b.E, b.nu, b.averaged});
}

double StressError::of(std::span<const double> stress, std::span<const double> displacement) const {
  double missed = 0, all = 0;
  for (const Body& b : bodies_) {
    if (!b.midsides.empty() && displacement.size() < 3 * (b.first_point + b.nodes)) continue;
    std::vector<CornerStress> here(b.tets.size());
    std::vector<Stress> mean(b.nodes, Stress::Zero());
    std::vector<double> weight(b.nodes, 0.0);
    for (std::size_t t = 0; t < b.tets.size(); ++t) {
      if (b.midsides.empty())
        here[t].fill(Eigen::Map<const Stress>(stress.data() + 6 * (b.first_cell + t)));
      else
        here[t] = of_quadratic(b, t, displacement);
      for (int k = 0; k < 4; ++k) mean[b.tets[t].v[k]] += b.volume[t] * here[t][k], weight[b.tets[t].v[k]] += b.volume[t];
    }
    for (std::size_t i = 0; i < mean.size(); ++i)
      if (weight[i] > 0) mean[i] /= weight[i];
    for (std::size_t t = 0; t < b.tets.size(); ++t) {
      Stress smooth[4], jump[4];
      for (int k = 0; k < 4; ++k) smooth[k] = mean[b.tets[t].v[k]], jump[k] = smooth[k] - here[t][k];
      missed += b.volume[t] * mean_of_linear(jump, b.E, b.nu);
      all += b.volume[t] * mean_of_linear(smooth, b.E, b.nu);
    }
  }
  return all > 0 ? missed / (missed + all) : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace mortise::run
