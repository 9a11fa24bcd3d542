#pragma once
#include <array>
#include <vector>

#include "geometry/bounds.h"
#include "model/input.h"

namespace mortise::model {

// Nodes of a soft body that an entry of the effect `bond` ties to a stiff one: those that its `where` selects, of them those inside the stiff body or
// `within` that distance of its surface. Throws Error(Exit::scene) where there is none.
std::vector<Index> bonded(const Params& bond, const BodyInput& soft, const BodyInput& stiff);

// The surface of a stiff body at rest, and what is inside of it or within `reach` of it [m].
class Hull {
 public:
  Hull(const BodyInput& body, double reach);
  bool holds(const Vec3& x) const;

 private:
  double reach_;
  geometry::Bounds bounds_;
  std::vector<std::array<Vec3, 3>> corners_;
};

}  // namespace mortise::model
