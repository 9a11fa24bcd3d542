#pragma once
// Ways of all bodies, of their centres [m] or of their turning [rad], and how far backward Euler is ahead of them. It takes the velocity at a step's
// end for all of it. Under smooth forces a body is then ahead of where it should be by
//     e = h/2 |v - v_0|   [m],   h the time step, v_0 the velocity at the start,
// exactly so in a fall and in a slide: of the way g t^2/2 that is the share h/t. What gets slower is as far behind. Under a force that grows the
// velocity itself is ahead, by half a step's growth: with a_0 the acceleration in the first step and t the time since, what |v - v_0| is more than
// |a_0| t counts twice. The same of angles, by angular velocities. What turned back or came to rest has lost it again (a wrong phase, a swing that is
// damped: free_motion_loss sees those).
// Where motion feeds on itself (what topples: a ~ x), the velocity is multiplied, in a step by 1 / (1 - l h) where exp(l h) is right: with
// l = dv.v / (h |v|^2) that is ahead by l h^2 / 2 [s], which adds up over all steps in which the acceleration grows at nearly the rate at which the
// velocity does (under a force that grows with a power of time less than the third it does not), and counts with the velocity.
#include <string>
#include <vector>

#include "base/archive.h"
#include "base/types.h"

namespace mortise::audit {

class LaggingWays {
 public:
  // Another body, at velocity v; less than least_way is no way that anybody looks at.
  void start(const Vec3& v, double least_way);
  void restart(std::size_t body, const Vec3& v);
  // e over the farthest that the body should have been from its start, or over the least way; after so many steps of length h, each of which was
  // told.
  double lag(std::size_t body, const Vec3& way, const Vec3& velocity, double h, long steps);
  Vec3 v0(std::size_t body) const;
  double far(std::size_t body) const { return far_[body]; }
  double least(std::size_t body) const { return least_[body]; }
  void checkpoint(Archive& archive, const std::string& name);

 private:
  void multiply(std::size_t body, const Vec3& velocity, double h);
  std::vector<double> v0_, a0_;          // velocities at the start, 3 per body; accelerations in the first step
  std::vector<double> v_last_, a_last_;  // of the last step, 3 per body
  std::vector<double> ahead_;            // of what multiplies [s]
  std::vector<double> least_, far_;      // smallest way that counts, farthest from the start so far
};

}  // namespace mortise::audit
