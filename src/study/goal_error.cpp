#include "study/goal_error.h"

#include <fmt/format.h>

#include <algorithm>

#include "audit/held_points.h"
#include "audit/vector_at.h"
#include "model/clusters.h"
#include "model/volumetric.h"
#include "study/tuning.h"

namespace mortise::study {

GoalError::GoalError(const model::ModelInput& input, std::span<const double> stress, std::span<const double> points) {
  const std::vector<bool> held = audit::held_points(input);
  std::size_t cell = 0, point = 0;
  double blindest = tuning::kBlind;
  for (const model::BodyInput& in : input.bodies) {
    if (in.type == model::BodyType::half_space) continue;
    if (!in.midsides.empty()) {
      why_not_ = "'" + in.name + "' has quadratic elements";
      return;
    }
    if (in.type == model::BodyType::soft) {
      const double E = in.material.number("youngs_modulus"), nu = in.material.number("poisson_ratio");
      const Params* law = in.material.find("model");
      const double mu = E / (2 * (1 + nu)), lambda = E * nu / ((1 + nu) * (1 - 2 * nu));
      Body b{cell, point, in.nodes.size(), in.tets, {}, {}, mu, lambda, law && law->as_text() == "linear", {}};
      for (const Tet& t : in.tets) {
        Mat3 edges;
        for (int k = 0; k < 3; ++k) edges.col(k) = in.nodes[t.v[k + 1]] - in.nodes[t.v[0]];
        b.volume.push_back(edges.determinant() / 6);
        b.inverse.push_back(edges.inverse());
      }
      if (model::averages_volume(in))
        b.cluster = model::star_clusters(in);
      else
        b.one_sided = audit::one_sided(held, point, in.nodes.size());
      const std::vector<Field> solution = of_solution(b, stress, points);
      double all = 0, blind = 0;  // energy, and that of elements without a free node [J]
      for (std::size_t t = 0; t < b.tets.size(); ++t) {
        const double energy = 0.5 * b.volume[t] * product(b, solution[t], solution[t]);
        const auto is_held = [&](Index v) { return held[point + static_cast<std::size_t>(v)]; };
        all += energy, blind += std::all_of(std::begin(b.tets[t].v), std::end(b.tets[t].v), is_held) ? energy : 0;
      }
      if (const double share = blind / all; share > blindest) {
        blindest = share;
        why_not_ =
            fmt::format("{:.2g} % of the energy of '{}' is in elements that have no free node, and their stresses tell nothing: use a finer mesh",
                        100 * share, in.name);
      }
      b.jump = jumps(b, solution);
      bodies_.push_back(std::move(b));
    }
    cell += in.type == model::BodyType::soft ? in.tets.size() : in.triangles.size();
    point += in.nodes.size();
  }
}

std::vector<Mat3> GoalError::gradients(const Body& b, std::span<const double> of) {
  std::vector<Mat3> out;
  for (std::size_t t = 0; t < b.tets.size(); ++t) {
    const auto at = [&](int k) { return audit::at(of, b.first_point + static_cast<std::size_t>(b.tets[t].v[k])); };
    Mat3 edges;
    for (int k = 0; k < 3; ++k) edges.col(k) = at(k + 1) - at(0);
    out.push_back(edges * b.inverse[t]);
  }
  return out;
}

// s = 2 mu e + p I
std::vector<GoalError::Field> GoalError::of_solution(const Body& b, std::span<const double> stress, std::span<const double> points) {
  std::vector<Field> out;
  const std::vector<Mat3> F = gradients(b, points);
  for (std::size_t t = 0; t < b.tets.size(); ++t) {
    Field& f = out.emplace_back();
    f << Eigen::Map<const Eigen::Matrix<double, 6, 1>>(stress.data() + 6 * (b.first_cell + t)), 0, 0;
    const double trace = f.head<3>().sum();
    f[6] = b.cluster.empty() ? trace / (2 * b.mu + 3 * b.lambda) : b.linear ? F[t].trace() - 3 : F[t].determinant() - 1;
    f[7] = (trace - 2 * b.mu * f[6]) / 3;
    f.head<3>().array() -= f[7];
    f.head<6>() /= 2 * b.mu;
  }
  return out;
}

std::vector<GoalError::Field> GoalError::of_adjoint(const Body& b, std::span<const double> z) {
  std::vector<Field> out;
  std::vector<double> sum(b.tets.size(), 0.0), volume = sum;  // of clusters
  const std::vector<Mat3> gradient = gradients(b, z);
  for (std::size_t t = 0; t < b.tets.size(); ++t) {
    const Mat3 e = 0.5 * (gradient[t] + gradient[t].transpose());
    out.emplace_back() << e(0, 0), e(1, 1), e(2, 2), e(0, 1), e(1, 2), e(2, 0), e.trace(), b.lambda * e.trace();
    if (!b.cluster.empty()) sum[b.cluster[t]] += b.volume[t] * e.trace(), volume[b.cluster[t]] += b.volume[t];
  }
  for (std::size_t t = 0; t < b.cluster.size(); ++t) out[t][7] = b.lambda * sum[b.cluster[t]] / volume[b.cluster[t]];
  return out;
}

// What averages at nodes differ from each element's values by, at its corners.
std::vector<GoalError::Corners> GoalError::jumps(const Body& b, const std::vector<Field>& of) {
  std::vector<Field> mean(b.nodes, Field::Zero());
  std::vector<double> weight(b.nodes, 0.0);
  for (std::size_t t = 0; t < b.tets.size(); ++t)
    for (Index v : b.tets[t].v) mean[v] += b.volume[t] * of[t], weight[v] += b.volume[t];
  std::vector<Corners> out(b.tets.size());
  for (std::size_t t = 0; t < b.tets.size(); ++t)
    for (int k = 0; k < 4; ++k) out[t][k] = mean[b.tets[t].v[k]] / weight[b.tets[t].v[k]] - of[t];
  return out;
}

double GoalError::product(const Body& b, const Field& u, const Field& z) {
  const double shear = u.head<3>().dot(z.head<3>()) + 2 * u.segment<3>(3).dot(z.segment<3>(3));
  return 2 * b.mu * shear + u[7] * z[6] + u[6] * z[7] - (b.lambda > 0 ? u[7] * z[7] / b.lambda : 0);
}

double GoalError::of(std::span<const double> z) const {
  double sum = 0;
  for (const Body& b : bodies_) {
    const std::vector<Corners>& u = b.jump;
    const std::vector<Corners> v = jumps(b, of_adjoint(b, z));
    for (std::size_t t = 0; t < b.tets.size(); ++t) {
      Field all_u = Field::Zero(), all_v = Field::Zero();  // the mean of a product of linear fields: (sum_k u_k v_k + sum_k u_k sum_k v_k) / 20
      double mean = 0;
      for (int k = 0; k < 4; ++k) all_u += u[t][k], all_v += v[t][k], mean += product(b, u[t][k], v[t][k]);
      sum += b.one_sided * b.volume[t] * (mean + product(b, all_u, all_v)) / 20;
    }
  }
  return -sum;
}

}  // namespace mortise::study
