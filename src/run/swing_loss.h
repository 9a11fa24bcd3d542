#pragma once
// A pendulum on what is carried about: beside the energy of what carries it that of its swing may be nothing, and is what somebody looks at. Of
// stiff bodies that go as no pin and no motor says, together with what they hang on by joints and as long as they touch nothing, with v the
// velocities of their centres and w of turning, and v', w' the same as seen from what carries them,
//     T = sum 1/2 m |v'|^2 + 1/2 w' . I w',     D = sum min(that of the changes of v and w in a step, that of the changes of v' and w')
// (backward Euler; BDF2: half of that of the second differences), a swing loses 2 D in a step as a vibration does (vibration_loss.h), of its largest
// T. Seen from is the body that goes as the scene says, if they hang on one, else the centre of mass of all that hangs together, and of one body that
// the world holds the world: what a carrier that starts at once leaves behind has no change of v, what it takes along has none of v'.
// What jumps (the speed of a carrier, a load) is no swing: of a body counts the least D of the last three steps.
// They count once one of them has gone by kStill of its size, as seen from there.
#include <vector>

#include "base/archive.h"
#include "geometry/rigid_motion.h"
#include "run/moving_body.h"

namespace mortise::run {

class SwingLoss {
 public:
  explicit SwingLoss(const model::ModelInput& input) : integration_(integration_of(input.scene)) {}
  void state(const std::vector<double>& points, const std::vector<MovingBody>& bodies);
  void step(bool first_order);  // that led to that state
  double share() const;         // the largest of what hangs together
  void checkpoint(Archive& archive);

 private:
  // Of what hangs together, by number of body: sum of 2 D so far, of the last step by its order, the largest T [J]; has it gone so far?
  struct Swing {
    double sum = 0, first = 0, second = 0, moved = 0, far = 0;
  };
  // D of one body in the last steps, by order [J].
  struct Changes {
    double first[3] = {0, 0, 0}, second[3] = {0, 0, 0};
  };

  Integration integration_;
  std::vector<Swing> swings_;
  std::vector<Changes> changes_;
  std::vector<double> last_, before_;  // v, w, v', w' of every body in the last state and in the one before
  std::vector<double> way_;            // as seen from what carries it, of every body [m]
};

}  // namespace mortise::run
