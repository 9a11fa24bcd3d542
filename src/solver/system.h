#pragma once
// The equations of a step: all effects at a state, what is left of their forces, and the matrix over the blocks that are free.
#include <functional>

#include "linalg/block_matrix.h"
#include "linalg/elimination.h"
#include "linalg/gmres.h"
#include "solver/convergence.h"
#include "solver/envs.h"
#include "solver/loose_hold.h"
#include "solver/options.h"
#include "solver/potential.h"
#include "solver/rows.h"

namespace mortise::solver {

class System {
 public:
  System(model::Model& model, EffectList& effects, const Options& options, Clock& clock);

  void begin_solve();  // supports may have changed; says so to whoever asks rows_changed()
  bool rows_changed() const { return rows_changed_; }

  // What is left of the forces of `at`, linearised at q.
  Residual residual(device::View<const Vec3> q, const Linearised& at) const;
  // And what else `fetch` was asked for.
  Residual residual(device::View<const Vec3> q, const Linearised& at, device::Fetch& fetch) const;
  // Potential::linearise, and that.
  Residual linearise(device::View<const Vec3> q, effects::Want want, Linearised& at, bool fresh = false);
  // Which force is not finite in an environment, and where.
  std::string not_finite(const Linearised& at, Index env) const;
  // Which body in statics has gone so far that what is left of its forces is rounding of where it is; empty without.
  std::string gone_for_good(const Residual& r, Index env) const;
  // By what touches at the state of `at`; samples it.
  void find_groups(Linearised& at, const EnvMask& whose);

  // c = T (I - P)(target - q): what supports still have to move, and what is tied to it.
  void supports(device::View<const Vec3> q, device::Buffer<Vec3>& c) const;
  // Asks for the structure of the matrix of `at`.
  void begin_matrix(const Linearised& at, device::Fetch& fetch) { potential.assembler().begin_matrix(at.sets(), fetch); }
  // P T^T H T P + I - P on the rows, with H of `at`, linearised at q. Convergence knows its rounding in the environments of `whose` once `later` is
  // done; `now` is brought where the structure has to be asked for.
  void matrix(Linearised& at, device::View<const Vec3> q, const EnvMask& whose, linalg::BlockMatrix& A, device::Fetch& now, device::Fetch& later);
  // y = P T^T (H + U) T P x on the rows, with the matrix A of H, and U of `at` (Potential::unsymmetric_product).
  linalg::Operator whole(Linearised& at, const linalg::BlockMatrix& A);
  // y = P T^T B T P x on the rows, for a product with B over all blocks, which folds it.
  using BlockProduct = std::function<void(device::View<const Vec3> in, device::Buffer<Vec3>& out)>;
  linalg::Operator on_rows(BlockProduct product);
  // The same as `whole` of an `at` with everything that moves in U, by stencils alone; or with (H + U)^T. The pieces of forces in `at` are used up.
  linalg::Operator jacobian(Linearised& at, bool transposed);
  // -P (g + Hc), where Hc may be empty.
  void right_hand_side(const Linearised& at, device::View<const Vec3> Hc, device::Buffer<Vec3>& rhs) const;
  // T (P x + c) over all blocks, for x on the rows; 0 outside of `whose`.
  void to_blocks(device::View<const Vec3> x, device::View<const Vec3> c, const EnvMask& whose, device::Buffer<Vec3>& dq) const;

  bool solved(const Residual& r, Index env, double relative, double last_step) const;
  // Statics, and nothing but contact holds a body: where it slides nothing resists, and that is no saddle.
  bool slides(Index env) const { return touching_ && rows.loose[env]; }

  model::Model& model;
  const Options& options;
  Clock& clock;
  Potential potential;
  Convergence convergence;
  LooseHold hold;
  Rows rows;
  const std::vector<double> length;  // per environment: its diagonal at rest [m], against which gaps of supports are judged

 private:
  bool rows_changed_ = false, touching_ = false;  // some effect is contact
  // Where blocks are tied:
  linalg::Elimination elimination_;
  linalg::BlockMatrix whole_;            // H
  mutable device::Buffer<Vec3> folded_;  // T^T of one effect's gradient
  device::Buffer<Vec3> way_, force_;     // work space of products
};

}  // namespace mortise::solver
