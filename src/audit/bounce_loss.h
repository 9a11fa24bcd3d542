#pragma once
// Bounces: what soft bodies take up where they are struck they give back, and a time step that is not much shorter than that takes a part of it: of a
// contact that lasts n steps of backward Euler a share 1 - exp(-pi^2 / n) of the energy (a linear spring), 10 % for n = 94. Where the body comes to
// rest nobody asks for it; where it flies on, it does so too slowly, by no more than it brought. Of bodies that go as no pin and no motor says, free
// or on joints, together with what hangs on them, and where something soft is struck.
// Joints that reach their stops strike them as stiff bodies do.
// What stiff bodies give back of an impact is in no law here: time step and layer decide it (nearly nothing). Those that fly on from one might do so
// with as much more energy as was lost, or come to rest: what is less of the two, what they fly on with and what was lost, is in doubt.
//
// Beside what has far more energy, or goes along with what it strikes, a bounce may be all that somebody looks at. Of what hangs together it has,
// whoever looks at it, the energy 1/2 |dv|_M^2 of the change of velocity between its two flights; if of that the contact lost the share r, its
// impulse is too small by r, and with
//     E = (1 + r)^2 / 4 * 1/2 |dv|_M^2
// before it, along its change, it has lost 4 r / (1 + r)^2 of that. What a step lost is shared out as bodies' changes of velocity are. A contact in
// which weight did more than half of it was no bounce.
#include <cmath>
#include <vector>

#include "audit/moving_body.h"
#include "audit/own_energy.h"
#include "base/archive.h"

namespace mortise::audit {

class BounceLoss {
 public:
  // lost: by the step that led to this state, without friction [J]; nothing by what led to the first.
  void state(const std::vector<MovingBody>& bodies, double lost, const OwnEnergy& own);
  double sum() const { return sum_; }          // lost in contacts that ended in flight [J]
  double stiff() const { return stiff_; }      // in doubt after impacts of stiff bodies [J]
  double brought() const { return brought_; }  // energy of motion against what it struck, of what struck something in the last step [J]
  // The largest shares of its own largest E that something lost, or of which so much is in doubt.
  double own() const;
  double own_stiff() const;
  void checkpoint(Archive& archive);

 private:
  // Of the contact under way, for all that hangs together (`MovingBody::group`).
  struct Contact {
    double steps = 0;     // so far; -1: in flight
    double slow = 0;      // those of them in which it hardly moved
    double before = NAN;  // its energy before [J]; NaN: no start was seen of what touches in the first state
    double lost = 0;      // so far, by all [J]
    double soft = 0;      // was something soft struck?
    double own = 0;       // its part of what was lost so far [J]
    // Of all contacts that ended: lost, in doubt, the largest E; and the largest energy of motion as seen from the world or from another body [J].
    double bounced = 0, doubted = 0, most = 0, moved = 0;
  };
  double own(double Contact::*of, double seen) const;
  double against(const std::vector<MovingBody>& bodies, std::size_t group) const;
  // Energy E of a contact that ended, for its loss; 0: it was no bounce [J].
  double struck(const std::vector<MovingBody>& bodies, std::size_t group, const Vec3& fall) const;

  std::vector<Contact> contacts_;  // by number of body
  std::vector<double> flew_;       // v and w of every body when it flew last
  double sum_ = 0, stiff_ = 0, brought_ = 0;
};

}  // namespace mortise::audit
