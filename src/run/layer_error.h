#pragma once
// Contact holds surfaces apart by a gap where bodies of the real world touch. Between two bodies that both are held or driven, that gap is
// taken for indentation: with g the mean gap over the contact force and d how far the surfaces were pressed in, measured from the bodies'
// supports, or from where they are bonded to bodies that are supported, the force at the imposed travel is too large by about 3/2 g/d (Hertz: F ~
// d^1.5). Where loads balance the contact force, and not supports, no travel is imposed and the gap is no error of forces: g/d counts fully
// where supports of both bodies bear the contact force, less where they bear a part, and not where they bear less than half of it.
// Held are bodies with pins, and what fixed joints, kinematic drives and bonds hang on them or on the world; a motor with gains gives way and imposes
// no travel.
#include <map>
#include <span>
#include <string>
#include <vector>

#include "model/input.h"

namespace mortise::run {

class LayerError {
 public:
  explicit LayerError(const model::ModelInput& input);
  // Samples of one contact effect: pairs of bodies, gaps [m], forces [N].
  struct Samples {
    std::vector<double> bodies, gap, force;
  };
  // Of all points: displacement [m], support_force and tie_force together [N], contact_force [N], contact_pressure [Pa].
  struct Fields {
    std::span<const double> displacement, support, contact, pressure;
  };
  // Largest share of g/d of any pair of supported bodies; NaN where there is none.
  double of(const Samples& samples, const Fields& fields) const;

 private:
  // Farthest that loaded points of a body are from where its supports are [m]; negative: nothing supports it.
  double indentation(std::size_t body, const Fields& fields) const;
  // Share of the contact force on a held body that its supports bear: of a stiff one, which has nothing free, all.
  double borne(std::size_t body, const Fields& fields) const;

  struct Body {
    std::size_t first, count;  // points
    bool soft, held;
  };
  std::vector<Body> bodies_;
};

}  // namespace mortise::run
