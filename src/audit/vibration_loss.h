#pragma once
// What the time step takes from vibrations while supports move, loads act or something touches, so that the balance of energies does not tell it from
// what supports, loads and contacts do. Of a linear system y' = A y (y: velocities and elastic forces, in the norm of energy) a step loses
//     backward Euler   1/2 |y_1 - y_0|^2
//     BDF2             1/4 |y_2 - 2 y_1 + y_0|^2     (in its G-norm: Hairer & Wanner, Solving Ordinary Differential Equations II, V.6)
// exactly, whatever drives it. The part of the velocities is known from them,
//     D = 1/2 |v_1 - v_0|_M^2,     or 1/4 |v_2 - 2 v_1 + v_0|_M^2,
// and what vibrates loses as much again of its potential energy, on the average of a period: 2 D. What is pressed or held so slowly that its kinetic
// energy is nothing beside the elastic one has no D. What is carried about hardly vibrates: beside its kinetic energy T its elastic one U is nothing
// (at r times its own frequency r^2 T, and by r^2 h omega the step then alters how far it gives). So the sum over all steps is
//     min(1, U/T) sum 2 D,     U, T: the largest of the run.
// Counted are soft bodies, and stiff ones that go as no pin and no kinematic drive says and that touch something soft or are held (by what is soft,
// by springs, by motors with gains or efforts, by joints; where they touch what is stiff the changes of their velocity along that, which it does not
// make, count), once they have gone farther than stiff bodies of the size of all that hangs together give (kTrembles), and unless their joint damps
// far more than the time step does. Not what bodies brought that struck something (2 D of bringing them to rest in one step is twice that): if they
// come to rest nobody asks for it, if not: bounce_loss.h.
//
// Where nothing but soft bodies is moved and nothing touches, energies tell what they lose: a stress wave in a bar that is pushed has no 2 D in the
// step in which it starts.
//
// Beside bodies with far more energy that loss is nothing, though somebody may look at what vibrates. Bodies that hang together by joints, bonds and
// ties, and on which no support, motor, load or friction does work, have energy of their own alone: of such a mechanism, while it touches nothing,
//     sum 2 D / T,     T: its largest,
// once something of it has gone that far: a pad that sags under its own weight does not.
#include <vector>

#include "audit/moving_body.h"
#include "audit/steady_motion.h"
#include "base/archive.h"
#include "base/snapshot.h"

namespace mortise::audit {

class VibrationLoss {
 public:
  VibrationLoss(const model::ModelInput& input, const MovingBodies& moving);
  // stored: elastic energy, of bodies, contacts and springs; brought: energy of what struck something in the step that led to this state [J].
  void state(const Snapshot& said, const std::vector<double>& points, const std::vector<MovingBody>& bodies, double stored, double brought);
  void step(bool first_order, bool counts);     // that led to that state; not: its loss is known
  void lost(double energy) { sum_ += energy; }  // in such a step, in the place of 2 D [J]
  // The largest share of its own energy that a mechanism lost which has less than half of `all` [J].
  double alone(double all) const;
  bool nothing_moves() const;                    // all bodies are stiff, and have trembled at most
  double sum(const SteadyMotion& steady) const;  // without the motion that only goes on [J]
  void checkpoint(Archive& archive);

 private:
  struct Mechanism {
    bool alone = true;             // nothing does work on it
    bool far = false;              // something of it has gone so far
    double first = 0, second = 0;  // 2 D of the last step, by its order [J]
    double sum = 0, moved = 0;     // of 2 D, T [J]
  };
  void look_how_far(const Snapshot& said, const std::vector<double>& points, const std::vector<MovingBody>& bodies);
  bool counts(const MovingBody& b, std::size_t i, bool struck) const;
  double counted(const std::vector<double>& energies, const std::vector<MovingBody>& bodies, bool struck);  // sum over the bodies that count

  Integration integration_;
  std::vector<std::uint8_t> far_;            // by body: has it gone so far that it does more than tremble?
  std::vector<std::uint8_t> counted_;        // by body: has it counted?
  bool soft_ = false;                        // something is
  std::vector<Mechanism> mechanisms_;        // by `MovingBody::group`
  std::vector<double> v1_, v0_;              // velocities of the last state and of the one before
  double of_first_ = 0, of_second_ = 0;      // 2 D of the last step, by its order [J]
  double brought_ = 0;                       // of that does not count [J]
  double sum_ = 0, stored_ = 0, moved_ = 0;  // of 2 D, U, T [J]
};

}  // namespace mortise::audit
