#pragma once
// What the time step takes from strikes. What flies and strikes something soft, or is soft, is stopped by a force that rises with what it gives;
// where that takes a few steps only, they take the most of what it brought, and the largest force is too small. Of what hangs together, with F its
// largest force of contact so far, along n, P what presses it besides, T the energy of motion along n and U the elastic energy since it flew,
//
//     F' = P + sqrt((F - P)^2 + 2 k L),     P = F - sum m a . n,     k = F^2 / 2 U,
//     L  = sum T(v_1 - v_0) + (F_1 - F_0)^2 / 2 k                      (backward Euler)
//     L  = sum 1/2 T(v_2 - 2 v_1 + v_0) + (F_2 - 2 F_1 + F_0)^2 / 4 k  (BDF2)
//
// is what it would be with what steps lost until then (vibration_loss.h): of a mass on a spring the true one. Missing of the largest force of the run
// is the share 1 - F / F'. Accelerations of BDF2 err by a third of their second difference, which counts of what comes later too, where it swings or
// comes to a stop of its own: (2 F_1 - F_0 - F_2) / 3 is missing of a largest force F_1. A weight that is put down is no strike: 2 k T of what was
// brought has to be a share of P^2 at least, which a sudden load doubles. Where joints damp, too much is told to be missing: they would take a part
// of it.
#include <vector>

#include "audit/moving_body.h"
#include "base/archive.h"
#include "model/input.h"

namespace mortise::audit {

class Struck {
 public:
  explicit Struck(const model::ModelInput& input) : integration_(integration_of(input.scene)) {}
  // elastic: energy of every body [J].
  void state(const std::vector<MovingBody>& bodies, const std::vector<double>& elastic);
  void step(bool first_order);  // that led to that state
  double share() const;         // of what hangs together, the largest
  void checkpoint(Archive& archive);

 private:
  // Of what hangs together, by its number (`MovingBody::group`).
  struct Strike {
    double flew = 0;                         // in the last state
    double rises = 0;                        // the force, since it flew
    double on = -1, stored = 0;              // what is struck; U when it flew last [J]
    double brought = 0;                      // T before [J]
    double force = 0, last = 0, before = 0;  // F; in the last state, and in the one before [N]
    double pressed = 0, energy = 0;          // P [N]; U [J]
    // Of the last step by its order, and summed up: T [J]; squares of differences of forces, which are 2 k times what they lose [N^2].
    double moves_first = 0, moves_second = 0, moves = 0, forces_first = 0, forces_second = 0, forces = 0;
    double largest = 0, meant = 0;     // F and F' of the run [N]
    double then = 0, before_then = 0;  // in the last state and in the one before, in flight too [N]
  };
  void see_peak(Strike& s, double force, double energy) const;
  void begin(Strike& s, const std::vector<MovingBody>& bodies, std::size_t group, const Vec3& n) const;

  Integration integration_;
  std::vector<Strike> strikes_;
  std::vector<double> last_, before_;  // v and w of all bodies in the last state, and in the one before
  std::vector<double> elastic_;        // of all bodies in the last state [J]
};

}  // namespace mortise::audit
