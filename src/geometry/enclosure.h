#pragma once
// What closed surfaces enclose, also where they cross: x is inside where they wind around it. Of triangles that lie in a box and x outside of it, the
// solid angle is that of any cap on their border that lies in the box too: a fan over the border's edges, of which there are far fewer. In a tree of
// boxes few triangles are left to look at (Jacobson, Kavan, Sorkine-Hornung, "Robust inside-outside segmentation using generalized winding numbers",
// 2013, sec. 4.1).
#include <vector>

#include "geometry/bounds.h"
#include "geometry/mesh.h"

namespace mortise::geometry {

class Enclosure {
 public:
  // The mesh must outlive it.
  Enclosure(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles);
  // Inside or, to rounding, no farther from the surface than `reach` [m].
  bool holds(const Vec3& x, double reach = 0) const;

 private:
  struct Box {
    Bounds bounds;
    std::vector<Triangle> triangles;  // of a leaf, else its cap
    int first = -1;                   // of its two parts; -1: a leaf
  };
  void fill(int box, std::vector<Triangle>& of);
  // False where a triangle is no farther from x than `room`; else the solid angle of the box's triangles is added.
  bool add(int box, const Vec3& x, double room, double& angle) const;

  const std::vector<Vec3>& points_;
  double rounding_ = 0;  // [m]
  std::vector<Box> boxes_;
};

}  // namespace mortise::geometry
