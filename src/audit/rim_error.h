#pragma once
// What a mesh makes of contact that ends inside a soft surface, along a sharp edge of what presses on it. The pressure is singular there, and what is
// pressed yields over the whole of the last elements: as if the edge lay some share of an element farther out. Stiffness, of a punch as of a patch of
// any other shape, grows by the share of the patch that this is,
//
//     error = kWidened / (2 A)  sum over sharp edges of  h dl,
//
// A: area of the patch; h: size of the mesh beside the edge; dl: as far as it lies along the end of the patch [m]. kWidened is 1 where all of the
// last elements counts. Round contact ends softly and has no such edge, and a soft surface that ends where the contact does has no elements beyond.
// Errors of stresses (stress_error.h) see little of it, since neither stress nor its mean is right at the edge.
#include <map>
#include <vector>

#include "audit/contact_patch.h"

namespace mortise::audit {

class RimError {
 public:
  explicit RimError(const model::ModelInput& input);
  // By group: the worst of its patches. group: by body that has points.
  std::map<std::size_t, double> of(const ContactPatch& patch, const ContactPatch::Fields& fields, const std::vector<std::size_t>& group) const;

 private:
  struct SharpEdge {
    std::size_t body;
    Index a, b;  // points
  };
  std::vector<SharpEdge> edges_;  // none where nothing is soft
  std::vector<bool> loaded_;      // by body that has points: a pressure acts on it, maybe beyond the edge, where nothing is singular then
};

}  // namespace mortise::audit
