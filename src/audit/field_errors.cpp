#include "audit/field_errors.h"

#include <algorithm>
#include <cmath>

#include "audit/holds.h"
#include "audit/tuning.h"
#include "audit/vector_at.h"
#include "base/disjoint_sets.h"
#include "geometry/bounds.h"

namespace mortise::audit {

FieldErrors::FieldErrors(const model::ModelInput& input)
    : stress_(input),
      stiffness_(input),
      pressure_(input),
      rim_(input),
      layer_(input),
      facets_(input),
      linear_law_(input),
      load_turned_(input),
      phases_(phases(input.scene.at("effects"))) {
  const Holds holds(input.scene.at("effects"));
  std::map<std::string, std::size_t> number;
  for (const model::BodyInput& body : input.bodies) {
    if (body.type == model::BodyType::half_space) continue;
    const bool soft = body.type == model::BodyType::soft;
    number[body.name] = passes_on_.size();
    passes_on_.push_back(soft || !holds.held(body.name));
    if (!soft || body.nodes.empty()) continue;
    const double E = body.material.number("youngs_modulus"), size = geometry::bounds_of(body.nodes).size().norm();
    energy_floor_ = std::max(energy_floor_, tuning::kStrain * tuning::kStrain * E * size * size * size);
  }
  for (const auto& [one, other] : holds.together())
    if (number.count(one) && number.count(other) && passes_on_[number[one]] && passes_on_[number[other]])
      tied_.emplace_back(number[one], number[other]);
}

FieldErrors::AllSamples FieldErrors::samples_of(const Snapshot& said) {
  AllSamples out;
  for (const auto& [name, values] : said.row) {
    Samples& of = out[group_of(name)];
    const std::string leaf = leaf_of(name);
    if (leaf == "gap") of.pressed.gap = values;
    if (leaf == "bodies") of.pressed.bodies = values;
    if (leaf == "force" && values.components == 1) of.pressed.force = values;
    if (leaf == "pair_bodies") of.pressed.pair_bodies = values;
    if (leaf == "pair_force") of.pressed.pair_force = values;
    if (leaf == "pair_moment") of.pressed.pair_moment = values;
    if (leaf == "guard_bodies") of.guard_bodies = values;
    if (leaf == "guard_force") of.guard_force = values;
  }
  std::erase_if(out, [](const auto& of) { return of.second.pressed.bodies.size() != 2 * of.second.pressed.force.size(); });
  return out;
}

double FieldErrors::elastic_of(const Snapshot& said) {
  const double energy = said.at("elasticity/energy");
  return said.cell.count("cauchy_stress") && std::isfinite(energy) ? energy : 0;
}

double FieldErrors::pressed_of(const Snapshot& said) {
  double sum = 0;
  for (double p : of_points(said, "contact_pressure", 1)) sum += std::max(p, 0.0);
  return sum;
}

// By body: one of those that it presses, or is tied to, all the way through what passes that on.
std::vector<std::size_t> FieldErrors::groups(const AllSamples& samples) const {
  DisjointSets sets(passes_on_.size());
  const auto join = [&](const std::vector<double>& bodies, const std::vector<double>& force) {
    for (std::size_t i = 0; i < force.size() && 2 * i + 1 < bodies.size(); ++i) {
      const auto a = static_cast<std::size_t>(bodies[2 * i]), b = static_cast<std::size_t>(bodies[2 * i + 1]);
      if (force[i] != 0 && a < passes_on_.size() && b < passes_on_.size() && passes_on_[a] && passes_on_[b]) sets.join(a, b);
    }
  };
  for (const auto& [effect, of] : samples) join(of.pressed.bodies, of.pressed.force), join(of.guard_bodies, of.guard_force);
  for (const auto& [a, b] : tied_) sets.join(a, b);
  std::vector<std::size_t> out(passes_on_.size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = sets.of(i);
  return out;
}

void FieldErrors::judge(State& state, Judged what, Result& r) const {
  Judged& done = state.judged;
  const Judged open{what.stress && !done.stress, what.pressure && !done.pressure, what.layer && !done.layer};
  if (open.stress || open.pressure || open.layer) {
    const AllSamples samples = samples_of(state.said);
    if (open.stress) judge_stress(state.said, samples, state.result);
    if (open.pressure) judge_pressure(state.said, samples, state.result);
    if (open.layer) judge_layer(state.said, samples, state.result);
    done = {done.stress || open.stress, done.pressure || open.pressure, done.layer || open.layer};
  }
  const auto take = [&](auto... of) { ((r.*of = state.result.*of), ...); };
  if (what.stress) take(&Result::stress, &Result::stiffness, &Result::turned, &Result::load_turned);
  if (what.pressure) take(&Result::pressure, &Result::guard);
  if (what.layer) take(&Result::layer, &Result::layer_over_way, &Result::rim, &Result::facets, &Result::facets_over_way);
}

LayerError::Fields FieldErrors::fields_of(const Snapshot& said) {
  return {of_points(said, "displacement", 3), of_points(said, "support_force", 3), of_points(said, "tie_force", 3),
          of_points(said, "contact_force", 3), of_points(said, "contact_pressure", 1)};
}

ContactPatch::Fields FieldErrors::patch_of(const Snapshot& said) {
  return {of_points(said, "contact_pressure", 1), of_points(said, "contact_force", 3), of_points(said, "displacement", 3),
          of_points(said, "contact_area", 1)};
}

FieldErrors::OfStress FieldErrors::of_stress(const StressError::Stresses& stresses, std::span<const double> displacement, const Snapshot& said,
                                             const AllSamples& samples) const {
  const std::vector<std::size_t> group = groups(samples);
  LayerError::Fields fields = fields_of(said);
  const StressError::Estimate estimate = stress_.of(stresses, group, fields.contact, fields.displacement);
  fields.displacement = displacement;  // their change, in a phase
  return {estimate.energy, estimate.error(),
          stiffness_.of(estimate.errors, group, travels(said, samples), bases(fields), displacement, estimate.bending)};
}

std::vector<LayerError::Travel> FieldErrors::travels(const Snapshot& said, const AllSamples& samples) const {
  std::vector<LayerError::Travel> out;
  for (const auto& [effect, of] : samples)
    if (!of.pressed.gap.empty())
      for (LayerError::Travel& t : layer_.travels(of.pressed, fields_of(said), said.number)) out.push_back(std::move(t));
  return out;
}

StiffnessError::Bases FieldErrors::bases(const LayerError::Fields& fields) const {
  StiffnessError::Bases out;
  for (std::size_t b = 0; b < passes_on_.size(); ++b) out.push_back(layer_.motion_of_supports(b, fields));
  return out;
}

void FieldErrors::judge_stress(const Snapshot& said, const AllSamples& samples, Result& r) const {
  const std::span<const double> displacement = of_points(said, "displacement", 3);
  const OfStress of = of_stress(stress_.stresses(said.cell.at("cauchy_stress"), displacement), displacement, said, samples);
  r.stress = of.stress, r.stiffness = of.stiffness;
  r.turned = linear_law_.of(displacement), r.load_turned = load_turned_.of(displacement);
}

void FieldErrors::judge_pressure(const Snapshot& said, const AllSamples& samples, Result& r) const {
  r.pressure = pressure_.of(patch_of(said), groups(samples));
  struct Force {
    double all = 0, guard = 0;
  };
  r.guard = NAN;
  for (const auto& [effect, of] : samples) {
    std::map<std::pair<double, double>, Force> pairs;
    const auto add = [&](const std::vector<double>& bodies, const std::vector<double>& force, double Force::*part) {
      for (std::size_t i = 0; i < force.size() && 2 * i + 1 < bodies.size(); ++i)
        pairs[std::minmax(bodies[2 * i], bodies[2 * i + 1])].*part += std::abs(force[i]);
    };
    add(of.pressed.bodies, of.pressed.force, &Force::all), add(of.guard_bodies, of.guard_force, &Force::guard);
    double most = 0;
    for (auto& [bodies, f] : pairs) f.all += f.guard, most = std::max(most, f.all);
    for (const auto& [bodies, f] : pairs)
      if (f.all > 0 && f.all >= tuning::kStillLoaded * most) r.guard = std::fmax(r.guard, f.guard / f.all);
  }
}

void FieldErrors::judge_layer(const Snapshot& said, const AllSamples& samples, Result& r) const {
  const LayerError::Fields fields = fields_of(said);
  const StiffnessError::Bases bases = this->bases(fields);
  const std::vector<std::size_t> group = groups(samples);
  const std::vector<LayerError::Travel> travels = this->travels(said, samples);
  r.rim = stiffness_.of(rim_.of(pressure_.patch(), patch_of(said), group), group, travels, bases, fields.displacement);
  r.layer = LayerError::worst(travels);
  r.layer_over_way = NAN;
  for (const auto& [effect, of] : samples)
    if (!of.pressed.gap.empty()) r.layer_over_way = std::fmax(r.layer_over_way, stiffness_.layer_over_way(of.pressed, bases, fields.displacement));
  r.facets = r.facets_over_way = NAN;
  if (!facets_.any()) return;
  for (const auto& [effect, of] : samples) {
    if (of.pressed.gap.empty()) continue;
    const LayerError::Samples deep = facets_.of(of.pressed, layer_, fields);
    r.facets = std::fmax(r.facets, LayerError::worst(layer_.travels(deep, fields, said.number), false));
    r.facets_over_way = std::fmax(r.facets_over_way, stiffness_.layer_over_way(deep, bases, fields.displacement));
  }
}

void FieldErrors::phase(const Snapshot& said, double time) {
  // Times are sums of steps: a hair of rounding decides nothing.
  if (std::isnan(time)) return;
  const long before = phase_;
  bool moves = false;
  for (; phase_ < static_cast<long>(phases_.size()) && phases_[phase_].end <= time * (1 + tuning::kRounding); ++phase_)
    moves |= phases_[phase_].moves;
  if (phase_ == before) return;
  const auto stress = said.cell.find("cauchy_stress");
  if (stress == said.cell.end()) return;
  const std::span<const double> displacement = of_points(said, "displacement", 3);
  StressError::Stresses change = stress_.stresses(stress->second, displacement);
  std::vector<double> moved(displacement.begin(), displacement.end());
  if (!stress_then_.empty()) {
    change = StressError::change(std::move(change), stress_.stresses(stress_then_, displacement_then_));
    for (std::size_t i = 0; i < std::min(moved.size(), displacement_then_.size()); ++i) moved[i] -= displacement_then_[i];
  }
  if (moves) {  // what is held only settles
    const OfStress of = of_stress(change, moved, said, samples_of(said));
    changed_.push_back(of.energy), changed_badly_.push_back(of.stress), changed_forces_.push_back(of.stiffness);
  }
  stress_then_ = stress->second, displacement_then_.assign(displacement.begin(), displacement.end());
}

double FieldErrors::of_phases(const std::vector<double>& errors) const {
  double worst = NAN;
  for (std::size_t i = 0; i < changed_.size(); ++i)
    if (changed_[i] > energy_floor_ && changed_[i] >= tuning::kNoticed * tuning::kNoticed * most_elastic_) worst = std::fmax(worst, errors[i]);
  return worst;
}

void FieldErrors::state(const Snapshot& said, double time) {
  phase(said, time);
  const double elastic = elastic_of(said), pressed = pressed_of(said);
  const Judged what{elastic > std::max(most_elastic_, energy_floor_), pressed > most_pressed_,
                    // Of states with as much the latest: a motor that reaches its limit gives the same force from then on, and no travel.
                    pressed > 0 && pressed >= (1 - tuning::kAsMuch) * std::max(most_pressed_, pressed)};
  last_ = std::make_shared<State>(State{said, {}, {}}), resumed_ = false;
  if (what.stress) most_elastic_ = elastic, stressed_ = last_;
  if (what.pressure) most_pressed_ = pressed, pressed_ = last_;
  if (what.layer) layered_ = last_;
  if (!said.cell.count("cauchy_stress"))  // no elastic energy tells when stiff bodies are loaded most
    at_most_.load_turned = std::fmax(at_most_.load_turned, load_turned_.of(of_points(said, "displacement", 3)));
}

FieldErrors::Result FieldErrors::at_most() const {
  Result out = at_most_;
  if (stressed_) judge(*stressed_, {.stress = true}, out);
  if (pressed_) judge(*pressed_, {.pressure = true}, out);
  if (layered_) judge(*layered_, {.layer = true}, out);
  return out;
}

FieldErrors::Result FieldErrors::at_last() const {
  if (resumed_) return resumed_last_;
  Result out;
  if (!last_) return out;
  const double elastic = elastic_of(last_->said), pressed = pressed_of(last_->said);
  const bool loaded = pressed > 0 && pressed >= tuning::kStillLoaded * most_pressed_;
  judge(*last_, {elastic > energy_floor_ && elastic >= tuning::kStillLoaded * tuning::kStillLoaded * most_elastic_, loaded, loaded}, out);
  out.turned = linear_law_.of(of_points(last_->said, "displacement", 3));  // what is free grows where it turns, without a stress
  return out;
}

FieldErrors::Result FieldErrors::result() const {
  Result out = at_most();
  const Result last = at_last();
  for (double Result::*of : {&Result::stress, &Result::stiffness, &Result::turned, &Result::load_turned, &Result::guard, &Result::layer,
                             &Result::layer_over_way, &Result::rim, &Result::facets, &Result::facets_over_way})
    out.*of = std::fmax(out.*of, last.*of);
  for (double PressureError::Result::*of : {&PressureError::Result::roughness, &PressureError::Result::misfit})
    out.pressure.*of = std::fmax(out.pressure.*of, last.pressure.*of);
  out.stress = std::fmax(out.stress, of_phases(changed_badly_));
  out.stiffness = std::fmax(out.stiffness, of_phases(changed_forces_));
  return out;
}

void FieldErrors::io(Archive& archive, const std::string& prefix, Result& r) {
  for (auto [name, value] : {std::pair{"stress", &r.stress},
                             {"stiffness", &r.stiffness},
                             {"turned", &r.turned},
                             {"load_turned", &r.load_turned},
                             {"guard", &r.guard},
                             {"roughness", &r.pressure.roughness},
                             {"misfit", &r.pressure.misfit},
                             {"layer", &r.layer},
                             {"layer_over_way", &r.layer_over_way},
                             {"rim", &r.rim},
                             {"facets", &r.facets},
                             {"facets_over_way", &r.facets_over_way}})
    archive.io(prefix + name, *value);
  archive.io(prefix + "pressure_nodes", r.pressure.nodes);
}

void FieldErrors::checkpoint(Archive& archive) {
  archive.io("most_elastic", most_elastic_);
  archive.io("most_pressed", most_pressed_);
  for (auto [name, values] : {std::pair{"stress_then", &stress_then_},
                              {"displacement_then", &displacement_then_},
                              {"changed", &changed_},
                              {"changed_badly", &changed_badly_},
                              {"changed_forces", &changed_forces_}})
    archive.io(name, *values);
  archive.io("phase", phase_);
  if (!archive.loading()) at_most_ = at_most(), stressed_ = pressed_ = layered_ = nullptr;
  io(archive, "at_most_", at_most_);
  resumed_last_ = archive.loading() ? Result{} : at_last();
  io(archive, "at_last_", resumed_last_);
  resumed_ = resumed_ || archive.loading();
}

}  // namespace mortise::audit
