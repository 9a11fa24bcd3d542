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
    const std::vector<Index>& ring;  // its neighbours on the surface
  };
  // Nodes in the interior of the patch: they and all their neighbours carry pressure [Pa, per point], or lie among nodes of which most do, as
  // where a method leaves out every other one.
  std::vector<Node> interior(std::span<const double> pressure) const;
  long loaded(std::span<const double> pressure) const;  // nodes that carry pressure

  const std::vector<Vec3>& rest() const { return rest_; }                // of all points [m]
  const std::vector<Triangle>& triangles() const { return triangles_; }  // of soft bodies of linear tetrahedra

 private:
  std::vector<Vec3> rest_;
  std::vector<std::vector<Index>> ring_;  // per point; empty off soft surfaces
  std::vector<Triangle> triangles_;
};

}  // namespace mortise::run
