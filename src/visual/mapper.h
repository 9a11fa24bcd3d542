#pragma once
// Carries a visual mesh along with the surface of the simulation mesh ("dual mesh").
#include <array>
#include <span>
#include <vector>

#include "base/types.h"

namespace mortise::visual {

// Each visual vertex is bound once, at rest, to its nearest triangle (a, b, c) of the simulation surface:
//   x = w_a a + w_b b + w_c c + offset n,   n = unit normal of the triangle,   w_a + w_b + w_c = 1.
// The weights are those of the projection onto the *plane* of the triangle; where the nearest point lies on an edge or corner
// one of them is slightly negative. The four numbers therefore determine x completely, and at rest the map returns it up to
// round-off of these sums (nothing is fitted or clamped). Rigid motions carry a, b, c and n along, so they are exact too.
// For a smooth deformation and visual vertices O(h^2) off the facets (a curved model over facets of size h), linear
// interpolation errs by O(h^2), and so does the offset, whose length is kept: the map is second order.
class Mapper {
 public:
  // Positions at rest [m]. Throws Error(Exit::scene) where there is no triangle with an area.
  Mapper(const std::vector<Vec3>& rest_points, const std::vector<Triangle>& triangles, const std::vector<Vec3>& visual_points);

  // Moved positions of the visual vertices from moved positions of the simulation points [m].
  void map(std::span<const Vec3> points, std::vector<Vec3>& visual_points) const;

  // A field on the simulation points at the visual vertices; never leaves the range of the three values it is taken from.
  void interpolate(std::span<const double> values, std::vector<double>& visual_values) const;

 private:
  struct Binding {
    Triangle triangle;
    std::array<double, 3> weight;
    double offset;  // [m]
  };
  std::vector<Binding> bindings_;
};

}  // namespace mortise::visual
