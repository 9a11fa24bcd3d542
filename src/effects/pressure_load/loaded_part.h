#pragma once
// The part of surface triangles that a `where` block of the scene selects, at rest. A side of the body selects whole triangles. A box or
// a sphere cuts them, so that the loaded area is that of the block on any mesh. A thin box around a flat face also holds a rim of the
// walls beside it, which nobody means: of the parts that edges connect across which the surface bends by less than `kSameFace`, those
// count that hold a whole triangle; where none does, the largest, and others about as large.
#include <array>
#include <span>
#include <vector>

#include "base/params.h"
#include "base/types.h"
#include "model/model.h"

namespace mortise::effects::pressure_load {

// A convex polygon in a triangle, by its corners' barycentrics; empty: nothing of it.
using Polygon = std::vector<Vec3>;

inline const Polygon whole_triangle = {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};

// What of the flat triangle with corners x [m] lies inside a box or a sphere. A sphere cuts a plane in a circle, taken as chords that
// enclose the same area. Corners very near to a side of a box lie on it.
Polygon part_inside(const std::array<Vec3, 3>& x, const Params& where);

// Of every one of the body's `triangles`; `points` [m] are those of the model, at rest.
std::vector<Polygon> loaded_parts(const model::Model& model, const model::Body& body, std::span<const Triangle> triangles,
                                  std::span<const Vec3> points, const Params& where);

// A polygon's share of the triangle's area, and the mean of the barycentrics over it.
struct Share {
  double area = 0;
  Vec3 mean = Vec3::Zero();
};
Share share_of(const Polygon& polygon);

}  // namespace mortise::effects::pressure_load
