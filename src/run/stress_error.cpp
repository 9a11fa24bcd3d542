#include "run/stress_error.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "geometry/quadratic.h"
#include "linalg/small.h"
#include "model/volumetric.h"
#include "run/held_points.h"
#include "run/tuning.h"
#include "run/vector_at.h"

namespace mortise::run {
namespace {

using Stress = StressError::Stress;

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
      const Params* law = in.material.find("model");
      Body b{number,
             cell,
             point,
             in.tets,
             in.midsides,
             in.nodes,
             {},
             {},
             in.material.number("youngs_modulus"),
             in.material.number("poisson_ratio"),
             quadratic && model::averages_volume(in),
             !law || law->as_text() != "linear"};
      for (const Tet& t : in.tets) {
        Mat3 edges;
        for (int k = 0; k < 3; ++k) edges.col(k) = in.nodes[t.v[k + 1]] - in.nodes[t.v[0]];
        b.volume.push_back(edges.determinant() / 6);
        const auto held_there = [&](Index node) { return held[point + static_cast<std::size_t>(node)]; };
        const std::size_t tet = b.volume.size() - 1;
        b.held.push_back(std::all_of(std::begin(t.v), std::end(t.v), held_there) &&
                         (!quadratic || std::all_of(std::begin(in.midsides[tet].v), std::end(in.midsides[tet].v), held_there)));
      }
      b.one_across = quadratic && model::one_across(in);
      if (quadratic ? b.one_across : !model::averages_volume(in)) b.one_sided = one_sided(held, point, in.nodes.size());
      if (BubbleError::counts_for(in)) b.bubbles.emplace(input, in);
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

// R of F = R U.
Mat3 StressError::turn(const Body& b, std::size_t tet, std::span<const double> displacement) {
  Mat3 edges, moved;
  const Index* v = b.tets[tet].v;
  const auto u = [&](Index node) { return at(displacement, b.first_point + static_cast<std::size_t>(node)); };
  for (int k = 0; k < 3; ++k) edges.col(k) = b.rest[v[k + 1]] - b.rest[v[0]], moved.col(k) = u(v[k + 1]) - u(v[0]);
  const linalg::Svd3 svd = linalg::svd3(Mat3(Mat3::Identity() + moved * edges.inverse()));
  return svd.U * svd.V.transpose();
}

StressError::Stresses StressError::stresses(std::span<const double> stress, std::span<const double> displacement) const {
  Stresses out;
  for (const Body& b : bodies_) {
    std::vector<Corners>& here = out.emplace_back();
    const bool moves = displacement.size() >= 3 * (b.first_point + b.rest.size());
    if (!b.midsides.empty() && !moves) continue;
    for (std::size_t t = 0; t < b.tets.size(); ++t) {
      if (!b.midsides.empty()) {
        here.push_back(of_quadratic(b, t, displacement));
        continue;
      }
      Stress s = Eigen::Map<const Stress>(stress.data() + 6 * (b.first_cell + t));
      if (b.turns && moves) {
        const Mat3 R = turn(b, t, displacement);
        Mat3 S;
        S << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
        S = R.transpose() * S * R;
        s << S(0, 0), S(1, 1), S(2, 2), S(0, 1), S(1, 2), S(2, 0);
      }
      here.emplace_back().fill(s);
    }
  }
  return out;
}

StressError::Stresses StressError::change(Stresses after, const Stresses& before) {
  for (std::size_t b = 0; b < after.size(); ++b)
    for (std::size_t t = 0; t < std::min(after[b].size(), before[b].size()); ++t)
      for (int k = 0; k < 4; ++k) after[b][t][k] -= before[b][t][k];
  return after;
}

StressError::Estimate StressError::of(const Stresses& stresses, const std::vector<std::size_t>& group, std::span<const double> contact_force,
                                      std::span<const double> displacement) const {
  struct Energy {
    double missed = 0, all = 0;
  };
  std::map<std::size_t, Energy> groups;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const Body& b = bodies_[i];
    const std::vector<Corners>& here = stresses[i];
    Energy of;
    const std::size_t first = 3 * b.first_point, count = 3 * b.rest.size();
    const bool bubbles = b.bubbles && displacement.size() >= first + count;
    if (here.empty()) continue;
    std::vector<Stress> mean(b.rest.size(), Stress::Zero());
    std::vector<double> weight(b.rest.size(), 0.0);
    for (std::size_t t = 0; t < b.tets.size(); ++t)
      for (int k = 0; k < 4; ++k) mean[b.tets[t].v[k]] += b.volume[t] * here[t][k], weight[b.tets[t].v[k]] += b.volume[t];
    for (std::size_t n = 0; n < mean.size(); ++n)
      if (weight[n] > 0) mean[n] /= weight[n];
    for (std::size_t t = 0; t < b.tets.size(); ++t) {
      const bool held = b.held[t] && !bubbles;
      Stress smooth[4], jump[4];
      for (int k = 0; k < 4; ++k) smooth[k] = mean[b.tets[t].v[k]], jump[k] = held ? smooth[k] : Stress(smooth[k] - here[t][k]);
      of.missed += (held ? 1 : b.one_sided) * b.volume[t] * mean_of_linear(jump, b.E, b.nu);
      of.all += b.volume[t] * mean_of_linear(smooth, b.E, b.nu);
      if (!b.one_across) continue;
      Stress within[4];
      for (int k = 0; k < 4; ++k) within[k] = here[t][k] - (here[t][0] + here[t][1] + here[t][2] + here[t][3]) / 4;
      of.missed += tuning::kWithin * b.one_sided * b.volume[t] * mean_of_linear(within, b.E, b.nu);
    }
    if (bubbles) {
      std::vector<Stress> constant;
      for (const Corners& c : here) constant.push_back(c[0]);
      const double share =
          b.bubbles->of(constant, contact_force.empty() ? contact_force : contact_force.subspan(first, count), displacement.subspan(first, count));
      of.missed = std::max(of.missed, share / (1 - share) * of.all);
    }
    groups[group[b.number]].missed += of.missed, groups[group[b.number]].all += of.all;
  }
  Estimate out;
  for (const auto& [number, of] : groups) out.energy = std::max(out.energy, of.all);
  for (const auto& [number, of] : groups)
    if (of.all > 0 && of.all >= tuning::kCounts * tuning::kCounts * out.energy) out.errors[number] = of.missed / (of.missed + of.all);
  return out;
}

double StressError::Estimate::error() const {
  double worst = NAN;
  for (const auto& [group, error] : errors) worst = std::fmax(worst, error);
  return worst;
}

}  // namespace mortise::run
