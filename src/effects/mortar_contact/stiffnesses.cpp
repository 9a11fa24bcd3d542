#include "effects/mortar_contact/stiffnesses.h"

#include <algorithm>
#include <numeric>
#include <string>

#include "base/error.h"
#include "effects/per_environment.h"

namespace mortise::effects::mortar {

Stiffnesses::Stiffnesses(const Params& p, const model::Model& model, const std::vector<Interface>& interfaces)
    : envs_(model.envs), interfaces_(interfaces), automatic_(!p.has("stiffness")), next_price_(model.envs, 0.0) {
  for (const Interface& i : interfaces_) kappa_.push_back(automatic_ ? first_stiffness(i) : model.input.effect_of(p, i.env).number("stiffness"));
  next_kappa_ = kappa_;
  kappa_view_.upload(kappa_);
}

bool Stiffnesses::begin_step(const StepInfo& step) {
  static_ = step.is_static;
  bool changed = false;
  for (std::size_t i = 0; i < kappa_.size(); ++i) {
    if (!step.taken_by(interfaces_[i].env) || kappa_[i] == next_kappa_[i]) continue;
    kappa_[i] = next_kappa_[i];
    changed = true;
  }
  if (changed) kappa_view_.upload(kappa_);
  return changed;
}

std::vector<double> Stiffnesses::fitted(const FrozenSamples& at, std::vector<double>& price) const {
  const Taken taken(at);
  price.assign(envs_, 0.0);
  std::vector<double> wanted = kappa_;
  for (std::size_t i = 0; i < interfaces_.size(); ++i) {
    const Achieved now = achieved(interfaces_[i], static_cast<Index>(i), kappa_[i], taken);
    if (!(now.pressure > 0) || fits(interfaces_[i], now, kappa_[i])) continue;
    wanted[i] = wanted_stiffness(interfaces_[i], now.pressure, static_ ? tuning::kOpen : tuning::kSoftest);
    price[interfaces_[i].env] += (wanted[i] / kappa_[i] - 1) * now.energy;
  }
  return wanted;
}

bool Stiffnesses::refit(const FrozenSamples& at, std::vector<Effect::Refit>& per_env) {
  if (!automatic_ || !static_) return false;
  std::vector<double> price;
  const std::vector<double> wanted = fitted(at, price);
  std::vector<std::uint8_t> changed(envs_, 0);
  for (std::size_t i = 0; i < kappa_.size(); ++i)
    if (wanted[i] > tuning::kSame * kappa_[i] || kappa_[i] > tuning::kSame * wanted[i]) changed[interfaces_[i].env] = 1;
  bool any = false;
  for (std::size_t i = 0; i < kappa_.size(); ++i) {
    const Index e = interfaces_[i].env;
    if (!changed[e]) continue;
    any = true;
    kappa_[i] = wanted[i];
    per_env[e] = std::max(per_env[e], Effect::Refit::from_here);
  }
  if (any) kappa_view_.upload(kappa_);
  return any;
}

void Stiffnesses::adapt(const StepInfo& step, const std::vector<double>& budget, const FrozenSamples& at,
                        const std::function<std::vector<double>()>& guard_energy) {
  for (std::size_t i = 0; i < kappa_.size(); ++i)
    if (const Index e = interfaces_[i].env; step.taken_by(e)) next_kappa_[i] = kappa_[i], next_price_[e] = 0;
  if (!automatic_) return;
  std::vector<double> price;
  const std::vector<double> wanted = fitted(at, price);
  if (wanted == kappa_) return;
  const std::vector<double> guard = guard_of(kappa_), stiffer = guard_of(wanted), held = guard_energy();
  std::vector<double> share(envs_, 1.0);
  for (Index e = 0; e < envs_; ++e) {
    if (!step.taken_by(e)) continue;
    if (stiffer[e] != guard[e]) price[e] += (stiffer[e] / guard[e] - 1) * held[e];
    if (price[e] > budget[e]) share[e] = budget[e] / price[e];
    next_price_[e] = share[e] * price[e];
  }
  for (std::size_t i = 0; i < kappa_.size(); ++i) {
    const Index e = interfaces_[i].env;
    if (step.taken_by(e)) next_kappa_[i] = share[e] == 1 ? wanted[i] : kappa_[i] + share[e] * (wanted[i] - kappa_[i]);
  }
}

std::vector<double> Stiffnesses::guard_of(const std::vector<double>& kappa) const {
  std::vector<double> largest(envs_, 0.0);
  for (std::size_t i = 0; i < kappa.size(); ++i) {
    const Interface& at = interfaces_[i];
    largest[at.env] = std::max(largest[at.env], kappa[i] * at.h * at.h / 7);
  }
  return largest;
}

void Stiffnesses::checkpoint(Archive& archive) {
  // Archives hold environment after environment.
  std::vector<Index> order(kappa_.size()), of;
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [this](Index a, Index b) { return interfaces_[a].env < interfaces_[b].env; });
  std::vector<double> kappa;
  for (Index i : order) kappa.push_back(next_kappa_[i]), of.push_back(interfaces_[i].env);
  archive.io("stiffness", kappa, firsts(of, envs_));
  archive.io("stiffening", next_price_, one_each(envs_));
  if (!archive.loading()) return;
  if (kappa.size() != kappa_.size())
    throw Error(Exit::file, "the checkpoint belongs to another scene: it has " + std::to_string(kappa.size()) + " contact pairs");
  for (std::size_t i = 0; i < order.size(); ++i)
    if (archive.loads(of[i])) next_kappa_[order[i]] = kappa_[order[i]] = kappa[i];
  kappa_view_.upload(kappa_);
}

}  // namespace mortise::effects::mortar
