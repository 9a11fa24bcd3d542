#pragma once
// How far the contact pressure can be trusted, from node to node of the interior of its patch (contact_patch.h).
//
// roughness: a pressure is smoother than what a mesh makes of it, and a plane through the pressures of a node's neighbours misses that of the node
// by little. The root mean square of the misses over that of the pressures (of the larger of
// both at every node) was 1.4 to 1.8 times the true L2 error on Hertz contact with mortar
// and barrier methods of two mesh sizes (3.4 to 14 %), and zero to rounding in the patch test.
//
// misfit: a pressure p loads a node with F_i = int N_i p dA: of linear tetrahedra p_i A_i up to second order in the mesh size, A_i being a third of
// the triangles around the node, of quadratic ones sum_j (int N_i N_j dA) p_j, which leaves corners without. Methods that weigh points or samples
// unevenly load nodes as no such pressure does, and stresses below are wrong although forces balance. The root mean square of |F_i| - |int N_i p dA|
// likewise; zero in the patch test, and nearly so of all linear tetrahedra, whose pressures are those forces over areas.
#include <cmath>
#include <span>
#include <vector>

#include "audit/contact_patch.h"

namespace mortise::audit {

class PressureError {
 public:
  explicit PressureError(const model::ModelInput& input) : patch_(input) {}
  struct Result {
    double roughness = NAN, misfit = NAN;  // NaN where there is no interior
    long nodes = 0;                        // that carry pressure
  };
  // group: by body that has points, of which the worst is told that is pressed at all (kCounts); empty: all are one.
  Result of(const ContactPatch::Fields& fields, const std::vector<std::size_t>& group = {}) const;

  const ContactPatch& patch() const { return patch_; }

 private:
  ContactPatch patch_;
};

}  // namespace mortise::audit
