#include "audit/certificate.h"

#include <algorithm>

#include "audit/entries.h"
#include "audit/schedule_missed.h"
#include "audit/shape_defect.h"
#include "audit/tuning.h"
#include "audit/volumetric.h"
#include "effects/contact/layer.h"
#include "effects/roles.h"
#include "engine/effect_tables.h"
#include "geometry/bounds.h"
#include "scene/pass_through.h"

namespace mortise::audit {
namespace {

void largest(double& most, double v) {
  if (std::isfinite(v) && !(most >= v)) most = v;
}

bool starts_with(const std::string& s, const std::string& head) { return s.rfind(head, 0) == 0; }

}  // namespace

void Certificate::Range::add(double v) {
  if (!std::isfinite(v)) return;
  if (!(least <= v)) least = v;
  if (!(most >= v)) most = v;
}

Certificate::Certificate(const model::ModelInput& input)
    : field_errors_(input),
      friction_laws_(friction_laws(input)),
      crept_(input),
      bearings_(input),
      touch_lag_(input),
      slip_sampling_(input),
      stiff_strain_(input),
      shape_defect_(shape_defect(input)),
      schedule_missed_(schedule_missed(input)) {
  const double dt = integration_of(input.scene).step;
  for (const model::BodyInput& body : input.bodies) {
    if (body.nodes.empty()) continue;
    const double size = geometry::bounds_of(body.nodes).size().norm();
    if (body.type == model::BodyType::soft)
      force_floor_ = std::max(force_floor_, tuning::kStrain * body.material.number("youngs_modulus") * size * size);
    // What moves by rounding in a step: m x/dt^2.
    if (std::isfinite(dt)) force_floor_ = std::max(force_floor_, tuning::kRounding * MeasuredBody(body, 0).mass() * size / (dt * dt));
  }
  const Params& scene = input.scene;
  for (const model::BodyInput& body : input.bodies)
    if (body.type == model::BodyType::soft) volumetric_[body.name] = volumetric(body);
  has_.bdf2 = integration_of(input.scene).second_order;
  const auto is_soft = [](const model::BodyInput& b) { return b.type == model::BodyType::soft; };
  has_.quadratic = std::all_of(input.bodies.begin(), input.bodies.end(), [&](const auto& b) { return !is_soft(b) || !b.midsides.empty(); });
  locking_risks_ = locking_risks(input);
  for (const scene::PassThrough& p : scene::pass_through(scene, engine::effect_tables())) passes_through_.push_back(p.text());
  for (const Params& asked : entries(scene, "quantities"))
    asks_work_ = asks_work_ || asked.text("value") == "supports/work" || asked.text("value") == "audit/support_work";
  const Params& effects = scene.at("effects");
  for (const std::string& name : effects::of_role(effects, effects::Role::contact)) {
    d_hat_[name] = effects::contact::support_radius(effects.at(name), input);
    has_.d_hat = std::max(has_.d_hat, d_hat_[name]);
  }
  for (const std::string& name : effects::of_role(effects, effects::Role::inertia)) inertia_ = name;
}

void Certificate::state(const Snapshot& said, double time) {
  const auto finite = [&](const std::string& name, double v) {
    if (!std::isfinite(v) && not_finite_++ == 0) first_not_finite_ = name;
  };
  for (const auto* tables : {&said.point, &said.row})  // cells are not numbers by design, on stiff bodies
    for (const auto& [name, values] : *tables)
      for (double v : values) finite(leaf_of(name), v);
  for (const auto& [name, v] : said.number) finite(leaf_of(name), v);

  double energy = 0;
  double unsupported = NAN;  // load of a held body that its supports do not bear [N]
  bool any_energy = false;
  for (const auto& [name, v] : said.number) {
    const std::string leaf = leaf_of(name);
    if (leaf == "min_distance") distance_.add(v);
    if (leaf == "det_F_min") det_F_.add(v);
    if (leaf == "clip_partition_defect") partition_.add(v);
    if (leaf == "rigidity_defect") largest(rigidity_, v);
    if (leaf == "tie_error") largest(tie_error_, v);
    if (leaf == "pressure_sum_defect") pressure_sum_.add(v);
    if (starts_with(name, "supports/") && leaf.ends_with("_defect")) largest(unsupported, v);
    if (leaf == "energy" || leaf == "kinetic_energy") energy += v, any_energy = true;
    if (starts_with(leaf, "force_share_")) kind_share_[leaf.substr(12)] = v;
  }
  const ForceBalance balance = force_balance(said);
  const std::vector<Rubbing> rubs = rubbing(friction_laws_, said);
  crept_.state(said, rubs), slip_sampling_.state(said, rubs), friction_turned_.state(rubs), bearings_.state(said), touch_lag_.state(said),
      stiff_strain_.state(said);
  if (states_++ > 0) field_errors_.state(said, time);  // where a run starts nothing is solved yet
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
  for (const auto& [effect, d_hat] : d_hat_) {
    const auto gap = said.row.find(effect + "/gap"), force = said.row.find(effect + "/force");
    if (gap == said.row.end() || force == said.row.end()) continue;
    for (std::size_t i = 0; i < std::min(gap->second.size(), force->second.size()); ++i)
      if (force->second[i] > 0) gap_over_d_hat_[effect].add(gap->second[i] / d_hat);
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
  field_errors_.checkpoint(archive);
  crept_.checkpoint(archive), bearings_.checkpoint(archive), touch_lag_.checkpoint(archive), slip_sampling_.checkpoint(archive),
      friction_turned_.checkpoint(archive), stiff_strain_.checkpoint(archive);
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
  crept_.step(r.dt), bearings_.step(r.dt), touch_lag_.step(r.substeps), slip_sampling_.step(r.dt);
  largest(residual_, r.residual);
  if (r.tolerance > 0) largest(over_tolerance_, r.residual / r.tolerance);
  largest(relative_residual_, r.lag > 0 ? r.relative_lag_residual : r.relative_residual);
  if (r.lag > 0) largest(lag_residual_, r.lag_residual), largest(relative_lag_residual_, r.relative_lag_residual);
  if (!(least_alpha_ <= r.alpha)) least_alpha_ = r.alpha;
}

}  // namespace mortise::audit
