#pragma once
// kappa of every interface, in this step and for the next: what the scene says, or what the pressures that are found ask for (stiffness.h). In
// statics a step ends with the stiffness that its own pressures ask for. In motion a contact that grows stiffer under load is energy from nowhere: it
// grows between steps, as far as there is energy to pay for it.
#include <functional>
#include <vector>

#include "base/archive.h"
#include "base/param_table.h"
#include "effects/effect.h"
#include "effects/mortar_contact/stiffness.h"

namespace mortise::effects::mortar {

class Stiffnesses {
 public:
  // Interfaces: those of Surfaces, which must stay.
  Stiffnesses(const Params& p, const model::Model& model, const std::vector<Interface>& interfaces);

  // What was chosen for the environments that take the step is theirs from now on. Is anything other than before?
  bool begin_step(const StepInfo& step);
  // In statics: what the state asks for is taken at once, and the step solved again. Is anything other than before?
  bool refit(const FrozenSamples& at, std::vector<Effect::Refit>& per_env);
  // Chooses those of the next step, which may add as much as `budget` [J] to the energy of an environment; all of an environment grow by the same
  // share of what they want, and the guard, which holds guard_energy [J], with them.
  void adapt(const StepInfo& step, const std::vector<double>& budget, const FrozenSamples& at,
             const std::function<std::vector<double>()>& guard_energy);

  double kappa(std::size_t interface) const { return kappa_[interface]; }  // [Pa]
  double price(Index env) const { return next_price_[env]; }               // what the next step's add to its energy [J]
  // Of a pair of primitives of the guard [N]: with the mean third of a slave triangle as its weight it is as stiff as the samples.
  std::vector<double> of_guard() const { return guard_of(kappa_); }
  View<const double> view() const { return kappa_view_.view(); }  // per interface [Pa]
  void checkpoint(Archive& archive);

 private:
  std::vector<double> guard_of(const std::vector<double>& kappa) const;
  // Those anew that do not fit any more, at the pressures of the state; `price`: what that adds to the energy of the samples of every environment
  // [J].
  std::vector<double> fitted(const FrozenSamples& at, std::vector<double>& price) const;

  Index envs_;
  const std::vector<Interface>& interfaces_;
  bool automatic_, static_ = false;
  std::vector<double> kappa_, next_kappa_, next_price_;
  Buffer<double> kappa_view_;
};

}  // namespace mortise::effects::mortar
