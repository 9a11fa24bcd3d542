#pragma once
// Where contact presses on soft surfaces, node by node: what estimates of its errors look at.
#include <array>
#include <span>
#include <vector>

#include "model/input.h"

namespace mortise::run {

class ContactPatch {
 public:
  explicit ContactPatch(const model::ModelInput& input);

  struct Node {
    std::size_t point;
    std::vector<Index> ring;  // corners of the triangles around it that face the force on it, without itself
    double area;              // a third of theirs, as they stand now [m^2]; 0 on quadratic bodies
  };
  // Of all points: contact_pressure [Pa], contact_force [N] and displacement [m], three each; the last may be empty.
  struct Fields {
    std::span<const double> pressure, force, displacement;
  };
  // Nodes in the interior of the patch: what faces the force on them is covered. Covered are nodes that carry pressure, or of whose neighbours most
  // do, as where a method leaves out every other one. A body's own edge is no rim: triangles around the corner do not face the force.
  std::vector<Node> interior(const Fields& fields) const;
  long loaded(std::span<const double> pressure) const;  // nodes that carry pressure

  const std::vector<Vec3>& rest() const { return rest_; }  // of all points [m]

 private:
  std::vector<Vec3> rest_;
  std::vector<std::uint8_t> linear_;        // per point: of a body of linear tetrahedra
  std::vector<Triangle> triangles_;         // of soft bodies
  std::vector<std::vector<Index>> around_;  // per point: triangles; none off soft surfaces
};

}  // namespace mortise::run
