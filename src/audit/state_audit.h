#pragma once
// Energy and balance of the states of a run, from what effects report of each: `mortise run` writes them to every frame (group `audit` of
// fields.vtkhdf) and to certificate.json, and judges criteria by them.
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "audit/bond_overlap.h"
#include "audit/bounce_loss.h"
#include "audit/buckling.h"
#include "audit/carried_force.h"
#include "audit/energy_scale.h"
#include "audit/facet_torque.h"
#include "audit/given_kinks.h"
#include "audit/given_lag.h"
#include "audit/held_weight.h"
#include "audit/late_inertia.h"
#include "audit/measured_body.h"
#include "audit/motion_lag.h"
#include "audit/motor_lag.h"
#include "audit/own_energy.h"
#include "audit/slip_reversal.h"
#include "audit/soft_phase.h"
#include "audit/spin_loss.h"
#include "audit/steady_motion.h"
#include "audit/strain_energy.h"
#include "audit/struck.h"
#include "audit/swing_loss.h"
#include "audit/swing_phase.h"
#include "audit/to_and_fro_loss.h"
#include "audit/turning_loss.h"
#include "audit/vibration_loss.h"
#include "base/archive.h"
#include "base/snapshot.h"
#include "model/input.h"

namespace mortise::audit {

// The report of one state.
struct StateReport {
  const Snapshot& said;
  const std::vector<double>& points;  // 3 per point [m]

  Vec3 vector(const std::string& stem) const { return {said.at(stem + "x"), said.at(stem + "y"), said.at(stem + "z")}; }
  // Vectors at points; null where no effect reported them.
  const std::vector<double>* field(const char* name) const {
    const Snapshot::Values* v = said.of_points(name, 3);
    return v && !v->empty() ? v : nullptr;
  }
};

// Sum of all forces [N], and what it is to be held against: the largest force of one effect on one body or, where larger, what supports hold
// the points with, or bodies press each other with, summed without regard to direction (forces inside of one body have no resultant, and few of
// what presses it from all sides). NaN before anything was solved.
struct ForceBalance {
  double defect = NAN, scale = NAN;
};
ForceBalance force_balance(const Snapshot& said);

class EnergyAudit {
 public:
  explicit EnergyAudit(const model::ModelInput& input);

  struct Result {
    double total = NAN;         // kinetic and stored energy [J], without the turning of pinned stiff bodies, whose moment is not reported
    double support_work = 0;    // of moving supports since the start [J]
    double work_lag = 0;        // what that errs by, over what it is or a tenth of the largest that it was
    double gain = NAN;          // of this step: change of total less the work of supports [J]; NaN: the first state
    double largest_gain = NAN;  // of all steps so far [J]
    double scale = 0;           // largest energy of the run so far [J]
    double turnover = 0;        // that or, where more, all work of supports, there and back [J]
    double loss_scale = 0;      // the same without the energy of what only goes on (steady_motion.h) [J]
    double own_scale = 0, own_turnover = 0;  // the same without what is given (own_energy.h) [J]
    // Of energy, the time step's doing [J]: between states in which nothing touches or is at a stop, while nothing is driven; otherwise
    // vibration_loss.h; and bounce_loss.h.
    double free_loss = 0;
    double impacts = 0;   // in doubt after impacts of stiff bodies (bounce_loss.h) [J]
    double at_start = 0;  // energy that contact has in the first state and gives away [J]
    // The largest share of what it has itself that a body or mechanism lost in bounces (bounce_loss.h), alone (vibration_loss.h), or while it swings
    // on what carries it (swing_loss.h) or goes to and fro on what it lies on (to_and_fro_loss.h); and the share of it that impacts leave in doubt.
    double own_loss = 0;
    double own_impacts = 0;
    double turning_loss = NAN;                       // turning_loss.h [J]
    double given_turning = 0;                        // the same of what kinematic drives turn [J]
    double own_turning = 0;                          // the same of one body that spins or is carried, a share of its own energy (spin_loss.h)
    double motion_lag = NAN;                         // motion_lag.h, swing_phase.h, soft_phase.h
    double given_lag = NAN;                          // given_lag.h
    double held_weight = NAN;                        // held_weight.h
    double buckling = NAN;                           // buckling.h
    double bond_overlap = NAN;                       // bond_overlap.h
    double facet_torque = NAN;                       // facet_torque.h
    double given_kinks = NAN;                        // given_kinks.h
    double carried_force = NAN, struck = NAN;        // carried_force.h, struck.h
    double late_inertia = NAN, slip_reversal = NAN;  // late_inertia.h, slip_reversal.h
    double motor_lag = NAN, motor_torque_lag = NAN;  // motor_lag.h: of ways, of torques
    bool work_is_known = true;  // false: loads do work whose potential is not reported, or nothing moves in time; then `gain` stays NaN
  };
  const Result& state(const StateReport& now);
  void step(bool first_order);  // that led to the state
  const Result& result() const { return r_; }
  void checkpoint(Archive& archive);

 private:
  double total(const StateReport& now);
  void contact_energy(const StateReport& now);
  double turning(const StateReport& now) const;
  std::vector<double> forces_on(const StateReport& now) const;  // [N]
  double support_work(const StateReport& now) const;
  void measured();  // all that other classes measure, into the result

  std::vector<MeasuredBody> bodies_;
  std::vector<StrainEnergy> elastic_;          // of every body; nothing of stiff ones
  std::vector<std::string> loads_, contacts_;  // effects of these roles
  Result r_;
  MovingBodies moving_;
  OwnEnergy own_;
  MotionLag lag_;
  GivenLag given_lag_;
  HeldWeight held_weight_;
  FacetTorque facet_torque_;
  Buckling buckling_;
  BondOverlap bond_overlap_;
  GivenKinks given_kinks_;
  CarriedForce carried_;
  Struck struck_;
  LateInertia late_;
  SlipReversal slip_reversal_;
  MotorLag motor_lag_;
  TurningLoss turning_;
  SpinLoss spin_;
  ToAndFroLoss to_and_fro_;
  BounceLoss bounces_;
  VibrationLoss vibrations_;
  SwingLoss swings_;
  SwingPhase phase_;
  SoftPhase soft_phase_;
  SteadyMotion steady_;
  EnergyScale scale_, own_scale_;                     // of all, and without what is given
  double rubbed_ = 0;                                 // by friction so far [J]
  double work_lag_ = 0, work_most_ = 0;               // of supports so far: what their work errs by, and the largest that it was [J]
  double pressed_first_ = NAN, pressed_least_ = NAN;  // energy of contact in the first state, and the least since [J]
  double all_ = NAN;                                  // total energy, turning of pinned bodies included
  std::vector<double> points_before_;
  double gravity_first_ = NAN;
  std::vector<double> least_;  // by body: energy of motions that are rounding [J]
  double free_ = 0;            // lost where the balance of energies tells it [J]
  double stored_ = 0;          // of the state, without gravity [J]
  bool moves_ = false;         // velocities are reported
  bool touched_ = false;       // something, in the state before
  bool soft_ = true;           // all bodies
  bool balanced_ = false;      // what the last step lost is in the balance of energies
};

}  // namespace mortise::audit
