#include "audit/stress_error.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "audit/nearest_affine.h"
#include "audit/tuning.h"
#include "audit/vector_at.h"
#include "geometry/quadratic.h"
#include "geometry/rigid_motion.h"
#include "linalg/small.h"
#include "model/held_points.h"
#include "model/volumetric.h"

namespace mortise::audit {
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

// Means of u over slices across the principal axes of some points: what bulges alike to all sides moves none of them.
std::vector<Vec3> means_of_slices(const std::vector<Vec3>& points, const std::vector<Vec3>& u) {
  const Vec3 centre = geometry::mean(points);
  Mat3 spread = Mat3::Zero(), axes;
  for (const Vec3& x : points) spread += (x - centre) * (x - centre).transpose();
  linalg::jacobi_eigen<3>(spread, axes);
  std::vector<Vec3> out;
  for (int i = 0; i < 3; ++i) {
    std::vector<double> along;
    for (const Vec3& x : points) along.push_back(axes.col(i).dot(x - centre));
    const auto [low, high] = std::minmax_element(along.begin(), along.end());
    if (!(*high > *low)) continue;
    std::array<Vec3, tuning::kSlices> sum;
    std::array<double, tuning::kSlices> count{};
    sum.fill(Vec3::Zero());
    for (std::size_t n = 0; n < points.size(); ++n) {
      const auto slice = std::min<std::size_t>(tuning::kSlices - 1, static_cast<std::size_t>(tuning::kSlices * (along[n] - *low) / (*high - *low)));
      sum[slice] += u[n], ++count[slice];
    }
    for (std::size_t s = 0; s < sum.size(); ++s)
      if (count[s] > 0) out.push_back(sum[s] / count[s]);
  }
  return out;
}

}  // namespace

StressError::StressError(const model::ModelInput& input) {
  const std::vector<bool> held = model::held_points(input);
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
      for (std::size_t n = 0; n < in.nodes.size(); ++n)
        if (held[point + n]) b.fixed.push_back(n);
      b.one_across = quadratic && model::one_across(in);
      if (quadratic ? b.one_across : !model::averages_volume(in)) b.one_sided = model::one_sided(held, point, in.nodes.size());
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
  const double mu = b.E / (2 * (1 + b.nu));
  const model::Lambda lambda = model::lambda_of(b.E, b.nu, b.averaged, true);
  Stress at[geometry::kTetPoints], mean = Stress::Zero();
  for (int g = 0; g < geometry::kTetPoints; ++g) {
    const Mat3 S = (lambda.at_points * std::log(J[g]) + lambda.of_mean * std::log(mean_J)) * Mat3::Identity() + 2 * mu * G[g];
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

geometry::Motion StressError::base(const Body& b, std::span<const double> displacement) {
  std::vector<Vec3> from, to;
  const auto moved = [&](std::size_t n) { return Vec3(b.rest[n] + at(displacement, b.first_point + n)); };
  for (const std::size_t n : b.fixed) from.push_back(b.rest[n]), to.push_back(moved(n));
  const bool turned = geometry::fixes_a_frame(from);
  for (std::size_t n = 0; n < b.rest.size() && !turned; ++n) from.push_back(b.rest[n]), to.push_back(moved(n));
  return geometry::nearest_motion(from, to);
}

Mat3 StressError::stretch(const Body& b, std::span<const double> displacement) {
  const auto place = [&](std::size_t n) { return Vec3(b.rest[n] - b.rest.front()); };
  const Eigen::Matrix<double, 4, 3> affine = nearest_affine(b.rest.size(), place, [&](std::size_t n) { return at(displacement, b.first_point + n); });
  const linalg::Svd3 svd = linalg::svd3(Mat3::Identity() + affine.bottomRows<3>().transpose());
  const Mat3 U = svd.V * svd.s.asDiagonal() * svd.V.transpose();
  std::vector<Vec3> held, stretched;
  for (const std::size_t n : b.fixed) held.push_back(place(n)), stretched.push_back(U * held.back());
  return geometry::nearest_motion_of_any(stretched, held).R * U - Mat3::Identity();
}

double StressError::bent(const Body& b, const geometry::Motion& base, const Mat3& stretch, std::span<const double> displacement) {
  std::vector<Vec3> seen, beside;
  for (std::size_t n = 0; n < b.rest.size(); ++n) {
    seen.push_back(base.R.transpose() * (b.rest[n] + at(displacement, b.first_point + n) - base.t) - b.rest[n]);
    beside.push_back(seen.back() - stretch * (b.rest[n] - b.rest.front()));
  }
  std::vector<Vec3> where_held;
  for (const std::size_t n : b.fixed) where_held.push_back(beside[n]);
  const Vec3 held = geometry::mean(b.fixed.empty() ? beside : where_held);
  double most = 0, bent = 0;
  for (const Vec3& u : seen) most = std::max(most, u.norm());
  for (const Vec3& u : means_of_slices(b.rest, beside)) bent = std::max(bent, (u - held).norm());
  return bent > tuning::kLeastBent * most ? std::min(bent / (tuning::kNotAffine * most), 1.0) : 0;
}

double StressError::worked(const Body& b, const geometry::Motion& base, const Mat3& stretch, const Stress& s, std::span<const double> displacement) {
  const auto moved = [&](std::size_t n) { return Vec3(b.rest[n] + at(displacement, b.first_point + n)); };
  const Mat3 back = base.R.transpose();
  Mat3 m;
  m << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
  double sum = 0;
  for (std::size_t t = 0; t < b.tets.size(); ++t) {
    Mat3 edges, now;
    const auto node = [&](int k) { return static_cast<std::size_t>(b.tets[t].v[k]); };
    for (int k = 0; k < 3; ++k) edges.col(k) = b.rest[node(k + 1)] - b.rest[node(0)], now.col(k) = moved(node(k + 1)) - moved(node(0));
    const Mat3 H = back * now * edges.inverse() - Mat3::Identity() - stretch;
    sum += 0.5 * b.volume[t] * m.cwiseProduct(H.transpose() * H).sum();
  }
  return sum;
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

// Of quadratic tetrahedra: has it a node that something presses, or share a corner with one that has?
std::vector<bool> StressError::near_pressed(const Body& b, std::span<const double> contact_force) {
  const auto pressed = [&](Index n) { return !at(contact_force, b.first_point + static_cast<std::size_t>(n)).isZero(0); };
  std::vector<bool> near(b.rest.size(), false), out;
  for (std::size_t t = 0; t < b.tets.size(); ++t)
    if (std::any_of(std::begin(b.tets[t].v), std::end(b.tets[t].v), pressed) ||
        std::any_of(std::begin(b.midsides[t].v), std::end(b.midsides[t].v), pressed))
      for (const Index n : b.tets[t].v) near[n] = true;
  for (const Tet& t : b.tets) out.push_back(std::any_of(std::begin(t.v), std::end(t.v), [&](Index n) { return near[n]; }));
  return out;
}

StressError::Energy StressError::energy_of(const Body& b, const std::vector<Corners>& here, std::span<const double> contact_force,
                                           std::span<const double> displacement) {
  Energy out;
  const std::size_t first = 3 * b.first_point, count = 3 * b.rest.size();
  const bool bubbles = b.bubbles && displacement.size() >= first + count;
  std::vector<Stress> mean(b.rest.size(), Stress::Zero());
  std::vector<double> weight(b.rest.size(), 0.0);
  Stress uniform = Stress::Zero();
  double volume = 0;
  for (std::size_t t = 0; t < b.tets.size(); ++t)
    for (int k = 0; k < 4; ++k) mean[b.tets[t].v[k]] += b.volume[t] * here[t][k], weight[b.tets[t].v[k]] += b.volume[t];
  for (std::size_t n = 0; n < mean.size(); ++n)
    if (weight[n] > 0) mean[n] /= weight[n];
  const std::vector<bool> pressed = b.midsides.empty() || contact_force.size() < first + count ? std::vector<bool>() : near_pressed(b, contact_force);
  for (std::size_t t = 0; t < b.tets.size(); ++t) {
    const bool held = b.held[t] && !bubbles;
    Stress smooth[4], jump[4];
    for (int k = 0; k < 4; ++k) smooth[k] = mean[b.tets[t].v[k]], jump[k] = held ? smooth[k] : Stress(smooth[k] - here[t][k]);
    out.missed += (held ? 1 : b.one_sided * (!pressed.empty() && pressed[t] ? tuning::kPressed : 1)) * b.volume[t] * mean_of_linear(jump, b.E, b.nu);
    out.all += b.volume[t] * mean_of_linear(smooth, b.E, b.nu);
    uniform += b.volume[t] / 4 * (smooth[0] + smooth[1] + smooth[2] + smooth[3]), volume += b.volume[t];
    if (!b.one_across) continue;
    Stress within[4];
    for (int k = 0; k < 4; ++k) within[k] = here[t][k] - (here[t][0] + here[t][1] + here[t][2] + here[t][3]) / 4;
    out.missed += (b.averaged ? tuning::kWithinOfMeans : tuning::kWithin) * b.one_sided * b.volume[t] * mean_of_linear(within, b.E, b.nu);
  }
  if (bubbles) {
    std::vector<Stress> constant;
    for (const Corners& c : here) constant.push_back(c[0]);
    const double share =
        b.bubbles->of(constant, contact_force.empty() ? contact_force : contact_force.subspan(first, count), displacement.subspan(first, count));
    out.missed = std::max(out.missed, share / (1 - share) * out.all);
  }
  if (displacement.size() < first + count || !(volume > 0)) return out;
  uniform /= volume;
  const double varying = out.all - volume * energy_density(uniform, b.E, b.nu);
  if (!(varying > 0)) return out;
  const geometry::Motion base = StressError::base(b, displacement);
  const Mat3 stretch = StressError::stretch(b, displacement);
  out.bent = bent(b, base, stretch, displacement);
  if (out.bent == 0) return out;
  out.left = std::clamp(1 + worked(b, base, stretch, uniform, displacement) / varying, 1 / tuning::kAmplified, 1.0);
  out.varying = varying < tuning::kHidden * out.all ? varying : out.all;
  return out;
}

StressError::Estimate StressError::of(const Stresses& stresses, const std::vector<std::size_t>& group, std::span<const double> contact_force,
                                      std::span<const double> displacement) const {
  std::map<std::size_t, Energy> groups;
  std::vector<Energy> bodies(bodies_.size());
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (stresses[i].empty()) continue;
    bodies[i] = energy_of(bodies_[i], stresses[i], contact_force, displacement);
    Energy& of = groups[group[bodies_[i].number]];
    of.missed += bodies[i].missed, of.all += bodies[i].all;
  }
  Estimate out;
  for (const auto& [number, of] : groups) out.energy = std::max(out.energy, of.all);
  const auto counts = [&](double energy) { return energy > 0 && energy >= tuning::kCounts * tuning::kCounts * out.energy; };
  for (const auto& [number, of] : groups)
    if (counts(of.all)) out.errors[number] = of.missed / (of.missed + of.all);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Energy& of = bodies[i];
    if (!counts(of.varying)) continue;
    double& error = out.bending[group[bodies_[i].number]];
    error = std::max(error, of.bent * of.missed / (of.missed + of.left * of.varying));
  }
  return out;
}

double StressError::Estimate::error() const {
  double worst = NAN;
  for (const auto& [group, error] : errors) worst = std::fmax(worst, error);
  return worst;
}

}  // namespace mortise::audit
