#pragma once
// A pressure_load keeps the direction and the area that its faces have at rest (a dead load). A gas or a liquid would follow them: with a the area
// vector of a loaded triangle, A that at rest, over the triangles of a load
//
//   turned^2 = sum |a - A|^2 / sum |A|^2,
//
// which is how far the load is from the one that follows, where it is small. Of loads that are given as `pressure`; a `traction` is meant to stay.
#include <span>
#include <vector>

#include "model/input.h"

namespace mortise::audit {

class LoadTurned {
 public:
  explicit LoadTurned(const model::ModelInput& input);
  // The largest of all loads, from the displacement of all points [m]; NaN where there is none.
  double of(std::span<const double> displacement) const;

 private:
  struct Face {
    std::size_t point[3];
    Vec3 rest[3];
  };
  std::vector<std::vector<Face>> loads_;
};

}  // namespace mortise::audit
