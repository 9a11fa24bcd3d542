#pragma once
// Bodies in a state of motion, measured once for all estimates of what the time step does to it, and who leads them.
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "audit/measured_body.h"
#include "base/archive.h"
#include "base/snapshot.h"
#include "effects/integrator.h"
#include "geometry/rigid_motion.h"
#include "model/input.h"

namespace mortise::audit {

// How a body is held, throughout a run.
struct HowHeld {
  bool held;          // by the world, if over other bodies
  bool given;         // it goes as pins or kinematic drives say (Holds::given)
  bool driven;        // given, and not by pins of its own
  bool free;          // nothing holds it or ties it to another body
  bool swings;        // it goes as forces say: not given, and no motor is on the way to what holds it, or on what it hangs together with
  bool spins;         // free, or on joints of its own that no motor moves but by a given torque
  bool damped;        // by its joint, far more than by the time step (Holds::damped)
  std::size_t group;  // number of a body that it hangs together with by joints, bonds and ties, over what is not given
  std::optional<std::size_t> carrier;  // number of a given body that its group hangs on
  std::optional<std::size_t> bonded;   // of a soft body: number of a given stiff one that it is bonded or tied to
  // A number of what it hangs together with by what no motor moves, of a soft body its own, less than twice the bodies; and the one of them that is
  // at a motor, of those that are at none.
  std::size_t swings_with;
  std::optional<std::size_t> swings_on;
  bool walks() const { return !held && !given && !swings; }  // of a mechanism with motors that nothing holds
};

struct MovingBody : HowHeld {
  const MeasuredBody& body;
  Vec3 x, v, w;                   // centre of mass [m], its velocity [m/s], angular velocity [rad/s]
  Vec3 a, alpha;                  // what these change by, as the integrator takes it: none in the first state [m/s^2, rad/s^2]
  bool touches;                   // a force of contact is on one of its points
  bool stopped;                   // its joint is at a stop
  Vec3 pressed;                   // mean place of these forces, as far as it touches [m]
  Vec3 push;                      // their sum, where they have a direction, else 0 [N]
  std::optional<std::size_t> on;  // a number of the body that presses it most; none where that is a half-space
  bool led;                       // given, or supported by what is no joint
  double turns;                   // energy of turning about its centre, of stiff bodies [J]

  geometry::RigidVelocity rigid() const { return {x, v, w}; }
  Vec3 across_push(const Vec3& of) const { return of - push * push.dot(of) / push.squaredNorm(); }
  Vec3 along_contact(const Vec3& of) const { return push.isZero(0) ? of : across_push(of); }
  // Of its centre [J].
  double energy() const { return energy_of(v); }
  // The same of another velocity, and of turning with another one, as if all its axes of inertia were like that which it turns about.
  double energy_of(const Vec3& of) const { return 0.5 * body.mass() * of.squaredNorm(); }
  double turning_of(const Vec3& of) const { return w.squaredNorm() > 0 ? turns * of.squaredNorm() / w.squaredNorm() : 0; }
};

// Does anything soft?
bool soft_touches(const std::vector<MovingBody>& bodies);
// v and w of all bodies, three numbers each.
std::vector<double> velocities(const std::vector<MovingBody>& bodies);

// An integrator's time step h [s], NaN without one, and whether it is of second order.
struct Integration {
  double step = NAN;
  bool second_order = false;
  // What v changes by, over time; v1, v2: in the last state and in the one before, of so many that there are.
  template <class T>
  T rate_of(const T& v, const T& v1, const T& v2, long states) const {
    if (states == 0 || std::isnan(step)) return v - v;
    return (second_order && states > 1 ? effects::bdf2(step, step) : effects::backward_euler(step)).rate(v, v1, v2);
  }
};
Integration integration_of(const Params& scene);

// Shares of its energy that what turns by phi in a step loses to it, by order (turning_loss.h).
struct LostInTurning {
  double first, second;
};
LostInTurning lost_in_turning(double phi);

class MovingBodies {
 public:
  explicit MovingBodies(const model::ModelInput& input);
  const HowHeld& how(std::size_t body) const { return who_[body].how; }
  // Once for every state. bodies: all but half-spaces. Empty where no velocities are reported.
  std::vector<MovingBody> state(const Snapshot& said, const std::vector<double>& points, const std::vector<MeasuredBody>& bodies);
  void checkpoint(Archive& archive);

 private:
  // Of a body, in the last state and in the one before.
  struct Past {
    double v[6] = {}, w[6] = {};
  };
  struct Who {
    HowHeld how;
    std::vector<std::string> stops;  // what says of its joints that they are at one
  };
  Integration integration_;
  std::vector<Who> who_;
  std::vector<Past> past_;
  long states_ = 0;  // before this one
};

// Distance of the farthest point of what a body hangs together with from its centre [m].
double radius_of_group(const std::vector<MovingBody>& bodies, const MovingBody& body, const std::vector<double>& points);

// Acceleration by the scene's loads, zero without [m/s^2].
Vec3 gravity_of(const Params& scene);

}  // namespace mortise::audit
