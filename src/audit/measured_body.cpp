#include "audit/measured_body.h"

#include <Eigen/Geometry>

#include "audit/nearest_affine.h"
#include "geometry/rigid_motion.h"
#include "geometry/topology.h"

namespace mortise::audit {

MeasuredBody::MeasuredBody(const model::BodyInput& b, std::size_t first_point)
    : name(b.name), first(first_point), count(b.nodes.size()), tets_(b.tets), triangles_(b.triangles), mass_(b.nodes.size(), 0.0) {
  if (soft()) {
    density_ = b.material.number("density");
    for (const Tet& t : tets_) {
      const double volume = geometry::tet_volume(b.nodes, t);
      volume_ += volume, tet_mass_.push_back(density_ * volume);
      for (Index v : t.v) mass_[v] += density_ * volume / 4;
    }
    return;
  }
  const model::StiffMass stiff = model::stiff_mass(b);
  volume_ = stiff.volume;
  density_ = b.params.has("mass") ? stiff.mass / stiff.volume : b.material.number("density");
  if (b.params.has("inertia")) stated_ = stiff, rest_ = b.nodes;
}

double MeasuredBody::volume_at(const std::vector<double>& points) const {
  if (!soft()) return geometry::mass_properties(surface(points)).volume;
  double sum = 0;
  for (const Tet& t : tets_) {
    const Vec3 x = at(points, first + t.v[0]);
    sum += (at(points, first + t.v[1]) - x).cross(at(points, first + t.v[2]) - x).dot(at(points, first + t.v[3]) - x) / 6;
  }
  return sum;
}

Vec3 MeasuredBody::mean(const std::vector<double>& values, const std::vector<double>& points) const {
  if (soft()) {
    Vec3 sum = Vec3::Zero();
    double total = 0;
    for (std::size_t i = 0; i < count; ++i) sum += mass_[i] * at(values, first + i), total += mass_[i];
    return sum / total;
  }
  if (stated_) return affine(values).row(0).transpose();
  // The affine map from points to values, at the centroid.
  const Vec3 centre = geometry::mass_properties(surface(points)).centroid;
  return nearest_affine(
             count, [&](std::size_t i) { return Vec3(at(points, first + i) - centre); }, [&](std::size_t i) { return at(values, first + i); })
      .row(0)
      .transpose();
}

// Of values that are affine in the place at rest: the value at the centre of mass, and its slopes.
Eigen::Matrix<double, 4, 3> MeasuredBody::affine(const std::vector<double>& values) const {
  return nearest_affine(
      count, [&](std::size_t i) { return Vec3(rest_[i] - stated_->centre); }, [&](std::size_t i) { return at(values, first + i); });
}

Vec3 MeasuredBody::sum(const std::vector<double>& values) const {
  Vec3 s = Vec3::Zero();
  for (std::size_t i = 0; i < count; ++i) s += at(values, first + i);
  return s;
}

double MeasuredBody::radius(const Vec3& centre, const std::vector<double>& points) const {
  double most = 0;
  for (std::size_t i = first; i < first + count; ++i) most = std::max(most, (at(points, i) - centre).norm());
  return most;
}

Vec3 MeasuredBody::rotation(const std::vector<double>& start, const std::vector<double>& points) const {
  std::vector<Vec3> from, to;
  for (std::size_t i = first; i < first + count; ++i) from.push_back(at(start, i)), to.push_back(at(points, i));
  const Eigen::AngleAxisd turn(geometry::nearest_motion(from, to).R);
  return turn.angle() * turn.axis();
}

Vec3 MeasuredBody::spin(const std::vector<double>& velocity, const std::vector<double>& points) const {
  std::vector<Vec3> x, v;
  for (std::size_t i = first; i < first + count; ++i) x.push_back(at(points, i)), v.push_back(at(velocity, i));
  return geometry::nearest_velocity(x, v).w;
}

double MeasuredBody::kinetic_energy(const std::vector<double>& velocity, const std::vector<double>& points) const {
  if (!soft()) return 0.5 * mass() * mean(velocity, points).squaredNorm() + turning_energy(velocity, points);
  double twice = 0;
  for (std::size_t t = 0; t < tets_.size(); ++t) {
    Vec3 total = Vec3::Zero();
    double squares = 0;
    for (Index v : tets_[t].v) {
      const Vec3 w = at(velocity, first + v);
      total += w, squares += w.squaredNorm();
    }
    twice += tet_mass_[t] / 20 * (squares + total.squaredNorm());
  }
  return 0.5 * twice;
}

// The body is cut into tetrahedra from the mean of its points, where the velocity, being linear in space, is the mean of theirs.
double MeasuredBody::turning_energy(const std::vector<double>& velocity, const std::vector<double>& points) const {
  if (stated_) {  // 1/2 tr(B^T S B), B the slopes of the velocity, S = int rho X X^T
    const Mat3 B = affine(velocity).bottomRows<3>();
    return 0.5 * (B.transpose() * stated_->second_moment * B).trace();
  }
  const Vec3 x = sum(points) / static_cast<double>(count), v = sum(velocity) / static_cast<double>(count);
  double twice = 0;
  for (const Triangle& t : triangles_) {
    Vec3 r[3], total = Vec3::Zero();
    double squares = 0;
    for (int k = 0; k < 3; ++k) {
      r[k] = at(points, first + t.v[k]) - x;
      const Vec3 w = at(velocity, first + t.v[k]) - v;
      total += w, squares += w.squaredNorm();
    }
    twice += density_ * r[0].cross(r[1]).dot(r[2]) / 6 / 20 * (squares + total.squaredNorm());
  }
  return 0.5 * twice;
}

geometry::TriMesh MeasuredBody::surface(const std::vector<double>& points) const {
  geometry::TriMesh mesh;
  for (std::size_t i = 0; i < count; ++i) mesh.points.push_back(at(points, first + i));
  mesh.triangles = triangles_;
  return mesh;
}

}  // namespace mortise::audit
