#pragma once
// When is a step solved? Bodies are judged against what acts on their own free directions, and on those of bodies that touch them, so that
// neither a heavy stranger nor what a support bears can hide that a light body has not moved yet. With r = P T^T grad Phi the residual, g_k = T^T of
// the gradient of effect k (model/ties.h) and s_b the lever of block b (1 of a position; of an axis of a stiff body the radius of the body, which
// makes a force of a moment and a way of a change of the axis), a body is solved when
//
//   (a) max_b |r_b| / s_b <= relative * max_k max_c |P g_k,c| / s_c       c over the blocks of all bodies of its group     [N]
//       |sum_b r_b|       <= relative * max_k sum_b |g_k,b|      of a body without any support, over positions; k runs over effects whose
//                                                                forces on a body do not cancel by themselves: weight, inertia, contact
//       and neither is insisted on below what rounding of q, or of what tied nodes of the body follow, may cause, 8 eps |H_bb| |q_b| / s_b,
//   (b) max_b s_b |next Newton step| <= max(kMotion * way in this step, kSize * radius)                                    [m]
//       where the next step is taken to be shorter than the last by as much as the residual fell since; early rounds of lagged quantities,
//       which are solved less closely, allow it as many times longer.
//
// A state that no Newton step has led to is solved only where the residual is exactly zero. A group is what contact connects, not by way of
// bodies that are wholly held.
#include <string>
#include <vector>

#include "effects/effect.h"
#include "linalg/block_matrix.h"
#include "model/model.h"
#include "solver/body_figures.h"
#include "solver/envs.h"
#include "solver/options.h"

namespace mortise::solver {

// What is left of the forces at a state. Per environment, and per body where said.
struct Residual {
  std::vector<double> support_gap;  // [m]
  std::vector<double> force;        // per body: largest |r_b| / s_b [N]
  std::vector<double> scale;        // per body: right-hand side of (a) without `relative`, of its group [N]
  std::vector<double> net[3];       // per body: sum_b r_b [N]
  std::vector<double> load;         // per body: what `net` is held against [N]
  std::vector<double> way;          // per body: farthest way of a block since the step began [m]
};

class Convergence {
 public:
  Convergence(const model::Model& model, const Options& options);

  void begin_step();                                                                           // supports may have changed
  void set_rows(const std::vector<Index>& row_of_block);                                       // of the matrices that will be seen
  void connect(const std::vector<const model::ContactView*>& contacts, const EnvMask& whose);  // groups, by what touches now
  void refreshed() { std::fill(comparable_.begin(), comparable_.end(), 0); }  // what was frozen is not that of the last residual any more

  effects::View<const double> lever() const { return lever_.view(); }        // s_b of every block,
  effects::View<const double> position() const { return position_.view(); }  // 1 of a position, 0 of an axis

  // The parts of a residual; values are there once `fetch` is done, and finish() has been called.
  Residual begin() const;
  void see_effect(const effects::Kind& kind, effects::View<const Vec3> gradient, Residual& r, device::Fetch& fetch) const;
  void see_sum(effects::View<const Vec3> gradient, effects::View<const Vec3> q, Residual& r, device::Fetch& fetch) const;
  void finish(Residual& r) const;
  // Of the matrix at q, in the environments of `whose`.
  void see_matrix(const linalg::BlockMatrix& matrix, effects::View<const Vec3> q, effects::View<const Index> block_of_row, const EnvMask& whose,
                  device::Fetch& fetch);
  // A Newton step of full length dq was found at the state of residual r, in the environments of `whose`.
  void see_step(effects::View<const Vec3> dq, const Residual& r, const EnvMask& whose, device::Fetch& fetch);

  double largest_force(const Residual& r, Index env) const;
  double loose_sum(const Residual& r, Index env) const;              // of a body that contact alone holds, the largest [N]
  double over(const Residual& r, Index env, double relative) const;  // worst body's share of its tolerance; above 1: not solved
  double relative_residual(const Residual& r, Index env) const;      // worst body's residual over its forces
  bool finite(const Residual& r, Index env) const;
  bool solved(const Residual& r, Index env, double relative) const;  // (a) and (b)
  // How small residuals of the environment, by row, have to become for all of its bodies [N, N m]; infinite if nothing is free.
  double least_tolerance(const Residual& r, Index env, double relative) const;
  // The body that is farthest from its tolerance.
  struct Worst {
    Index body = 0;
    double force = 0, tolerance = 0;  // [N]
  };
  Worst worst(const Residual& r, Index env, double relative) const;

 private:
  struct Figures {
    double force, tolerance;
  };
  Figures figures(const Residual& r, Index body, double relative) const;
  bool balanced(const Residual& r, Index body, double relative) const;
  bool at_rest(const Residual& r, Index body, double relative) const;
  double net(const Residual& r, Index body) const;

  const model::Model& model_;
  const Options& options_;
  Chunks blocks_, rows_;                         // of bodies
  std::vector<double> radius_;                   // per body [m]
  std::vector<std::uint8_t> loose_, held_;       // per body: no support or tie at all; no freedom of its own
  std::vector<Index> group_;                     // per body: the first body of its group
  device::Buffer<double> lever_, position_;      // per block: s_b; 1 of a position, 0 of an axis
  device::Buffer<double> reach_;                 // per block: of what tied nodes of its body follow [m]
  std::vector<double> rounding_, rounding_sum_;  // per body [N]
  std::vector<double> step_;                     // per body: the last Newton step at full length [m]; below 0 before the first
  Residual last_;                                // where it began
  std::vector<std::uint8_t> comparable_;         // per body: is that to the present residual?
};

}  // namespace mortise::solver
