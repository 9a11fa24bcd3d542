#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "audit/advice.h"
#include "audit/certificate.h"
#include "audit/tuning.h"

namespace mortise::audit {

void Grade::Verdict::lower(const char* to, const std::string& why) {
  if (letter[0] < to[0]) letter = to, reason = why;
}

std::string text_of(const Grade& grade) {
  const auto of = [](const Grade::Verdict& v) { return v.letter == "A" ? v.letter : v.letter + ": " + v.reason; };
  if (grade.forces.letter == grade.all.letter) return "grade " + of(grade.all);
  return fmt::format("grade {}; of forces and motions {}", of(grade.all), of(grade.forces));
}

std::vector<std::string> hints(const Grade& grade) {
  std::vector<std::pair<std::string, std::string>> of;  // advice, and names of checks
  for (const Check& k : grade.failed) {
    const std::string help = advice(k.name, grade.has);
    if (help.empty() || !(grade.all.letter == k.earns() || (k.of != Of::fields && grade.forces.letter == k.earns()))) continue;
    const auto known = std::find_if(of.begin(), of.end(), [&](const auto& one) { return one.first == help; });
    if (known == of.end())
      of.emplace_back(help, k.name);
    else
      known->second += ", " + k.name;
  }
  std::vector<std::string> out;
  for (const auto& [help, names] : of) out.push_back(fmt::format("{}: {}", names, help));
  return out;
}

std::vector<Check> Certificate::checks(const End& end, const FieldErrors::Result& fields) const {
  const EnergyAudit::Result& energy = end.energy;
  std::vector<Check> all;
  const auto add = [&](const char* name, double value, const tuning::Bounds& bounds, Of of = Of::all) {
    if (std::isfinite(value)) all.push_back({name, value, bounds.good, bounds.usable, of});
  };
  add("residual_share", relative_residual_, tuning::kResidual);
  add("force_balance_defect", balance_relative_, tuning::kBalance);
  add("support_balance_defect", unsupported_relative_, tuning::kBalance);
  add("written_force_defect", written_relative_, tuning::kWritten);
  add("pressure_sum_defect", pressure_sum_.most, tuning::kPressureSum);
  add("clip_partition_defect", partition_.most, tuning::kPartition);
  add("rigidity_defect", rigidity_, tuning::kRigidity);
  add("stiff_strain", stiff_strain_.share(), tuning::kStiffStrain);
  add("energy_gain", energy.scale > 0 ? energy.largest_gain / energy.scale : NAN, tuning::kEnergyGain);
  add("free_motion_loss", energy.loss_scale > 0 ? std::min(std::max(energy.free_loss / energy.loss_scale, energy.own_loss), 1.0) : NAN,
      tuning::kFreeMotionLoss);
  add("stiff_impacts", energy.own_turnover > 0 ? std::max(energy.impacts / energy.own_turnover, energy.own_impacts) : NAN, tuning::kStiffImpacts);
  add("turning_loss", energy.own_scale > 0 ? std::max(energy.turning_loss / energy.own_scale, energy.own_turning) : NAN, tuning::kTurningLoss);
  add("given_turning_loss", energy.turnover > 0 ? energy.given_turning / energy.turnover : NAN, tuning::kGivenTurning);
  add("start_energy", energy.own_turnover > 0 ? energy.at_start / energy.own_turnover : NAN, tuning::kAtStart);
  add("schedule_missed", schedule_missed_, tuning::kMissed);
  add("motion_lag", energy.motion_lag, tuning::kMotionLag);
  add("given_lag", energy.given_lag, tuning::kGivenLag);
  if (asks_work_) add("work_lag", energy.work_lag, tuning::kWorkLag);
  add("given_kinks", energy.given_kinks, tuning::kGivenKinks, Of::forces);
  add("carried_force_lag", energy.carried_force, tuning::kCarriedForce, Of::forces);
  add("strikes_damped", energy.struck, tuning::kStruck, Of::forces);
  add("slip_turned_late", energy.slip_reversal, tuning::kSlipReversal);
  add("contact_force_lag", energy.late_inertia, tuning::kLateInertia, Of::forces);
  add("motor_lag", energy.motor_lag, tuning::kMotorLag);
  add("motor_torque_lag", energy.motor_torque_lag, tuning::kMotorLag, Of::forces);
  add("guard_share", fields.guard, tuning::kGuard, Of::fields);
  add("stress_error", fields.stress, tuning::kStress, Of::fields);
  add("buckling", energy.buckling, tuning::kBuckling);
  add("bond_overlap", energy.bond_overlap, tuning::kBondOverlap);
  add("stiffness_error", fields.stiffness, tuning::kStress, Of::forces);
  add("linear_law_turned", fields.turned, tuning::kTurned);
  add("load_turned", fields.load_turned, tuning::kLoadTurned);
  const double shape = std::fmax(shape_defect_, energy.held_weight);
  add("shape_defect", shape > 0 ? shape : NAN, tuning::kShape);
  add("friction_crept", std::fmax(crept_.share(), bearings_.share()), tuning::kCrept);
  add("touch_lag", touch_lag_.share(), tuning::kTouchLag);
  add("friction_turned", friction_turned_.share(), tuning::kFrictionTurned, Of::forces);
  add("slip_sampling", slip_sampling_.share(), tuning::kSlipSampling);
  add("pressure_roughness", fields.pressure.roughness, tuning::kRoughness, Of::fields);
  add("pressure_misfit", fields.pressure.misfit, tuning::kMisfit, Of::fields);
  add("layer_over_indentation", fields.layer, tuning::kLayer);
  add("layer_over_way", fields.layer_over_way, tuning::kLayerOverWay);
  add("facets_over_indentation", fields.facets > 0 ? fields.facets : NAN, tuning::kLayer);
  add("facets_over_way", fields.facets_over_way > 0 ? fields.facets_over_way : NAN, tuning::kLayerOverWay);
  add("facet_torque", energy.facet_torque, tuning::kFacetTorque, Of::forces);
  add("rim_error", fields.rim, tuning::kStress, Of::forces);
  add("quantity_error", end.quantity_error, tuning::kQuantity);
  return all;
}

// F: some state is no state of the model. C: incomplete, or the bound of B is exceeded. B: that of A is. A: none.
Grade Certificate::grade(const End& end, const std::vector<Check>& checks) const {
  const Grade::Verdict best{"A", "every bound is met"};
  Grade out{best, best, {}, {}, has_};
  const auto lower = [&](const char* to, const std::string& why, Of of = Of::all) {
    out.all.lower(to, why);
    if (of != Of::fields) out.forces.lower(to, why);
  };
  if (end.status == Exit::stopped)
    lower("C", "the run was stopped");
  else if (end.status == Exit::solve)
    lower("C", "a step did not converge");
  else if (end.status != Exit::done && end.status != Exit::checks)
    lower("F", "the run failed");
  for (const Check& k : checks) {
    out.graded[k.name] = k.value;
    const char* earns = k.earns();
    if (earns[0] == 'A') continue;
    out.failed.push_back(k);
    lower(earns, fmt::format("{} is {:.3g}, more than {:.3g}", k.name, k.value, earns[0] == 'B' ? k.good : k.usable), k.of);
  }
  if (steps_ == 0) lower("F", "no step was finished");
  if (det_F_.least <= 0) lower("F", "an element is inverted (det F <= 0)");
  if (distance_.least <= 0) lower("F", "surfaces touch or intersect");
  if (not_finite_ > 0) lower("F", "'" + first_not_finite_ + "' is not finite");
  return out;
}

}  // namespace mortise::audit
