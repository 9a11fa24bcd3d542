#include <nlohmann/json.hpp>

#include "audit/certificate.h"
#include "base/json_text.h"
#include "base/version.h"
#include "output/json_number.h"

namespace mortise::audit {
namespace {

using Json = nlohmann::ordered_json;
using output::number_or_null;

const char* name_of(Of of) { return of == Of::all ? "all" : of == Of::forces ? "forces" : "fields"; }

}  // namespace

Certificate::Written Certificate::write(const End& end) const {
  const FieldErrors::Result fields = field_errors_.result();
  const std::vector<Check> checked = checks(end, fields);
  const Grade grades = grade(end, checked);
  Json graded = Json::array();
  for (const Check& k : checked)
    graded.push_back({{"name", k.name},
                      {"of", name_of(k.of)},
                      {"value", number_or_null(k.value)},
                      {"bound_A", k.good},
                      {"bound_B", k.usable},
                      {"grade", k.earns()}});

  Json j;
  j["filetype"] = "mortise certificate";
  j["version"] = {2, 0};
  j["mortise_version"] = version();
  j["git_sha1"] = git_sha1();
  j["scene"] = {{"name", end.scene_name}, {"sha256", end.scene_sha256}};
  j["device"] = end.device;
  j["exit_code"] = static_cast<int>(end.status);
  j["message"] = end.message;
  j["grade"] = grades.all.letter;
  j["reason"] = grades.all.reason;
  j["grade_forces"] = grades.forces.letter;
  j["reason_forces"] = grades.forces.reason;
  j["checks"] = graded;
  Json drift = Json::array();
  for (int a = 0; a < 3; ++a) drift.push_back(number_or_null(last_momentum_[a] - first_momentum_[a]));
  j["invariants"] = {{"min_distance_m", number_or_null(distance_.least)},
                     {"min_det_F", number_or_null(det_F_.least)},
                     {"not_finite_values", not_finite_},
                     {"force_balance_defect_N", number_or_null(balance_newton_)},
                     {"force_balance_defect_relative", number_or_null(balance_relative_)},
                     {"support_balance_defect_N", number_or_null(unsupported_newton_)},
                     {"support_balance_defect_relative", number_or_null(unsupported_relative_)},
                     {"written_force_defect_N", number_or_null(written_newton_)},
                     {"tie_error_m", number_or_null(tie_error_)},
                     {"pressure_sum_defect_relative", number_or_null(pressure_sum_.most)},
                     {"energy_first_J", number_or_null(first_energy_)},
                     {"energy_last_J", number_or_null(last_energy_)},
                     {"energy_largest_rise_J", number_or_null(largest_rise_)},
                     {"support_work_J", end.energy.work_is_known ? number_or_null(end.energy.support_work) : Json(nullptr)},
                     {"energy_gain_largest_J", number_or_null(end.energy.largest_gain)},
                     {"energy_gain_relative", end.energy.scale > 0 ? number_or_null(end.energy.largest_gain / end.energy.scale) : Json(nullptr)},
                     {"momentum_change_kg_m_per_s", drift}};
  j["solver"] = {{"steps", steps_},
                 {"first_step", first_step_},
                 {"newton_iterations_max", most_newton_},
                 {"newton_iterations_mean", steps_ > 0 ? number_or_null(static_cast<double>(newton_) / static_cast<double>(steps_)) : Json(nullptr)},
                 {"residual_max_N", number_or_null(residual_)},
                 {"residual_over_tolerance_max", number_or_null(over_tolerance_)},
                 {"halved_steps", halved_},
                 {"line_search_halvings", line_search_},
                 {"least_step_length", number_or_null(least_alpha_)},
                 {"regularised_factorisations", regularised_},
                 {"cg_iterations", cg_},
                 {"lag_rounds", lag_},
                 {"lag_residual_max_N", number_or_null(lag_residual_)},
                 {"lag_residual_share_max", number_or_null(relative_lag_residual_)},
                 {"residual_share_max", number_or_null(relative_residual_)}};
  Json contact = Json::object();
  for (const auto& [effect, d_hat] : d_hat_) {
    const auto gap = gap_over_d_hat_.find(effect);
    const Range range = gap == gap_over_d_hat_.end() ? Range{} : gap->second;
    contact[effect] = {{"d_hat_m", d_hat}, {"gap_over_d_hat_min", number_or_null(range.least)}, {"gap_over_d_hat_max", number_or_null(range.most)}};
  }
  Json shares = Json::object();
  for (const auto& [kind, share] : kind_share_) shares[kind] = number_or_null(share);
  j["model"] = {{"contact", contact},
                {"clip_partition_defect_max", number_or_null(partition_.most)},
                {"force_share_last", shares},
                {"rigidity_defect_max", number_or_null(rigidity_)},
                {"stress_error_estimate", number_or_null(fields.stress)},
                {"linear_law_turned", number_or_null(fields.turned)},
                {"pressure_roughness", number_or_null(fields.pressure.roughness)},
                {"pressure_misfit", number_or_null(fields.pressure.misfit)},
                {"layer_over_indentation", number_or_null(fields.layer)},
                {"nodes_under_pressure", fields.pressure.nodes},
                // What sticks creeps at most at this speed, where its contact changes all the time.
                {"friction_creep_bound_m", number_or_null(crept_.speed() * (end_ - begin_))}};
  j["model"]["volumetric"] = volumetric_;
  j["locking_risks"] = locking_risks_;
  j["passes_through"] = passes_through_;
  return {grades, json_text(j, 1) + "\n"};
}

std::string with_error_budget(const std::string& certificate, const std::string& budget) {
  Json j = Json::parse(certificate);
  j["error_budget"] = Json::parse(budget);
  return json_text(j, 1) + "\n";
}

}  // namespace mortise::audit
