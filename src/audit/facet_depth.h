#pragma once
// Facets of round bodies lie below their surface, by e^2 / (12 R) on average of a sphere of radius R whose edges are e long. A body that presses with
// them reaches less far by that, as contact reaches farther by its gap (layer_error.h): with the depth of facets in the place of the gap the same
// estimates hold, F falls by about 3/2 of depth over indentation where travels are imposed, and loads sink in by that more. The depth is the volume
// that is missing over the round area; of cylinders as far as what presses them acts across their axis, of capsules all around. Curved elements have
// none; what facets a file has itself, and those of bodies of several parts, nobody knows.
#include <vector>

#include "audit/layer_error.h"
#include "model/input.h"

namespace mortise::audit {

class FacetDepth {
 public:
  explicit FacetDepth(const model::ModelInput& input);
  bool any() const;
  // The samples with the depth of the facets of both bodies [m] in the place of gaps; `layer` knows how bodies have turned.
  LayerError::Samples of(LayerError::Samples samples, const LayerError& layer, const LayerError::Fields& fields) const;

 private:
  struct Body {
    double depth = 0;          // [m]
    Vec3 axis = Vec3::Zero();  // of a cylinder, at rest; else 0
  };
  double depth(std::size_t body, const Vec3& force, const LayerError& layer, const LayerError::Fields& fields) const;
  std::vector<Body> bodies_;  // that have points
};

}  // namespace mortise::audit
