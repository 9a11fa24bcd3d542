#include "study/goal_error.h"

#include <algorithm>

#include "run/held_points.h"
#include "run/volumetric.h"
#include "study/tuning.h"

namespace mortise::study {
namespace {

using Stress = Eigen::Matrix<double, 6, 1>;

// a : C^-1 : b
double product(const Stress& a, const Stress& b, double E, double nu) {
  const double traces = a.head<3>().sum() * b.head<3>().sum(), full = a.head<3>().dot(b.head<3>()) + 2 * a.tail<3>().dot(b.tail<3>());
  return ((1 + nu) * full - nu * traces) / E;
}

// Mean over a tetrahedron of the product of linear fields with these values at its corners.
double mean_of_product(const Stress (&a)[4], const Stress (&b)[4], double E, double nu) {
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

// What averages at nodes differ from each element's stress by, at its corners.
template <class Body>
std::vector<std::array<Stress, 4>> jumps(const Body& b, const std::vector<Stress>& of) {
  std::vector<Stress> mean(b.nodes, Stress::Zero());
  std::vector<double> weight(b.nodes, 0.0);
  for (std::size_t t = 0; t < b.tets.size(); ++t)
    for (Index v : b.tets[t].v) mean[v] += b.volume[t] * of[t], weight[v] += b.volume[t];
  std::vector<std::array<Stress, 4>> out(b.tets.size());
  for (std::size_t t = 0; t < b.tets.size(); ++t)
    for (int k = 0; k < 4; ++k) out[t][k] = mean[b.tets[t].v[k]] / weight[b.tets[t].v[k]] - of[t];
  return out;
}

}  // namespace

GoalError::GoalError(const model::ModelInput& input) {
  const std::vector<bool> held = run::held_points(input);
  std::size_t cell = 0, point = 0;
  for (const model::BodyInput& in : input.bodies) {
    if (in.type == model::BodyType::half_space) continue;
    if (in.type == model::BodyType::soft) {
      if (!in.midsides.empty())
        why_not_ = "'" + in.name + "' has quadratic elements";
      else if (run::volumetric(in) != "full")
        why_not_ = "the change of volume of '" + in.name + "' is averaged, and stresses say less";
      Body b{cell, point, in.nodes.size(), in.tets, {}, {}, in.material.number("youngs_modulus"), in.material.number("poisson_ratio")};
      double all = 0, blind = 0;  // volumes: of all elements, and of those without a free node
      for (const Tet& t : in.tets) {
        Mat3 edges;
        for (int k = 0; k < 3; ++k) edges.col(k) = in.nodes[t.v[k + 1]] - in.nodes[t.v[0]];
        b.volume.push_back(edges.determinant() / 6);
        b.inverse.push_back(edges.inverse());
        all += b.volume.back();
        if (std::all_of(std::begin(t.v), std::end(t.v), [&](Index v) { return held[point + static_cast<std::size_t>(v)]; })) blind += b.volume.back();
      }
      if (blind > tuning::kBlind * all)
        why_not_ = "elements of '" + in.name + "' have no free node, and their stresses tell nothing: use a finer mesh";
      b.one_sided = run::one_sided(held, point, in.nodes.size());
      bodies_.push_back(std::move(b));
    }
    cell += in.type == model::BodyType::soft ? in.tets.size() : in.triangles.size();
    point += in.nodes.size();
  }
}

double GoalError::of(std::span<const double> stress, std::span<const double> z) const {
  double sum = 0;
  for (const Body& b : bodies_) {
    std::vector<Stress> of_u, of_z;
    for (std::size_t t = 0; t < b.tets.size(); ++t) {
      const auto at = [&](int k) { return Vec3(Eigen::Map<const Vec3>(z.data() + 3 * (b.first_point + b.tets[t].v[k]))); };
      Mat3 edges;
      for (int k = 0; k < 3; ++k) edges.col(k) = at(k + 1) - at(0);
      of_z.push_back(linear_stress(edges * b.inverse[t], b.E, b.nu));
      of_u.emplace_back(Eigen::Map<const Stress>(stress.data() + 6 * (b.first_cell + t)));
    }
    const auto jump_u = jumps(b, of_u), jump_z = jumps(b, of_z);
    for (std::size_t t = 0; t < b.tets.size(); ++t) {
      Stress u[4], v[4];
      for (int k = 0; k < 4; ++k) u[k] = jump_u[t][k], v[k] = jump_z[t][k];
      sum += b.one_sided * b.volume[t] * mean_of_product(u, v, b.E, b.nu);
    }
  }
  return -sum;
}

}  // namespace mortise::study
