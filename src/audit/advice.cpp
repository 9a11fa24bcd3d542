#include "audit/advice.h"

#include <fmt/format.h>

#include <map>

namespace mortise::audit {

std::string advice(std::string_view check, const Has& has) {
  static constexpr std::string_view kBalance = "a smaller solver.relative_tolerance; if that does not help, the defect is mortise's",
                                    kStiff = "a larger affine_body.stiffness", kDamps = "shorter steps (time.step), or inertia: {integrator: bdf2}",
                                    kMesh = "a finer mesh of what is stressed (edge_length; three elements across what is thin), or order: 2",
                                    kRound = "a finer mesh of round bodies, of stiff ones too (edge_length)",
                                    kLayer = "a smaller d_hat, or a finer mesh where it is left to the program";
  static const std::map<std::string_view, std::string_view> all{
      {"residual_share", "a smaller solver.relative_tolerance"},
      {"force_balance_defect", kBalance},
      {"support_balance_defect", kBalance},
      {"written_force_defect", kBalance},
      {"pressure_sum_defect", kBalance},
      {"clip_partition_defect", kBalance},
      {"rigidity_defect", kStiff},
      {"stiff_strain", kStiff},
      {"energy_gain", "shorter steps (time.step)"},
      {"free_motion_loss", kDamps},
      {"stiff_impacts", "a soft layer on what strikes: how far stiff bodies bounce off each other is in no law here"},
      {"turning_loss", kDamps},
      {"given_turning_loss", kDamps},
      {"start_energy", "more room between bodies at the start, or a smaller d_hat"},
      {"schedule_missed", "shorter steps, of which none goes past a turn or a pulse of a schedule"},
      {"motion_lag", kDamps},
      {"given_lag", "shorter steps (time.step), or inertia: {integrator: bdf2}; of tracks that go straight from key to key interpolation: smooth"},
      {"work_lag", kDamps},
      {"given_kinks", "keys whose velocities change over several steps, or, where peaks of forces count, inertia: {integrator: backward_euler}"},
      {"carried_force_lag", kDamps},
      {"strikes_damped", kDamps},
      {"contact_force_lag", kDamps},
      {"slip_turned_late", "shorter steps (time.step), or inertia: {integrator: backward_euler}"},
      {"motor_lag", kDamps},
      {"motor_torque_lag", kDamps},
      {"guard_share", "a finer mesh of the slave, or a larger d_hat"},
      {"stress_error", kMesh},
      {"stiffness_error", kMesh},
      {"buckling", "order: 2 or a finer mesh across what is slender, and a small push to the side (a load, a slanted start)"},
      {"linear_law_turned", "materials of model: neo_hookean or corotated"},
      {"load_turned", "smaller loads: a pressure_load keeps its direction while its faces turn"},
      {"shape_defect", kRound},
      {"friction_crept", "a smaller creep_speed of friction"},
      {"touch_lag", "shorter steps where bodies come to touch"},
      {"friction_turned", "more steps where what slips goes round a bend"},
      {"slip_sampling", "a finer mesh of what turns on what it bears on (edge_length)"},
      {"pressure_roughness", "mortar_contact with the finer mesh as the slave, a finer mesh, or gap: averaged"},
      {"pressure_misfit", "a finer mesh of what is pressed, and mortar_contact with consistent weights, which are its own"},
      {"layer_over_indentation", kLayer},
      {"layer_over_way", kLayer},
      {"facets_over_indentation", kRound},
      {"facets_over_way", kRound},
      {"bond_overlap", "let the stiff body end where a row of nodes does, or a finer mesh where it ends"},
      {"facet_torque", kRound},
      {"rim_error", "a finer mesh where the edge presses (edge_length)"},
      {"quantity_error", "what its error_budget names; 'mortise run --accuracy NAME=5%' looks for it"}};
  const auto it = all.find(check);
  if (it == all.end()) return {};
  const std::string_view text = it->second;
  const bool known = (text == kDamps && has.bdf2) || (text == kMesh && has.quadratic);
  std::string out(known ? text.substr(0, text.rfind(", or ")) : text);
  constexpr std::string_view kThinner = "a smaller d_hat";
  if (const std::size_t at = out.find(kThinner); at != out.npos && has.d_hat > 0)
    out.insert(at + kThinner.size(), fmt::format(" (it is {:.3g} mm)", 1e3 * has.d_hat));
  return out;
}

}  // namespace mortise::audit
