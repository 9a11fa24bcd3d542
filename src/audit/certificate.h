#pragma once
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "audit/bearing_creep.h"
#include "audit/crept.h"
#include "audit/field_errors.h"
#include "audit/friction_turned.h"
#include "audit/grade.h"
#include "audit/slip_sampling.h"
#include "audit/state_audit.h"
#include "audit/stiff_strain.h"
#include "audit/touch_lag.h"
#include "base/archive.h"
#include "base/error.h"
#include "base/params.h"
#include "base/snapshot.h"
#include "solver/report.h"

namespace mortise::audit {

// How far a run can be trusted: what must hold of every state, how well each step was solved, what the contact model left between the
// surfaces, how large the errors of its meshes are, and grades with their first reasons. Gathered from what effects report at every step, so
// that it costs nothing; written as certificate.json (schemas/certificate.schema.json), also for a run that failed.
class Certificate {
 public:
  explicit Certificate(const model::ModelInput& input);

  void state(const Snapshot& said, double time = NAN);  // [s]
  // The step that led to the state reported last.
  void step(const solver::StepReport& report);
  // Everything gathered so far: a resumed run certifies the whole. What is added below has to be added there.
  void checkpoint(Archive& archive);

  struct End {
    std::string scene_name, scene_sha256, device;
    Exit status = Exit::done;
    std::string message;  // of the error, empty without one
    EnergyAudit::Result energy{};
    double quantity_error = NAN;  // the largest of what the scene names in `quantities`, a share of it
  };
  // Are there effects of contact, none of which ever had anything to do?
  bool nothing_touched() const { return steps_ > 0 && !d_hat_.empty() && gap_over_d_hat_.empty() && !(field_errors_.result().guard > 0); }
  Grade grade(const End& end) const { return grade(end, checks(end, field_errors_.result())); }
  struct Written {
    Grade grade;
    std::string json;
  };
  Written write(const End& end) const;  // certificate.json, and the grade in it
  std::string json(const End& end) const { return write(end).json; }

 private:
  struct Range {
    double least = NAN, most = NAN;
    void add(double v);
  };
  std::vector<Check> checks(const End& end, const FieldErrors::Result& fields) const;
  Grade grade(const End& end, const std::vector<Check>& checks) const;

  FieldErrors field_errors_;
  std::map<std::string, FrictionLaw> friction_laws_;
  Crept crept_;
  BearingCreep bearings_;
  TouchLag touch_lag_;
  SlipSampling slip_sampling_;
  FrictionTurned friction_turned_;
  StiffStrain stiff_strain_;
  double shape_defect_ = 0, schedule_missed_ = NAN;
  std::vector<std::string> passes_through_;  // what nothing keeps apart
  bool asks_work_ = false;                   // a quantity of the scene is the work of supports
  Has has_;
  std::vector<std::string> locking_risks_;
  std::map<std::string, std::string> volumetric_;  // how soft bodies resist changes of volume
  double force_floor_ = 0;                         // of strains and motions that are rounding [N]
  std::string inertia_;                            // the effect of that role, if there is one
  std::map<std::string, double> d_hat_;            // by contact effect [m]
  // Of all states
  long states_ = 0;
  Range distance_, det_F_, partition_;
  Range pressure_sum_;                           // samples against the forces on points, relative
  std::map<std::string, Range> gap_over_d_hat_;  // gap/d_hat of the samples that carry force, by effect
  std::map<std::string, double> kind_share_;     // share of force by kind of sample, last state
  long not_finite_ = 0;
  std::string first_not_finite_;
  // Sum of all forces, and what the supports of a body leave of its load; relative to the scale of force_balance()
  double balance_newton_ = NAN, balance_relative_ = NAN, unsupported_newton_ = NAN, unsupported_relative_ = NAN;
  double written_newton_ = NAN, written_relative_ = NAN;  // forces in the files against those of the solution
  double rigidity_ = NAN, tie_error_ = NAN;
  double first_energy_ = NAN, last_energy_ = NAN, largest_rise_ = NAN;
  double first_momentum_[3] = {NAN, NAN, NAN}, last_momentum_[3] = {NAN, NAN, NAN};
  // Of all steps
  long steps_ = 0, first_step_ = 0, newton_ = 0, most_newton_ = 0, lag_ = 0, cg_ = 0, halved_ = 0, line_search_ = 0, regularised_ = 0;
  double begin_ = NAN, end_ = NAN;
  double residual_ = NAN, over_tolerance_ = NAN, relative_residual_ = NAN, lag_residual_ = NAN, relative_lag_residual_ = NAN, least_alpha_ = NAN;
};

// certificate.json with `error_budget`, which is JSON.
std::string with_error_budget(const std::string& certificate, const std::string& budget);

}  // namespace mortise::audit
