#pragma once
// A pendulum on what is carried about, and a soft rod that vibrates on it: beside the energy of what carries it that of its swing may be nothing, and
// is what somebody looks at. With v the velocities of a body's points, v' the same as seen from what carries it, and T(v) a kinetic energy,
//     D = min(T(change of v in a step), T(change of v' in a step))
// (backward Euler; BDF2: half of that of the second differences): a swing loses 2 D in a step as a vibration does (vibration_loss.h).
//
// Of stiff bodies that go as no pin and no motor of theirs says, together with what they hang on by joints without motors, the loss is held against
// the largest T, the lesser of T(v) and T(v'). Seen from is the body of them at a motor; without one the body that goes as the scene says, if they
// hang on one, else the centre of mass of all that hangs together, and of one body that the world holds the world. A soft body is seen from the rigid
// motion of its pins and bonds, without any from its own, each by itself, and its T counts as no less than kShownBySwing of its largest elastic
// energy: what is pressed or carried so slowly that it only gives loses nothing.
//
// What a carrier that starts at once leaves behind has no change of v, what it takes along has none of v'. What jumps (the speed of a carrier, a
// load) is no swing: of a body counts the least D of the last three steps. Nothing counts while it touches, soft bodies do no more once they have
// touched. They count once a point has gone by kStill of its body's size, as seen from there.
#include <vector>

#include "audit/moving_body.h"
#include "base/archive.h"
#include "geometry/rigid_motion.h"

namespace mortise::audit {

class SwingLoss {
 public:
  explicit SwingLoss(const model::ModelInput& input);
  // elastic: energy of every body [J].
  void state(const Snapshot& said, const std::vector<double>& points, const std::vector<MovingBody>& bodies, const std::vector<double>& elastic);
  void step(bool first_order);  // that led to that state
  double share() const;         // the largest of what hangs together
  void checkpoint(Archive& archive);

 private:
  // Of a soft body or of stiff ones that hang together: sum of 2 D so far, of the last step by its order, the largest T and elastic energy [J]; has
  // it gone so far, has it touched?
  struct Swing {
    double sum = 0, first = 0, second = 0, moved = 0, stored = 0, far = 0, touched = 0;
  };
  // D of one body in the last steps, by order [J].
  struct Changes {
    double first[3] = {0, 0, 0}, second[3] = {0, 0, 0};
  };
  // Of all points, and as seen from what carries them [m/s].
  struct Velocities {
    std::vector<double> v, seen;
  };
  bool counts(const MovingBody& body) const;
  geometry::RigidVelocity seen_from(const std::vector<MovingBody>& bodies, std::size_t body, const std::vector<double>& points,
                                    const std::vector<double>& velocity) const;
  Velocities velocities(const Snapshot& said, const std::vector<double>& points, const std::vector<MovingBody>& bodies) const;
  void look_how_far(const MovingBody& body, const std::vector<double>& seen, const std::vector<double>& points, Swing& swing);

  Integration integration_;
  std::vector<bool> held_;        // of all points: by pins and bonds
  std::vector<Swing> swings_;     // by HowHeld::swings_with
  std::vector<Changes> changes_;  // by body
  Velocities last_, before_;      // in the last state and in the one before
  std::vector<double> way_;       // as seen from what carries them, of all points [m]
};

}  // namespace mortise::audit
