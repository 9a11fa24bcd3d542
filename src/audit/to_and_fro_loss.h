#pragma once
// A ball that rolls to and fro in a bowl, a block that slides about in a trough: what stiff bodies do that lie on stiff ones and that nothing else
// holds. A step of backward Euler takes
//     D = 1/2 m |dv|^2,     dv: change of the velocity v of its centre along what it lies on, as seen from the world or from there, the lesser
// (BDF2: half of that of the second differences), and as much of the change across, where the way bends up again. Half of what is lost of the energy
// of such motion is how much its way is too short by.
//
// What only speeds up or comes to rest goes as far as it should but for motion_lag: along every axis of the world D counts as the smaller of the
// largest velocities to and fro is to the larger, and where it has gone farther on that than kToAndFro of its radius. What jumps is no such motion:
// of a step counts the least D of the last three; nothing counts in the step in which something comes to touch, or on what the scene moves, as
// friction drives it to and fro then.
#include <vector>

#include "audit/moving_body.h"
#include "base/archive.h"
#include "model/input.h"

namespace mortise::audit {

class ToAndFroLoss {
 public:
  explicit ToAndFroLoss(const model::ModelInput& input) : integration_(integration_of(input.scene)) {}
  void state(const std::vector<double>& points, const std::vector<MovingBody>& bodies);
  void step(bool first_order);  // that led to that state
  double share() const;         // of its largest energy of motion, as seen from there; the largest of all bodies
  void checkpoint(Archive& archive);

 private:
  struct Body {
    double v[2][3] = {}, seen[2][3] = {};             // in the last state and in the one before; from what it lies on [m/s]
    double states = 0;                                // so far in which it lay there, in a row
    double first[3] = {}, second[3] = {};             // D of the last step, by order and axis [J]
    double lasts[2][3] = {};                          // all of D in the last steps, by order [J]
    double sum[3] = {}, fro[3] = {}, to[3] = {};      // of D [J]; the largest velocities against and along the axes [m/s]
    double way[3] = {}, least[3] = {}, most[3] = {};  // so far, as seen from there, and its ends [m]
    double radius = 0, moved = 0;                     // [m], [J]
    double share() const;
  };
  // slowest: of what moves under a body, more than rounding [m/s].
  static bool counts(const MovingBody& b, const std::vector<MovingBody>& bodies, double slowest);
  Integration integration_;
  std::vector<Body> bodies_;
};

}  // namespace mortise::audit
