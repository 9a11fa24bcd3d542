#pragma once
// Is the first configuration free of contact distance zero and of intersections?
#include "base/error.h"
#include "effects/contact/candidates.h"
#include "effects/contact/pair_energy.h"
#include "model/model.h"

namespace mortise::effects::contact {

// Bodies that touch or cross at the start, with a picture of where: the triangles of the two primitives, as a Wavefront .obj file with one
// object per body.
class StartError : public Error {
 public:
  StartError(const SourceLoc& at, const std::string& message, std::string obj) : Error(Exit::scene, at, message), obj_(std::move(obj)) {}
  const std::string& obj() const { return obj_; }

 private:
  std::string obj_;
};

// Throws StartError naming both bodies and the primitives, the first in canonical order; also where one body lies inside another.
void check_start(const model::Model& model, const BarrierView& s, const Candidates& c, View<const Vec3> y);

}  // namespace mortise::effects::contact
