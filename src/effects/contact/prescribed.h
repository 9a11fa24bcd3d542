#pragma once
// Points that go where supports say are obstacles like all others, but nothing can give way where two of them meet: no force moves them, and
// no shorter step of Newton's method helps. Their way in a step is known when it begins, so their meeting is found then, and the step fails.
#include "effects/contact/pair_energy.h"
#include "effects/effect.h"
#include "geometry/collide/broadphase.h"
#include "model/model.h"

namespace mortise::effects::contact {

class Prescribed {
 public:
  explicit Prescribed(const model::Model& model) : model_(model) {}

  // Once `fetch` is done it throws Failure if primitives of which all points are prescribed meet on the way from y to y + dy, naming the bodies,
  // the time within the step and the place. near: as swept along that way; s: with all bodies that are to be kept apart.
  void forbid_meeting(const BarrierView& s, const geometry::Broadphase& near, View<const Vec3> y, View<const Vec3> dy, const StepInfo& step,
                      device::Fetch& fetch);

 private:
  void refresh();

  const model::Model& model_;
  std::vector<std::uint8_t> held_;  // of the model when `point_` was made
  Buffer<std::uint8_t> point_;      // 1 where all that a point hangs on is held in all directions
};

}  // namespace mortise::effects::contact
