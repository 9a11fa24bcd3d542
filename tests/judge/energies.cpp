#include <Eigen/Dense>
#include <algorithm>
#include <map>

#include "judge/clusters.h"
#include "judge/judge.h"

namespace judge {
namespace {

double lame_lambda(const Body& body) { return body.youngs_modulus * body.poisson_ratio / ((1 + body.poisson_ratio) * (1 - 2 * body.poisson_ratio)); }

// Density of elastic energy at the deformation gradient F (the laws as published, with the guard against inversion;
// src/effects/elasticity/README.md).
double elastic_density(const Body& body, double lambda, const Eigen::Matrix3d& F) {
  const double E = body.youngs_modulus, nu = body.poisson_ratio, mu = E / (2 * (1 + nu)), J = F.determinant();
  constexpr double kGuard = 0.1, kFlat = 1e-6;  // J_0, J_1
  const double x = (J - kFlat) / (kGuard - kFlat), guard = x < 1 ? -2 * mu * (1 - kFlat / kGuard) * (x - 1) * (x - 1) * std::log(x) : 0;
  if (body.law == "linear") {
    const Eigen::Matrix3d strain = 0.5 * (F + F.transpose()) - Eigen::Matrix3d::Identity();
    return mu * strain.squaredNorm() + lambda / 2 * strain.trace() * strain.trace() + guard;
  }
  if (body.law == "corotated") {
    Eigen::Vector3d stretch = Eigen::JacobiSVD<Eigen::Matrix3d>(F).singularValues();
    if (J < 0) stretch[2] *= -1;
    return mu * (stretch - Eigen::Vector3d::Ones()).squaredNorm() + lambda / 2 * (J - 1) * (J - 1) + guard;
  }
  const double m = 4.0 / 3 * mu, l = lambda + 5.0 / 6 * mu, alpha = 1 + 3 * m / (4 * l), I = F.squaredNorm();
  return m / 2 * (I - 3) - m / 2 * std::log((I + 1) / 4) + l / 2 * ((J - alpha) * (J - alpha) - (1 - alpha) * (1 - alpha)) + guard;
}

// groups: of tetrahedra that share the mean change of their volume; empty where each has its own.
double elastic_energy(const Body& body, const std::vector<long>& groups, const std::vector<Vector>& rest, const std::vector<Vector>& x) {
  const auto edges = [](const std::vector<Vector>& p, const std::array<long, 4>& t) {
    Eigen::Matrix3d D;
    for (int k = 0; k < 3; ++k)
      for (int i = 0; i < 3; ++i) D(i, k) = p[t[k + 1]][i] - p[t[0]][i];
    return D;
  };
  double sum = 0;
  std::map<long, std::pair<double, double>> change;  // of every group: its volume, and the integral of theta
  for (std::size_t i = 0; i < body.tets.size(); ++i) {
    const auto& t = body.tets[i];
    const Eigen::Matrix3d Dm = edges(rest, t), F = edges(x, t) * Dm.inverse();
    const double V = Dm.determinant() / 6;
    sum += V * elastic_density(body, groups.empty() ? lame_lambda(body) : 0, F);
    if (groups.empty()) continue;
    auto& [volume, theta] = change[groups[i]];
    volume += V, theta += V * (body.law == "linear" ? F.trace() - 3 : F.determinant() - 1);
  }
  for (const auto& [group, c] : change) sum += lame_lambda(body) / 2 * c.second * c.second / c.first;
  return sum;
}

// -m g . x of all mass, and the sum of its sizes; the mass of stiff bodies is cut into tetrahedra from the origin of the rest state.
void gravity_energy(const Case& c, const Body& body, const std::vector<Vector>& x, double& energy, double& size) {
  const auto add = [&](double mass, const std::vector<Vector>& corners) {
    for (const Vector& p : corners) energy -= mass / 4 * dot(c.gravity, p), size += std::abs(mass / 4 * dot(c.gravity, p));
  };
  for (const auto& t : body.tets)
    add(body.density * volume(c.rest[t[0]], c.rest[t[1]], c.rest[t[2]], c.rest[t[3]]), {x[t[0]], x[t[1]], x[t[2]], x[t[3]]});
  if (body.soft) return;
  if (body.spread) {
    const double own = body.spread->mass * dot(c.gravity, at_centre(*body.spread, body, c.rest, x));
    energy -= own, size += std::abs(own);
    return;
  }
  Vector rest{}, now{};  // the mean of the vertices moves with the affine map
  for (long p : body.points)
    for (int k = 0; k < 3; ++k) rest[k] += c.rest[p][k] / body.points.size(), now[k] += x[p][k] / body.points.size();
  for (const auto& t : body.triangles) add(body.density * volume(rest, c.rest[t[0]], c.rest[t[1]], c.rest[t[2]]), {now, x[t[0]], x[t[1]], x[t[2]]});
}

}  // namespace

void judge_elements(const Case& c, const std::vector<Vector>& x, long frame, Verdict& v) {
  for (const Body& body : c.bodies)
    for (const auto& t : body.tets) {
      const double det = volume(x[t[0]], x[t[1]], x[t[2]], x[t[3]]) / volume(c.rest[t[0]], c.rest[t[1]], c.rest[t[2]], c.rest[t[3]]);
      if (!(v.min_det_f <= det)) v.min_det_f = det;
      if (!(det > 0)) ++v.inverted, v.found(frame, "an element of " + body.name + " is inverted");
    }
}

// Kinetic energy and momentum. Soft: masses lumped at nodes where supports hold the body and do not turn it, else the velocity is linear in every
// tetrahedron. Stiff: the velocity is linear in space; a body filled evenly is cut into tetrahedra from the mean of its vertices, where the velocity
// is the mean of theirs, and integrated exactly.
void motion(const Body& body, const std::vector<Vector>& rest, const std::vector<Vector>& velocity, double& kinetic, Vector& momentum) {
  if (body.soft) {
    for (const auto& t : body.tets) {
      const double m = body.density * volume(rest[t[0]], rest[t[1]], rest[t[2]], rest[t[3]]);
      Vector sum{};
      double squares = 0;
      for (long p : t) {
        squares += dot(velocity[p], velocity[p]);
        for (int k = 0; k < 3; ++k) sum[k] += velocity[p][k];
      }
      kinetic += body.stays ? 0.5 * m / 4 * squares : 0.5 * m / 20 * (squares + dot(sum, sum));
      for (int k = 0; k < 3; ++k) momentum[k] += m / 4 * sum[k];
    }
    return;
  }
  if (body.spread) {
    double square = 0;
    momentum += body.spread->mass * at_centre(*body.spread, body, rest, velocity, &square);
    kinetic += 0.5 * square;
    return;
  }
  Vector x{}, v{};
  for (long p : body.points)
    for (int k = 0; k < 3; ++k) x[k] += rest[p][k] / body.points.size(), v[k] += velocity[p][k] / body.points.size();
  for (const auto& t : body.triangles) {
    const double m = body.density * volume(x, rest[t[0]], rest[t[1]], rest[t[2]]);
    Vector sum = v;
    double squares = dot(v, v);
    for (long p : t) {
      squares += dot(velocity[p], velocity[p]);
      for (int k = 0; k < 3; ++k) sum[k] += velocity[p][k];
    }
    kinetic += 0.5 * m / 20 * (squares + dot(sum, sum));
    for (int k = 0; k < 3; ++k) momentum[k] += m / 4 * sum[k];
  }
}

std::vector<Vector> frame_of(const std::vector<double>& all, long frame, std::size_t n) {
  std::vector<Vector> out(n);
  for (std::size_t i = 0; i < n; ++i)
    for (int k = 0; k < 3; ++k) out[i][k] = all.at(3 * (frame * n + i) + k);
  return out;
}

StoredEnergies::StoredEnergies(const File& file, const Case& c) : c_(c) {
  const bool linear_tets = std::none_of(c.bodies.begin(), c.bodies.end(), [](const Body& b) { return b.quadratic(); });
  if (!c.double_precision || !linear_tets) return;
  const std::string elastic = "/mortise/effects/elasticity/energy", gravity = "/mortise/effects/gravity/energy";
  for (const Body& body : c.bodies)  // at rest the terms of an energy density cancel
    for (const auto& t : body.tets) rounding_ += 1e-9 * body.youngs_modulus * volume(c.rest[t[0]], c.rest[t[1]], c.rest[t[2]], c.rest[t[3]]);
  for (const Body& body : c.bodies) groups_.push_back(body.mean_volume ? volume_groups(body) : std::vector<long>());
  if (file.has(elastic)) elastic_ = file.numbers(elastic);
  if (file.has(gravity)) gravity_ = file.numbers(gravity);
}

void StoredEnergies::judge(const std::vector<Vector>& x, long frame, Verdict& v) {
  if (!elastic_.empty()) {
    double sum = 0;
    for (std::size_t b = 0; b < c_.bodies.size(); ++b) sum += elastic_energy(c_.bodies[b], groups_[b], c_.rest, x);
    largest_ = std::max({largest_, std::abs(sum), std::abs(elastic_[frame]), rounding_});
    v.elastic_error = std::max(v.elastic_error, std::abs(sum - elastic_[frame]) / largest_);
  }
  if (!gravity_.empty()) {
    double sum = 0, size = 0;
    for (const Body& body : c_.bodies) gravity_energy(c_, body, x, sum, size);
    if (frame == 0) offset_ = sum - gravity_[0];  // the height of zero energy is arbitrary
    if (size > 0) v.gravity_error = std::max(v.gravity_error, std::abs(sum - offset_ - gravity_[frame]) / size);
  }
}

}  // namespace judge
