#include "run/stress_error.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "geometry/quadratic.h"
#include "model/volumetric.h"
#include "run/held_points.h"
#include "run/tuning.h"

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
  const std::vector<bool> held = held_points(input);
  std::size_t number = 0, cell = 0, point = 0;
  for (const model::BodyInput& in : input.bodies) {
    if (in.type == model::BodyType::half_space) continue;
    if (in.type == model::BodyType::soft) {
      const bool quadratic = !in.midsides.empty();
      Body b{number,
             cell,
             point,
             in.tets,
             in.midsides,
             quadratic ? in.nodes : std::vector<Vec3>{},
             {},
             {},
             in.nodes.size(),
             in.material.number("youngs_modulus"),
             in.material.number("poisson_ratio"),
             quadratic && model::averages_volume(in.material)};
      for (const Tet& t : in.tets) {
        Mat3 edges;
        for (int k = 0; k < 3; ++k) edges.col(k) = in.nodes[t.v[k + 1]] - in.nodes[t.v[0]];
        b.volume.push_back(edges.determinant() / 6);
        const auto held_there = [&](Index node) { return held[point + static_cast<std::size_t>(node)]; };
        const std::size_t tet = b.volume.size() - 1;
        b.held.push_back(std::all_of(std::begin(t.v), std::end(t.v), held_there) &&
                         (!quadratic || std::all_of(std::begin(in.midsides[tet].v), std::end(in.midsides[tet].v), held_there)));
      }
      bodies_.push_back(std::move(b));
    }
    cell += in.type == model::BodyType::soft ? in.tets.size() : in.triangles.size();
    point += in.nodes.size(), ++number;
  }
}

// At the corners of a tetrahedron of ten nodes.
StressError::Corners StressError::of_quadratic(const Body& b, std::size_t tet, std::span<const double> displacement) {
  Mat3 G[geometry::kTetPoints];
  double J[geometry::kTetPoints], mean_J = 0;
  for (int g = 0; g < geometry::kTetPoints; ++g) {
    double l[4];
    geometry::tet_point(g, l);
    Mat3 X = Mat3::Zero(), x = Mat3::Zero();  // by the barycentrics
    for (int k = 0; k < 10; ++k) {
      const Index node = k < 4 ? b.tets[tet].v[k] : b.midsides[tet].v[k - 4];
      const Vec3 slope = geometry::tet_slope(k, l), u = Eigen::Map<const Vec3>(displacement.data() + 3 * (b.first_point + node));
      X += b.rest[node] * slope.transpose(), x += (b.rest[node] + u) * slope.transpose();
    }
    const Mat3 F = x * X.inverse();
    G[g] = 0.5 * (F.transpose() * F - Mat3::Identity());
    J[g] = F.determinant();
    mean_J += J[g] / geometry::kTetPoints;
  }
  const double mu = b.E / (2 * (1 + b.nu)), lambda = b.E * b.nu / ((1 + b.nu) * (1 - 2 * b.nu));
  Stress at[geometry::kTetPoints], mean = Stress::Zero();
  for (int g = 0; g < geometry::kTetPoints; ++g) {
    const Mat3 S = lambda * std::log(b.averaged ? mean_J : J[g]) * Mat3::Identity() + 2 * mu * G[g];
    at[g] << S(0, 0), S(1, 1), S(2, 2), S(0, 1), S(1, 2), S(2, 0);
    mean += at[g] / geometry::kTetPoints;
  }
  // The points lie on the way from the middle to the corners.
  double l[4];
  geometry::tet_point(0, l);
  const double beyond = 0.75 / (l[0] - 0.25);
  Corners out;
  for (int k = 0; k < 4; ++k) out[k] = mean + beyond * (at[k] - mean);
  return out;
}

double StressError::of(std::span<const double> stress, std::span<const double> displacement, const std::vector<std::size_t>& group) const {
  struct Energy {
    double missed = 0, all = 0;
  };
  std::map<std::size_t, Energy> groups;
  for (const Body& b : bodies_) {
    Energy& of = groups[group[b.number]];
    if (!b.midsides.empty() && displacement.size() < 3 * (b.first_point + b.nodes)) continue;
    std::vector<Corners> here(b.tets.size());
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
      for (int k = 0; k < 4; ++k) smooth[k] = mean[b.tets[t].v[k]], jump[k] = b.held[t] ? smooth[k] : Stress(smooth[k] - here[t][k]);
      of.missed += b.volume[t] * mean_of_linear(jump, b.E, b.nu);
      of.all += b.volume[t] * mean_of_linear(smooth, b.E, b.nu);
    }
  }
  double most = 0, worst = NAN;
  for (const auto& [number, of] : groups) most = std::max(most, of.all);
  for (const auto& [number, of] : groups)
    if (of.all > 0 && of.all >= tuning::kCounts * tuning::kCounts * most) worst = std::fmax(worst, of.missed / (of.missed + of.all));
  return worst;
}

}  // namespace mortise::run
