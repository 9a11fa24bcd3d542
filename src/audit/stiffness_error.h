#pragma once
// What the error of a mesh's stiffness (stress_error.h) makes of forces, and of motions of bodies as a whole. A force follows the stiffness of soft
// bodies as far as supports impose a travel on them (layer_error.h), a motion as far as deformation is a part of it:
//
//     error = largest, of all groups of bodies that press each other, of  e max(s, d/w)
//
// e: the group's stress_error; s: share of a force that follows stiffness, all of it where a soft body hangs on two supports or more; d: farthest
// that a point of a soft body is from where it would be without deformation, held by its supports, or a point of a stiff body that two soft ones or
// more hold, whose supports would take it along (nearly) alike, from where the nearest of them would; w: farthest way of any point of the group [m],
// in the frame in which that is least: of the world and, of a group that all hangs on what goes as the scene says, of the supports of its soft
// bodies. Where no travel is imposed, s = 0, what bends beside uniform stress has the error e_b of its motion: as far as that,  (1 - s) e_b d/w
// counts too.
#include <map>
#include <span>
#include <vector>

#include "audit/layer_error.h"
#include "model/input.h"

namespace mortise::audit {

class StiffnessError {
 public:
  explicit StiffnessError(const model::ModelInput& input);
  // errors, bending: by group (StressError::Estimate); group: by body that has points; bases: by such a body, how its supports moved
  // (`LayerError::motion_of_supports`). NaN without errors.
  using Bases = std::vector<std::optional<geometry::Motion>>;
  double of(const std::map<std::size_t, double>& errors, const std::vector<std::size_t>& group, const std::vector<LayerError::Travel>& travels,
            const Bases& bases, std::span<const double> displacement, const std::map<std::size_t, double>& bending = {}) const;

  // The gap that contact leaves, of what presses a soft body noticeably, over the farthest that both have gone without it: by which they should have
  // gone farther. The largest of all pairs of bodies; NaN where there is none.
  double layer_over_way(const LayerError::Samples& samples, const Bases& bases, std::span<const double> displacement) const;

 private:
  struct Body {
    std::size_t first;  // point
    std::vector<Vec3> rest;
    bool soft;
    int supports;
    double thickness;  // least extent at rest [m]
    bool held, given;  // Holds
  };
  static double deformed(const Body& body, std::optional<geometry::Motion> base, std::span<const double> displacement);  // d [m]
  // d of a stiff body between supports that go along alike; 0 if they do not, or if there is but one.
  static double carried(const Body& body, const std::vector<geometry::Motion>& bases, std::span<const double> displacement);
  // w of some bodies, by number [m].
  double way(const std::vector<std::size_t>& of, const Bases& bases, std::span<const double> displacement) const;
  std::vector<Body> bodies_;
  std::size_t points_ = 0;
};

}  // namespace mortise::audit
