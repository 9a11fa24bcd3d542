#pragma once
// All effects as one incremental potential Phi(q), and what it is at a state.
#include <memory>
#include <vector>

#include "effects/effect.h"
#include "linalg/assembly.h"
#include "model/model.h"
#include "solver/report.h"

namespace mortise::solver {

using EffectList = std::vector<std::unique_ptr<effects::Effect>>;
using Energies = std::vector<std::vector<double>>;  // [J], of every effect and environment; empty where unknown

// Phi at one state: a value; two of them never share a buffer.
struct Linearised {
  std::vector<std::unique_ptr<effects::Linearisation>> of;  // every effect
  std::vector<device::Buffer<Vec3>> gradients;              // of every effect, over all blocks [N]
  device::Buffer<Vec3> gradient;                            // T^T of their sum (model/ties.h): 0 at tied blocks
  std::vector<linalg::StencilSet*> sets() const;
};

class Potential {
 public:
  // Connects the effects. Throws Error(Exit::scene).
  Potential(model::Model& model, EffectList& effects, Clock& clock);

  Linearised linearised() const;
  // `fresh`: with lagged quantities of q itself, not those that `at` holds.
  void linearise(device::View<const Vec3> q, effects::Want want, Linearised& at, bool fresh = false);
  // `at` may be filled with forces at q next: effects ask for what they have to hear of that.
  void foresee(device::View<const Vec3> q, Linearised& at, device::Fetch& fetch);
  // The contact samples of the state of `at`.
  void sample(Linearised& at);
  // Lagged quantities of `to` become those of the state of `from`.
  void lag(Linearised& from, Linearised& to);
  // Finds the unknown energies at q, with what is frozen.
  void energies(device::View<const Vec3> q, const Linearised& frozen, Energies& of, device::Fetch& fetch);
  void max_step(device::View<const Vec3> dq, Linearised& at, device::EnvValues alpha);
  void reach(Linearised& at);  // once that is fetched, for energies on that way

  // T^T H d, d over all blocks; not folded: H d. The pieces of the effects' forces in `at` are used up.
  void product(Linearised& at, device::View<const Vec3> d, device::Buffer<Vec3>& out, bool folded = true);
  // T^T U d, U being what the whole Jacobian has besides H (of states linearised with it), or T^T U^T d. The same.
  void unsymmetric_product(Linearised& at, bool transposed, device::View<const Vec3> d, device::Buffer<Vec3>& out);
  // T^T (H + U) d, or T^T (H + U)^T d. The same.
  void jacobian_product(Linearised& at, bool transposed, device::View<const Vec3> d, device::Buffer<Vec3>& out);
  // Is H + U of `at` all of the Jacobian? Where it was linearised with everything that moves.
  bool complete(const Linearised& at) const;
  // Do the lagged quantities of the state of `at`, sampled, follow from it as the Jacobian says?
  bool follows_locally(const Linearised& at) const;
  linalg::Assembler& assembler() { return assembler_; }

  bool symmetric() const { return symmetric_; }  // all effects are
  bool lags() const { return lags_; }            // some effect does
  bool freezes() const { return freezes_; }      // some effect freezes more than what it lags: what moves is not in H
  EffectList& effects() { return effects_; }
  const EffectList& effects() const { return effects_; }

 private:
  model::Model& model_;
  EffectList& effects_;
  Clock& clock_;
  linalg::Assembler assembler_;
  std::vector<int> followed_;  // per effect: the contact effect whose samples it follows, or -1
  std::vector<std::uint8_t> is_followed_;
  bool symmetric_ = true, lags_ = false, freezes_ = false;
  device::Buffer<Vec3> product_, beside_;  // work space
};

}  // namespace mortise::solver
