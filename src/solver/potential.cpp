#include "solver/potential.h"

#include "solver/kernels.h"
#include "solver/timed.h"

namespace mortise::solver {

std::vector<linalg::StencilSet*> Linearised::sets() const {
  std::vector<linalg::StencilSet*> out;
  for (const auto& one : of) out.push_back(&one->stencils);
  return out;
}

Potential::Potential(model::Model& model, EffectList& effects, Clock& clock)
    : model_(model), effects_(effects), clock_(clock), followed_(effects.size(), -1), is_followed_(effects.size(), 0) {
  for (const auto& effect : effects_) effect->connect();
  for (std::size_t k = 0; k < effects_.size(); ++k) {
    symmetric_ = symmetric_ && effects_[k]->kind().symmetric;
    lags_ = lags_ || effects_[k]->kind().lags;
    freezes_ = freezes_ || (!effects_[k]->kind().symmetric && !effects_[k]->kind().lags);
    for (std::size_t c = 0; c < k; ++c)
      if (effects_[c]->name() == effects_[k]->follows()) followed_[k] = static_cast<int>(c), is_followed_[c] = 1;
  }
  assembler_.set_environments(model_.env_blocks, model_.at_work);
}

Linearised Potential::linearised() const {
  Linearised at;
  for (const auto& effect : effects_) {
    at.of.push_back(effect->linearisation());
    at.of.back()->contact.env_offset.assign(model_.envs + 1, 0);
  }
  at.gradients.resize(effects_.size());
  return at;
}

void Potential::linearise(device::View<const Vec3> q, effects::Want want, Linearised& at, bool fresh) {
  const device::Ranges blocks = model_.working(model_.env_blocks);
  if (want.forces) {
    if (at.gradient.size() != model_.blocks) at.gradient.resize(model_.blocks), at.gradient.zero();
    for (const device::Ranges::Part& p : blocks.parts()) clear_blocks(at.gradient, p.begin, p.end);
  }
  for (std::size_t k = 0; k < effects_.size(); ++k) {
    effects::Effect& effect = *effects_[k];
    effects::Linearisation& here = *at.of[k];
    const Timed timed(clock_, effect.name(), want.matrix.wanted ? "assemble" : want.forces ? "gradient" : "freeze");
    if (fresh && followed_[k] >= 0) effect.lag(at.of[followed_[k]]->contact, here);
    effect.linearise(q, want, here);
    if (fresh && is_followed_[k]) effect.sample(here);
    if (fresh && is_followed_[k] && want.whole) effect.sample_changes(here);
    if (!want.forces) continue;
    linalg::StencilSet* const one[] = {&here.stencils};
    assembler_.gradient(one, model_.blocks, at.gradients[k]);
    add(std::as_const(at.gradients[k]).view(), blocks, at.gradient);
  }
  // Of environments that are left out it is folded already.
  if (want.forces) model_.ties.fold(at.gradient.view());
}

void Potential::foresee(device::View<const Vec3> q, Linearised& at, device::Fetch& fetch) {
  for (std::size_t k = 0; k < effects_.size(); ++k) {
    const Timed timed(clock_, effects_[k]->name(), "assemble");
    effects_[k]->foresee(q, *at.of[k], fetch);
  }
}

void Potential::sample(Linearised& at) {
  for (std::size_t k = 0; k < effects_.size(); ++k) {
    if (effects_[k]->kind().role != effects::Role::contact) continue;
    const Timed timed(clock_, effects_[k]->name(), "sample");
    effects_[k]->sample(*at.of[k]);
  }
}

void Potential::lag(Linearised& from, Linearised& to) {
  for (std::size_t k = 0; k < effects_.size(); ++k) {
    if (followed_[k] < 0) continue;
    const Timed timed(clock_, effects_[k]->name(), "lag");
    effects_[k]->lag(from.of[followed_[k]]->contact, *to.of[k]);
  }
}

void Potential::energies(device::View<const Vec3> q, const Linearised& frozen, Energies& of, device::Fetch& fetch) {
  of.resize(effects_.size());
  for (std::size_t k = 0; k < effects_.size(); ++k) {
    if (!of[k].empty()) continue;
    const Timed timed(clock_, effects_[k]->name(), "energy");
    of[k].assign(model_.envs, 0.0);
    effects_[k]->energy(q, *frozen.of[k], {of[k], fetch});
  }
}

void Potential::max_step(device::View<const Vec3> dq, Linearised& at, device::EnvValues alpha) {
  for (std::size_t k = 0; k < effects_.size(); ++k) {
    const Timed timed(clock_, effects_[k]->name(), "max_step");
    effects_[k]->max_step(dq, *at.of[k], alpha);
  }
}

void Potential::reach(Linearised& at) {
  for (std::size_t k = 0; k < effects_.size(); ++k) {
    const Timed timed(clock_, effects_[k]->name(), "max_step");
    effects_[k]->reach(*at.of[k]);
  }
}

void Potential::product(Linearised& at, device::View<const Vec3> d, device::Buffer<Vec3>& out, bool folded) {
  const std::vector<linalg::StencilSet*> sets = at.sets();
  for (linalg::StencilSet* set : sets) stencil_product(*set, model_, d);
  out.resize(model_.blocks);
  out.zero();
  assembler_.gradient(sets, model_.blocks, out);
  if (folded) model_.ties.fold(out.view());
}

void Potential::unsymmetric_product(Linearised& at, bool transposed, device::View<const Vec3> d, device::Buffer<Vec3>& out) {
  out.resize(model_.blocks);
  out.zero();
  for (const auto& one : at.of) {
    if (!one->unsymmetric.any()) continue;
    linalg::StencilSet* const set[] = {&one->of_unsymmetric()};
    linalg::multiply(one->unsymmetric, transposed, d, *set[0]);
    product_.resize(model_.blocks);
    product_.zero();
    assembler_.gradient(set, model_.blocks, product_);
    add(std::as_const(product_).view(), out);
  }
  model_.ties.fold(out.view());
}

void Potential::jacobian_product(Linearised& at, bool transposed, device::View<const Vec3> d, device::Buffer<Vec3>& out) {
  product(at, d, out);
  unsymmetric_product(at, transposed, d, beside_);
  add(std::as_const(beside_).view(), out);
}

bool Potential::complete(const Linearised& at) const {
  for (std::size_t k = 0; k < effects_.size(); ++k)
    if (!effects_[k]->complete(*at.of[k])) return false;
  return follows_locally(at);
}

bool Potential::follows_locally(const Linearised& at) const {
  for (std::size_t k = 0; k < at.of.size(); ++k)
    if (is_followed_[k] && !at.of[k]->contact.local) return false;
  return true;
}

}  // namespace mortise::solver
