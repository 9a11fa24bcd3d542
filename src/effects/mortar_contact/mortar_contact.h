#pragma once
// mortar_contact as an effect: a field of samples on surfaces (surfaces.h), as stiff as the interfaces are (stiffnesses.h), and the guard, which is
// the barrier of barrier_contact in its classic form: every pair of primitives has the same weight.
#include <memory>
#include <vector>

#include "effects/contact/proximity.h"
#include "effects/mortar_contact/freezing.h"
#include "effects/mortar_contact/linearisation.h"
#include "effects/mortar_contact/stiffnesses.h"
#include "effects/mortar_contact/surfaces.h"

namespace mortise::effects::mortar {

class MortarContact final : public Effect {
 public:
  MortarContact(const Params& p, model::Model& model);
  const Kind& kind() const override;
  std::vector<PlanItem> plan() const override;
  void connect() override;
  void mend(Fault fault, double share) override;
  void begin_step(const StepInfo& step) override;
  std::unique_ptr<Linearisation> linearisation() const override;
  void linearise(Positions q, Want want, Linearisation& out) override;
  void sample(Linearisation& out) override;
  void sample_changes(Linearisation& out) override;
  bool complete(const Linearisation& at) const override;
  void energy(Positions q, const Linearisation& frozen, device::EnvValues per_env) override;
  void max_step(View<const Vec3> dq, Linearisation& out, device::EnvValues alpha) override;
  void reach(Linearisation& out) override;
  void refit(Positions, const Linearisation& at, std::vector<Refit>& per_env) override;
  void adapt(const StepInfo& step, const std::vector<double>& budget, const Linearisation& at) override;
  void report(const FieldSinks& sinks, const Linearisation& at) override;  // report.cpp
  void checkpoint(Archive& archive) override;

 private:
  MortarView view(const MortarLinearisation& at) const;
  contact::BarrierView guard_view() const;
  contact::Where where(const Buffer<Vec3>& y);
  // Gap beyond the support radius up to which samples are wanted, in every environment [m].
  std::vector<double> more_reach() const;
  void stiffness_changed();
  void fit_support();
  void check_faces(const MortarLinearisation& at) const;
  void measure(MortarLinearisation& at) const;
  void take_samples(MortarLinearisation& at, Moving moving);
  void refreeze(MortarLinearisation& at);
  void follow_samples(Moving wanted, MortarLinearisation& at);
  std::vector<double> guard_energy(const MortarLinearisation& at);
  std::vector<double> cover_of(const MortarLinearisation& at, const std::vector<Vec3>& y, const std::vector<Pair>& pairs,
                               const std::vector<std::uint8_t>& pressed, std::vector<double>& share);

  model::Model& model_;
  Settings set_;
  std::vector<double> d_hat_;  // per environment [m]
  double guard_, rest_;
  bool started_ = false;
  Surfaces surfaces_;
  Stiffnesses stiffnesses_;
  Buffer<double> guard_kappa_;  // per environment: that of a pair over the square of the guard's range [Pa]
  contact::Proximity proximity_;
  contact::TermRoom room_;            // of the guard
  FreezeRoom rooms_, rooms_on_ways_;  // of freezing at iterates, and for what steps may bring into range
  Buffer<double> support_, margin_;   // of every slave; of every environment: more_reach()
};

}  // namespace mortise::effects::mortar
