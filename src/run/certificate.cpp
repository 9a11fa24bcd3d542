#include "run/certificate.h"

#include <algorithm>

#include "effects/contact/layer.h"
#include "effects/friction/creep.h"
#include "effects/roles.h"
#include "engine/effect_tables.h"
#include "geometry/bounds.h"
#include "run/tuning.h"
#include "run/volumetric.h"
#include "scene/pass_through.h"

namespace mortise::run {
namespace {

void largest(double& most, double v) {
  if (std::isfinite(v) && !(most >= v)) most = v;
}

// Contact samples by effect.
std::map<std::string, LayerError::Samples> samples_of(const Snapshot& said) {
  std::map<std::string, LayerError::Samples> out;
  for (const auto& [name, values] : said.row) {
    LayerError::Samples& of = out[group_of(name)];
    if (leaf_of(name) == "gap") of.gap = values;
    if (leaf_of(name) == "bodies") of.bodies = values;
    if (leaf_of(name) == "force" && values.components == 1) of.force = values;
    if (leaf_of(name) == "pair_bodies") of.pair_bodies = values;
    if (leaf_of(name) == "pair_force") of.pair_force = values;
    if (leaf_of(name) == "pair_moment") of.pair_moment = values;
  }
  return out;
}

bool starts_with(const std::string& s, const std::string& head) { return s.rfind(head, 0) == 0; }

}  // namespace

void Certificate::Range::add(double v) {
  if (!std::isfinite(v)) return;
  if (!(least <= v)) least = v;
  if (!(most >= v)) most = v;
}

Certificate::Certificate(const model::ModelInput& input) : stress_error_(input), pressure_error_(input), layer_error_(input), linear_law_(input) {
  for (const model::BodyInput& body : input.bodies) {
    if (body.type != model::BodyType::soft || body.nodes.empty()) continue;
    const double E = body.material.number("youngs_modulus"), size = geometry::bounds_of(body.nodes).size().norm();
    force_floor_ = std::max(force_floor_, tuning::kStrain * E * size * size),
    energy_floor_ = std::max(energy_floor_, tuning::kStrain * tuning::kStrain * E * size * size * size);
  }
  const Params& scene = input.scene;
  for (const model::BodyInput& body : input.bodies)
    if (body.type == model::BodyType::soft) volumetric_[body.name] = volumetric(body);
  locking_risks_ = locking_risks(input);
  for (const scene::PassThrough& p : scene::pass_through(scene, engine::effect_tables())) passes_through_.push_back(p.text());
  const Params& effects = scene.at("effects");
  for (const std::string& name : effects::of_role(effects, effects::Role::contact))
    d_hat_[name] = effects::contact::support_radius(effects.at(name), input);
  for (const std::string& name : effects::of_role(effects, effects::Role::follower))
    creep_speed_ = effects::friction::creep_speed(effects.at(name), input);
  for (const std::string& name : effects::of_role(effects, effects::Role::inertia)) inertia_ = name;
}

void Certificate::state(const Snapshot& said) {
  const auto finite = [&](const std::string& name, double v) {
    if (!std::isfinite(v) && not_finite_++ == 0) first_not_finite_ = name;
  };
  for (const auto* tables : {&said.point, &said.row})  // cells are not numbers by design, on stiff bodies
    for (const auto& [name, values] : *tables)
      for (double v : values) finite(leaf_of(name), v);
  for (const auto& [name, v] : said.number) finite(leaf_of(name), v);

  double energy = 0;
  double unsupported = NAN;             // load of a held body that its supports do not bear [N]
  double elastic = 0, guard_share = 0;  // [J], 1
  bool any_energy = false;
  for (const auto& [name, v] : said.number) {
    const std::string leaf = leaf_of(name);
    if (leaf == "min_distance") distance_.add(v);
    if (leaf == "det_F_min") det_F_.add(v);
    if (leaf == "clip_partition_defect") partition_.add(v);
    if (leaf == "rigidity_defect") largest(rigidity_, v);
    if (leaf == "tie_error") largest(tie_error_, v);
    if (leaf == "force_share_guard") guard_share = v;
    if (name == "elasticity/energy") elastic = v;
    if (leaf == "pressure_sum_defect") pressure_sum_.add(v);
    if (starts_with(name, "supports/") && leaf.ends_with("_defect")) largest(unsupported, v);
    if (leaf == "energy" || leaf == "kinetic_energy") energy += v, any_energy = true;
    if (starts_with(leaf, "force_share_")) kind_share_[leaf.substr(12)] = v;
  }
  const ForceBalance balance = force_balance(said);
  // Errors of fields are judged at the state that is loaded most; where a run starts nothing is solved yet.
  const bool solved = states_++ > 0;
  const auto stress = said.cell.find("cauchy_stress");
  const std::map<std::string, LayerError::Samples> samples = samples_of(said);
  double pressed = 0;
  const auto of_points = [&](const char* name, int components) {
    const Snapshot::Values* v = said.of_points(name, components);
    return v ? std::span<const double>(*v) : std::span<const double>();
  };
  if (solved && stress != said.cell.end() && elastic > std::max(most_elastic_, energy_floor_)) {
    most_elastic_ = elastic, stress_estimate_ = stress_error_.of(stress->second, of_points("displacement", 3));
    turned_ = linear_law_.of(of_points("displacement", 3));
  }
  const std::span<const double> pressure = of_points("contact_pressure", 1);
  for (double p : pressure) pressed += std::max(p, 0.0);
  if (solved && pressed > most_pressed_) {
    most_pressed_ = pressed, guard_share_ = guard_share;
    pressure_estimate_ = pressure_error_.of({pressure, of_points("contact_force", 3), of_points("displacement", 3), of_points("contact_area", 1)});
  }
  // Of states with as much the latest: a motor that reaches its limit gives the same force from then on, and no travel.
  if (solved && pressed > 0 && pressed >= (1 - tuning::kAsMuch) * most_pressed_) {
    layer_ = NAN;
    const LayerError::Fields fields{of_points("displacement", 3), of_points("support_force", 3), of_points("tie_force", 3),
                                    of_points("contact_force", 3), pressure};
    for (const auto& [effect, of] : samples)
      if (!of.gap.empty() && of.bodies.size() == 2 * of.force.size()) layer_ = std::fmax(layer_, layer_error_.of(of, fields, said.number));
  }
  largest(written_newton_, said.at("balance/written_defect"));
  largest(balance_newton_, balance.defect);
  largest(unsupported_newton_, unsupported);
  const double scale = std::max(balance.scale, force_floor_);  // forces below are rounding
  if (scale > 0) {
    largest(balance_relative_, balance.defect / scale);
    largest(written_relative_, said.at("balance/written_defect") / scale);
    largest(unsupported_relative_, unsupported / scale);
  }
  if (any_energy) {
    if (std::isnan(first_energy_))
      first_energy_ = energy;
    else
      largest(largest_rise_, energy - last_energy_);
    last_energy_ = energy;
  }
  for (int a = 0; a < 3; ++a) {
    const double m = said.at(inertia_ + "/momentum_" + "xyz"[a]);
    if (std::isnan(first_momentum_[a])) first_momentum_[a] = m;
    last_momentum_[a] = m;
  }
  for (const auto& [effect, of] : samples) {
    const auto d_hat = d_hat_.find(effect);
    if (d_hat == d_hat_.end()) continue;
    for (std::size_t i = 0; i < std::min(of.gap.size(), of.force.size()); ++i)
      if (of.force[i] > 0) gap_over_d_hat_[effect].add(of.gap[i] / d_hat->second);
  }
}

void Certificate::checkpoint(Archive& archive) {
  const auto range = [&](const std::string& name, Range& r) {
    archive.io(name + "_least", r.least);
    archive.io(name + "_most", r.most);
  };
  range("distance", distance_), range("det_F", det_F_), range("partition", partition_), range("pressure_sum", pressure_sum_);
  std::map<std::string, double> least, most;
  for (const auto& [effect, r] : gap_over_d_hat_) least[effect] = r.least, most[effect] = r.most;
  archive.io("gap_share_least", least);
  archive.io("gap_share_most", most);
  for (const auto& [effect, v] : least) gap_over_d_hat_[effect] = {v, most.at(effect)};
  archive.io("kind_share", kind_share_);
  archive.io("first_not_finite", first_not_finite_);
  archive.io("pressure_roughness", pressure_estimate_.roughness);
  archive.io("pressure_misfit", pressure_estimate_.misfit);
  archive.io("pressure_nodes", pressure_estimate_.nodes);
  for (auto [name, value] : {std::pair{"not_finite", &not_finite_},
                             {"states", &states_},
                             {"steps", &steps_},
                             {"first_step", &first_step_},
                             {"newton", &newton_},
                             {"most_newton", &most_newton_},
                             {"lag", &lag_},
                             {"cg", &cg_},
                             {"halved", &halved_},
                             {"line_search", &line_search_},
                             {"regularised", &regularised_}})
    archive.io(name, *value);
  for (auto [name, value] : {std::pair{"balance_newton", &balance_newton_},
                             {"balance_relative", &balance_relative_},
                             {"unsupported_newton", &unsupported_newton_},
                             {"unsupported_relative", &unsupported_relative_},
                             {"written_newton", &written_newton_},
                             {"written_relative", &written_relative_},
                             {"rigidity", &rigidity_},
                             {"tie_error", &tie_error_},
                             {"most_elastic", &most_elastic_},
                             {"stress_estimate", &stress_estimate_},
                             {"turned", &turned_},
                             {"most_pressed", &most_pressed_},
                             {"guard_share", &guard_share_},
                             {"layer", &layer_},
                             {"first_energy", &first_energy_},
                             {"last_energy", &last_energy_},
                             {"largest_rise", &largest_rise_},
                             {"begin", &begin_},
                             {"end", &end_},
                             {"residual", &residual_},
                             {"over_tolerance", &over_tolerance_},
                             {"residual_share", &relative_residual_},
                             {"lag_residual", &lag_residual_},
                             {"lag_share", &relative_lag_residual_},
                             {"least_alpha", &least_alpha_},
                             {"first_momentum_x", &first_momentum_[0]},
                             {"first_momentum_y", &first_momentum_[1]},
                             {"first_momentum_z", &first_momentum_[2]},
                             {"last_momentum_x", &last_momentum_[0]},
                             {"last_momentum_y", &last_momentum_[1]},
                             {"last_momentum_z", &last_momentum_[2]}})
    archive.io(name, *value);
}

void Certificate::step(const solver::StepReport& r) {
  if (steps_ == 0) first_step_ = r.step + 1, begin_ = r.time - r.dt;
  ++steps_, end_ = r.time;
  newton_ += r.newton, lag_ += r.lag, cg_ += r.cg, line_search_ += r.line_search, regularised_ += r.regularised;
  most_newton_ = std::max<long>(most_newton_, r.newton);
  if (r.substeps > 1) ++halved_;
  largest(residual_, r.residual);
  if (r.tolerance > 0) largest(over_tolerance_, r.residual / r.tolerance);
  largest(relative_residual_, r.lag > 0 ? r.relative_lag_residual : r.relative_residual);
  if (r.lag > 0) largest(lag_residual_, r.lag_residual), largest(relative_lag_residual_, r.relative_lag_residual);
  if (!(least_alpha_ <= r.alpha)) least_alpha_ = r.alpha;
}

}  // namespace mortise::run
