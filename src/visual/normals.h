#pragma once
// Normals of surfaces that move.
#include <vector>

#include "base/types.h"

namespace mortise::visual {

// Points of a draw mesh that share one normal: same position at rest, and rest normals that agree. Texture seams duplicate a
// point but not its normal; creases of the model do both and stay sharp.
class SmoothNormals {
 public:
  // `points` and `normals` at rest, one per vertex; `triangles` as drawn.
  SmoothNormals(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, std::vector<Triangle> triangles);

  // Unit normals of the moved surface: sum over the triangles at a vertex, weighted with the angle there.
  void compute(const std::vector<Vec3>& points, std::vector<Vec3>& normals) const;

 private:
  std::vector<Triangle> triangles_;
  std::vector<Index> group_;  // per vertex
  Index groups_ = 0;
};

// A simulation surface made ready to draw: vertices split where the surface has an edge sharper than `crease` [rad].
struct SplitSurface {
  std::vector<Index> source;        // per vertex: index into the points given
  std::vector<Triangle> triangles;  // same order as given
  std::vector<Vec3> normals;        // at rest
};
SplitSurface split_creases(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles, double crease);

}  // namespace mortise::visual
