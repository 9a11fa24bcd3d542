#pragma once
// What every contact effect keeps: which bodies may meet, which primitives were near each other lately, and how far all may move without
// touching. Where the points are is the caller's to keep.
#include <cstdint>
#include <memory>
#include <vector>

#include "effects/contact/candidates.h"
#include "effects/contact/pair_energy.h"
#include "effects/contact/pairs.h"
#include "effects/contact/prescribed.h"
#include "effects/contact/tuning.h"
#include "effects/effect.h"
#include "model/model.h"

namespace mortise::effects::contact {

class Proximity {
 public:
  // reach [m]: primitives of an environment nearer than this matter.
  Proximity(model::Model& model, std::vector<double> reach);

  // Which bodies and half-spaces may meet; all detection in the model heeds it from now on.
  void watch(const WatchedPairs& pairs);

  // The step whose positions are asked for from now on.
  void begin_step(const StepInfo& step) { step_ = step; }

  // y = W q, with all candidates there; tells which environments have finite positions.
  std::vector<std::uint8_t> locate(Positions q, Buffer<Vec3>& y);
  // All candidates at y, too; energies of environments in which y is not finite become +infinity. y must stay until the fetch is done.
  void require(const Buffer<Vec3>& y, device::EnvValues per_env);
  Candidates& held() { return candidates_; }  // for those who find out by themselves whether all are there
  // Lowers alpha so that the step dq from where the points are at y keeps the share tuning::kKeep of every distance, and returns the step of the
  // points. Throws Failure where what is prescribed would meet. y must stay until the fetch is done, which then holds all pairs on the way.
  std::shared_ptr<const Buffer<Vec3>> limit(const Buffer<Vec3>& y, View<const Vec3> dq, const BarrierView& s, device::EnvValues alpha);

  double reach(Index env) const { return reach_[env]; }
  void scale_reach(double by);                                  // by a hair
  const Candidates& candidates() const { return candidates_; }  // of the last locate() or limit(), and around
  // All candidates at y.
  const Candidates& candidates(const Buffer<Vec3>& y);
  const std::vector<Index>& point_env() const { return point_env_; }    // first point of every environment
  const std::vector<Index>& vertex_env() const { return vertex_env_; }  // first surface vertex
  TopologyView topology() const { return topology_.view(); }
  View<const Plane> planes() const { return planes_.view(); }
  // For the barrier between pairs of primitives (pair_energy.h) that ranges as far as primitives matter; kappa: per environment [Pa]; the areas may
  // be empty where the barrier does not ask for them.
  BarrierView view(const BarrierParams& barrier, const Buffer<double>& kappa, View<const double> point_area, View<const double> plane_area) const;
  // The same with all bodies in sight that are to be kept apart, those between which no force acts included.
  BarrierView obstacles(BarrierView s) const {
    s.watched = apart_.view();
    return s;
  }

 private:
  model::Model& model_;
  std::vector<double> reach_;  // per environment
  Buffer<double> reaches_;     // the same
  Topology topology_;
  std::vector<Index> point_env_, vertex_env_;
  Candidates candidates_;
  Buffer<Plane> planes_;
  Buffer<std::uint8_t> watched_;  // pairs between which forces act,
  Buffer<std::uint8_t> apart_;    // which must not meet
  Prescribed prescribed_;
  StepInfo step_;
  Buffer<double> self_range_;
};

// Energies of environments whose positions, or which themselves, are not numbers become +infinity.
void forbid(const std::vector<std::uint8_t>& finite, std::vector<double>& value);

}  // namespace mortise::effects::contact
