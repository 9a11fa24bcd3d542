#pragma once
// Points that go where supports say are obstacles like all others, but nothing can give way where two of them meet: no force moves them, and
// no shorter step of Newton's method helps. Their way in a step is known when it begins, so their meeting is found then, and the step fails.
#include <memory>

#include "effects/contact/pair_energy.h"
#include "effects/effect.h"
#include "geometry/collide/broadphase.h"
#include "model/model.h"

namespace mortise::effects::contact {

class Prescribed {
 public:
  explicit Prescribed(const model::Model& model) : model_(model) {}

  // When do primitives of which all points are prescribed meet on the way from y to y + dy, among the pairs near that way? Known once `fetch` is
  // done; empty where no support moves. s: with all bodies that are to be kept apart.
  struct Meetings;
  std::shared_ptr<const Meetings> look(const BarrierView& s, const geometry::ChosenPairs& near, View<const Vec3> y, View<const Vec3> dy,
                                       device::Fetch& fetch);
  // Throws Failure if they do, naming the bodies, the time within the step and the place. The lists of pairs must still be there.
  void check(const Meetings& found, const BarrierView& s, const geometry::ChosenPairs& near, const StepInfo& step) const;

 private:
  void refresh();

  const model::Model& model_;
  std::vector<std::uint8_t> held_;  // of the model when `point_` was made
  Buffer<std::uint8_t> point_;      // 1 where all that a point hangs on is held in all directions
};

}  // namespace mortise::effects::contact
