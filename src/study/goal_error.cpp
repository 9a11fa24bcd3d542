#include "study/goal_error.h"

#include "run/volumetric.h"

namespace mortise::study {
namespace {

using run::CornerStress;
using run::Stress;

// a : C^-1 : b
double product(const Stress& a, const Stress& b, double E, double nu) {
  const double traces = a.head<3>().sum() * b.head<3>().sum(), full = a.head<3>().dot(b.head<3>()) + 2 * a.tail<3>().dot(b.tail<3>());
  return ((1 + nu) * full - nu * traces) / E;
}

// Mean over a tetrahedron of the product of linear fields with these values at its corners.
double mean_of_product(const CornerStress& a, const CornerStress& b, double E, double nu) {
  Stress sum_a = Stress::Zero(), sum_b = Stress::Zero();
  double mean = 0;
  for (int k = 0; k < 4; ++k) sum_a += a[k], sum_b += b[k], mean += product(a[k], b[k], E, nu);
  return (mean + product(sum_a, sum_b, E, nu)) / 20;
}

Stress linear_stress(const Mat3& gradient, double E, double nu) {
  const double mu = E / (2 * (1 + nu)), lambda = E * nu / ((1 + nu) * (1 - 2 * nu));
  const Mat3 e = 0.5 * (gradient + gradient.transpose()), s = 2 * mu * e + lambda * e.trace() * Mat3::Identity();
  return (Stress() << s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(1, 2), s(2, 0)).finished();
}

// What averages at corners differ from each element's stress by, there.
template <class Body>
std::vector<CornerStress> jumps(const Body& b, const std::vector<CornerStress>& of) {
  std::vector<Stress> mean(b.rest.size(), Stress::Zero());
  std::vector<double> weight(b.rest.size(), 0.0);
  for (std::size_t t = 0; t < b.tets.size(); ++t)
    for (int k = 0; k < 4; ++k) mean[b.tets[t].v[k]] += b.volume[t] * of[t][k], weight[b.tets[t].v[k]] += b.volume[t];
  std::vector<CornerStress> out(b.tets.size());
  for (std::size_t t = 0; t < b.tets.size(); ++t)
    for (int k = 0; k < 4; ++k) out[t][k] = mean[b.tets[t].v[k]] / weight[b.tets[t].v[k]] - of[t][k];
  return out;
}

}  // namespace

GoalError::GoalError(const model::ModelInput& input) {
  std::size_t cell = 0, point = 0;
  for (const model::BodyInput& in : input.bodies) {
    if (in.type == model::BodyType::half_space) continue;
    if (in.type == model::BodyType::soft) {
      if (run::volumetric(in) != "full")
        why_not_ = "the change of volume of '" + in.name + "' is averaged, and stresses say less";
      Body b{cell, point, in.nodes, in.tets, in.midsides, {}, {}, {in.material.number("youngs_modulus"), in.material.number("poisson_ratio")}};
      for (const Tet& t : in.tets) {
        Mat3 edges;
        for (int k = 0; k < 3; ++k) edges.col(k) = in.nodes[t.v[k + 1]] - in.nodes[t.v[0]];
        b.volume.push_back(edges.determinant() / 6);
        b.inverse.push_back(edges.inverse());
      }
      bodies_.push_back(std::move(b));
    }
    cell += in.type == model::BodyType::soft ? in.tets.size() : in.triangles.size();
    point += in.nodes.size();
  }
}

double GoalError::of(std::span<const double> stress, std::span<const double> points, std::span<const double> z) const {
  double sum = 0;
  for (const Body& b : bodies_) {
    std::vector<CornerStress> of_u(b.tets.size()), of_z(b.tets.size());
    for (std::size_t t = 0; t < b.tets.size(); ++t) {
      const auto at = [&](std::span<const double> of, Index v) -> Vec3 { return Eigen::Map<const Vec3>(of.data() + 3 * (b.first_point + v)); };
      if (b.midsides.empty()) {
        Mat3 edges;
        for (int k = 0; k < 3; ++k) edges.col(k) = at(z, b.tets[t].v[k + 1]) - at(z, b.tets[t].v[0]);
        of_z[t].fill(linear_stress(edges * b.inverse[t], b.material.E, b.material.nu));
        of_u[t].fill(Eigen::Map<const Stress>(stress.data() + 6 * (b.first_cell + t)));
        continue;
      }
      std::array<Vec3, 10> rest, moved, way;
      for (int k = 0; k < 10; ++k) {
        const Index v = k < 4 ? b.tets[t].v[k] : b.midsides[t].v[k - 4];
        rest[k] = b.rest[v], moved[k] = at(points, v) - b.rest[v], way[k] = at(z, v);
      }
      of_u[t] = run::stress_of_quadratic(rest, moved, b.material);
      of_z[t] = run::linear_stress_of_quadratic(rest, way, b.material);
    }
    const std::vector<CornerStress> jump_u = jumps(b, of_u), jump_z = jumps(b, of_z);
    for (std::size_t t = 0; t < b.tets.size(); ++t) sum += b.volume[t] * mean_of_product(jump_u[t], jump_z[t], b.material.E, b.material.nu);
  }
  return -sum;
}

}  // namespace mortise::study
