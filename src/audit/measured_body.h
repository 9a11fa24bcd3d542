#pragma once
// What is measured of one body from the points of a state: volume, means, spin, energy of turning.
#include <optional>
#include <string>
#include <vector>

#include "audit/vector_at.h"
#include "geometry/mesh.h"
#include "model/stiff_mass.h"

namespace mortise::audit {

// Mass and mesh of a body, and where its points are among all points. Fields have 3 numbers per point.
class MeasuredBody {
 public:
  // `first`: number of the body's first point among all.
  MeasuredBody(const model::BodyInput& input, std::size_t first);

  double volume_at(const std::vector<double>& points) const;
  // Mean over the mass of a field of vectors, which is affine on stiff bodies: there the value at the centre of mass.
  Vec3 mean(const std::vector<double>& values, const std::vector<double>& points) const;
  Vec3 sum(const std::vector<double>& values) const;
  double radius(const Vec3& centre, const std::vector<double>& points) const;  // of the farthest point
  // Of the rigid motion from `start` to `points` (least squares, all points alike): the angle along the axis [rad].
  Vec3 rotation(const std::vector<double>& start, const std::vector<double>& points) const;
  // Angular velocity of the rigid motion nearest to the points' velocities (least squares, all points alike).
  Vec3 spin(const std::vector<double>& velocity, const std::vector<double>& points) const;
  // Of velocities: of all that the body consists of [J].
  double kinetic_energy(const std::vector<double>& velocity, const std::vector<double>& points) const;
  // Kinetic energy (stiff) about the mean of the points; where the scene states the inertia, about the centre of mass.
  double turning_energy(const std::vector<double>& velocity, const std::vector<double>& points) const;

  std::string name;
  std::size_t first = 0, count = 0;
  bool soft() const { return !tets_.empty(); }
  double mass() const { return density_ * volume_; }
  double rest_volume() const { return volume_; }

 private:
  Eigen::Matrix<double, 4, 3> affine(const std::vector<double>& values) const;
  geometry::TriMesh surface(const std::vector<double>& points) const;

  std::vector<Tet> tets_;                   // soft
  std::vector<Triangle> triangles_;         // stiff
  std::vector<double> mass_, tet_mass_;     // shares of the points, by which centres of mass are those of the body, and of tetrahedra (soft) [kg]
  double density_ = 0, volume_ = 0;         // at rest
  std::optional<model::StiffMass> stated_;  // stiff, where the scene states its inertia
  std::vector<Vec3> rest_;                  // then
};

}  // namespace mortise::audit
