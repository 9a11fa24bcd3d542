#include "solver/energy_ledger.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "effects/per_environment.h"
#include "solver/flatten.h"
#include "solver/kernels.h"
#include "solver/tuning.h"

namespace mortise::solver {

static bool moves(const effects::Effect& effect) { return effect.kind().role == effects::Role::motor; }

EnergyLedger::EnergyLedger(const model::Model& model, Potential& potential)
    : model_(model),
      potential_(potential),
      started_(model.envs, 0),
      gone_(model.envs, 0),
      step_(model.envs),
      owed_(model.envs, 0.0),
      owed_second_(model.envs, -1.0) {
  bool motors = false, second_order = false;
  for (const auto& effect : potential_.effects()) {
    measures_ = measures_ || effect->loses_energy();
    motors = motors || moves(*effect);
    for (Index e = 0; e < model.envs; ++e) second_order = second_order || effect->starts(e);
  }
  if (motors) drivers_.push_back(Driver::motors);
  drivers_.push_back(Driver::supports);
  if (model.ties.driven()) drivers_.push_back(Driver::ties);
  const bool driven = model.driven || model.ties.driven();
  remembers_ = driven || (second_order && motors);
  if (!remembers_) return;
  if (second_order && driven) drivers_.push_back(Driver::given);
  for (Driver d : drivers_) {
    last_[d].resize(model.blocks);
    last_[d].zero();
  }
  lately_.assign(model.envs, 0.0);
}

void EnergyLedger::gradient_of(Driver driver, const Linearised& at, device::Buffer<Vec3>& sum) const {
  sum.resize(model_.blocks);
  sum.zero();
  if (driver == Driver::supports) return add(at.gradient.view(), sum);
  for (std::size_t k = 0; k < potential_.effects().size(); ++k) {
    const effects::Effect& effect = *potential_.effects()[k];
    const device::Buffer<Vec3>& g = at.gradients[k];
    if (driver == Driver::ties || (driver == Driver::motors && moves(effect))) add(g.view(), sum);
    if (driver != Driver::given || effect.kind().role != effects::Role::inertia) continue;
    for (const model::Body& body : model_.bodies)
      if (body.prescribed()) copy_blocks(g, body.block_begin, body.block_end, sum);
  }
}

static double next_owed_second(double owed, const StepEnergy& step) {
  if (!step.second_order) return -1;
  if (owed < 0) return std::max(-step.gain, 0.0);
  return tuning::kOwedSecondOn * std::max(owed - std::max(step.gain, 0.0), 0.0);
}

void EnergyLedger::accept(const EnvMask& whose, const Linearised& at) {
  for (Index e = 0; e < model_.envs; ++e) {
    if (!whose[e]) continue;
    owed_[e] = std::max(tuning::kOwedOn * owed_[e] - step_[e].gain, 0.0);
    owed_second_[e] = next_owed_second(owed_second_[e], step_[e]);
  }
  if (!remembers_) return;
  device::Buffer<Vec3> sum;
  for (Driver d : drivers_) {
    gradient_of(d, at, sum);
    copy_envs(sum, whose, model_.env_blocks, last_[d]);
  }
  for (Index e = 0; e < model_.envs; ++e)
    if (whose[e]) lately_[e] = std::max(step_[e].there, tuning::kLately * lately_[e]);
}

void EnergyLedger::checkpoint(Archive& archive) {
  if (measures_) {
    archive.io("owed", owed_, effects::one_each(model_.envs));
    archive.io("owed_second", owed_second_, effects::one_each(model_.envs));
  }
  if (!remembers_) return;
  archive.io("lately", lately_, effects::one_each(model_.envs));
  constexpr const char* kNames[] = {"motor_gradient", "support_gradient", "tie_gradient", "given_gradient"};
  for (Driver d : drivers_) {
    std::vector<double> gradient = flatten(last_[d].download());
    archive.io(kNames[d], gradient, effects::in_values(model_.env_blocks, 3));
    if (archive.loading()) last_[d].upload(unflatten(gradient));
  }
}

// What is known of the others stays: found again with other pairs in another order its last digits could differ, and one environment would feel what
// became of another.
void EnergyLedger::find(device::View<const Vec3> q, const Linearised& at, device::Fetch& fetch) {
  EnvMask again(gone_);
  for (Index e = 0; e < model_.envs; ++e) again[e] = gone_[e] && model_.works_on(e);
  bool some = known_.empty();  // of the others they stay unknown
  for (const std::vector<double>& part : known_) some = some || part.empty();
  if (any(again) && !known_.empty()) {
    const model::Only only(model_, again);
    const auto here = std::make_shared<Energies>();
    std::vector<std::size_t> there;
    for (std::size_t k = 0; k < known_.size(); ++k)
      if (!known_[k].empty()) there.push_back(k);
    potential_.energies(q, at, *here, fetch);
    fetch.then([this, here, again, there] {
      for (std::size_t k : there)
        for (std::size_t e = 0; e < again.size(); ++e)
          if (again[e]) known_[k][e] = (*here)[k][e];
    });
  }
  for (Index e = 0; e < model_.envs; ++e) gone_[e] = model_.works_on(e) ? 0 : gone_[e] || some;
  potential_.energies(q, at, known_, fetch);
}

void EnergyLedger::begin_search(const EnvMask& whose) {
  if (start_.empty()) start_ = known_;
  for (Index e = 0; e < model_.envs; ++e) {
    took_part_[e] |= whose[e];
    if (started_[e] || !model_.works_on(e)) continue;
    started_[e] = 1;
    for (std::size_t k = 0; k < known_.size(); ++k) start_[k][e] = known_[k][e];
  }
}

void EnergyLedger::accept(Energies&& there) {
  known_ = std::move(there);
  for (std::size_t k = 0; k < known_.size(); ++k)
    if (!potential_.effects()[k]->kind().symmetric) known_[k].clear();
}

std::vector<double> EnergyLedger::sum(const Energies& of, std::vector<double>* scale) const {
  std::vector<double> total(model_.envs, 0.0);
  if (scale) scale->assign(model_.envs, 0.0);
  for (const std::vector<double>& part : of)
    for (Index e = 0; e < model_.envs; ++e) {
      total[e] += part[e];
      if (scale) (*scale)[e] += std::abs(part[e]);
    }
  return total;
}

void EnergyLedger::close(device::View<const Vec3> q, const Linearised& at) {
  device::Fetch fetch;
  find(q, at, fetch);
  const EffectList& effects = potential_.effects();
  std::vector<std::vector<double>> along(effects.size(), std::vector<double>(model_.envs, 0.0));
  const std::vector<double> none(model_.envs, 0.0);
  std::vector<double> now[] = {none, none, none, none}, before[] = {none, none, none, none};  // of drivers' gradients, along the way
  std::vector<std::vector<double>> own(effects.size()), there(effects.size());                // of steps of second order
  std::vector<effects::Held> motors(effects.size());
  device::Buffer<Vec3> move, held, offset, pull;
  const bool measured = measures_ && !start_.empty();
  if (measured) {
    subtract(q, model_.q.view(), move);
    support_move(model_.q.view(), q, model_.projector.view(), held);
    for (std::size_t k = 0; k < effects.size(); ++k)
      if (effects[k]->loses_energy()) {
        own[k].assign(model_.envs, 0.0), there[k] = own[k];
        bool any = false;
        for (Index e = 0; e < model_.envs; ++e) any = any || effects[k]->second_order(e);
        if (any) effects[k]->own_gain(q, {own[k], fetch}, {there[k], fetch});
      } else if (effects[k]->kind().stores_energy()) {
        dot(at.gradients[k].view(), std::as_const(move).view(), model_.env_blocks, {along[k], fetch});
      } else if (moves(*effects[k])) {
        effects[k]->held_energy(q, std::as_const(move).view(), fetch, motors[k]);
      }
    if (model_.ties.driven()) {
      offset.resize(model_.blocks);
      offset.zero();
      model_.ties.add_offset(std::as_const(model_.q).view(), offset.view());
    }
    const std::vector<const device::Buffer<Vec3>*> ways[] = {{&move}, {&held}, {&offset}, {&held, &offset}};
    for (Driver d : drivers_) {
      gradient_of(d, at, pull);
      for (const device::Buffer<Vec3>* way : ways[d]) {
        if (way->size() == 0) continue;
        dot(std::as_const(pull).view(), way->view(), model_.env_blocks, {now[d], fetch});
        if (remembers_) dot(std::as_const(last_[d]).view(), way->view(), model_.env_blocks, {before[d], fetch});
      }
    }
  }
  fetch.now("end of solve");
  total_ = sum(known_);
  for (Index e = 0; e < model_.envs; ++e) {
    StepEnergy& step = step_[e] = {};
    if (!measured || !took_part_[e]) continue;
    const auto work_of = [e](const std::vector<double>(&w)[4]) { return w[Driver::supports][e] + w[Driver::ties][e] - w[Driver::motors][e]; };
    double taken = step.work = work_of(now);  // taken: for the work of all drivers
    for (std::size_t k = 0; k < effects.size(); ++k) {
      if (const effects::Held& m = motors[k]; !m.end.empty()) {  // its springs: what they do is no work, what moves their other end is
        step.work += m.along[e] + m.begin[e] - m.at_last[e];
        taken += m.along[e] + m.begin[e] - m.end[e];
        step.gain += m.end[e] - m.begin[e] - m.along[e];
        step.there += std::max(m.begin[e], m.end[e]);
      }
      const double first = start_[k][e], after = known_[k][e];
      if (effects[k]->kind().stores_energy()) {
        step.gain += after - first - along[k][e];
        step.there += std::max(std::abs(first), std::abs(after));
      } else if (effects[k]->second_order(e)) {
        step.second_order = true;
        step.gain += own[k][e], step.there += there[k][e];
      } else if (effects[k]->kind().role == effects::Role::inertia) {
        step.gain -= after;
        step.there += first;
      }
    }
    step.owed = step.second_order ? std::max(owed_second_[e], 0.0) : std::min(owed_[e], tuning::kOwed * step.there);
    if (!remembers_) continue;
    const double done = 0.5 * (work_of(before) + work_of(now));
    if (!step.second_order) {
      step.work_lag = std::abs(work_of(now) - done);
      continue;
    }
    const double given[] = {before[Driver::given][e], now[Driver::given][e]};  // which the gain knows nothing of
    step.gain += taken - done - 0.5 * (given[1] - given[0]), step.work += done - taken;
    step.in_doubt = tuning::kDrivenErr * std::abs(done - 0.5 * (given[0] + given[1]));
    step.there = std::max(step.there, tuning::kLately * lately_[e]);
  }
}

bool EnergyGuard::wants_halving(const StepEnergy& e, double allowed) {
  if (!helps_ || !(e.gain > e.may_gain(allowed))) return false;
  helps_ = !(e.gain > last_ / tuning::kGainFalls);
  last_ = e.gain;
  return helps_;
}

}  // namespace mortise::solver
