#pragma once
// Newton's method on the incremental potential Phi(q) with supports.
//
//   residual   r = P grad Phi                          [N]; when it is small enough: convergence.h
//   Hessian    H with a share of its negative curvature (direction.cpp)
//   direction  (P H P + I - P) d = -P (g + H c)        c = (I - P)(target - q): what the supports still have to move
//   step       q <- q + alpha (d + c)                  alpha per environment: conservative CCD, then Armijo
//
// While supports move, Armijo acts on the merit Phi + rho/2 |(1 - alpha) c|^2 with rho large enough that the direction
// descends: driving a support does work, so Phi alone may rise (Nocedal & Wright, 2nd ed., ch. 15.4; Li et al. 2020 use an
// augmented Lagrangian for the same purpose).
#include <functional>
#include <memory>
#include <span>

#include "effects/effect.h"
#include "linalg/assembly.h"
#include "linalg/block_matrix.h"
#include "linalg/cg.h"
#include "linalg/direct.h"
#include "linalg/preconditioner.h"
#include "model/model.h"
#include "solver/convergence.h"
#include "solver/options.h"
#include "solver/report.h"

namespace mortise::solver {

using EffectList = std::vector<std::unique_ptr<effects::Effect>>;

class Newton {
 public:
  Newton(model::Model& model, EffectList& effects, const Options& options, Clock& clock);

  // From model.q to the minimiser, left in q(); throws Failure. Effects' begin_step must have run. `stop` is asked between
  // iterations and may throw. `again`: from the minimiser that q() is already, since effects have changed.
  void solve(const effects::StepInfo& info, StepReport& report, const std::function<void()>& stop, bool again = false);

  device::Buffer<Vec3>& q() { return q_; }
  bool conservative() const { return conservative_; }
  // Energies of the last step [J] (energy_guard.cpp): what the integrator itself added, what there was, and the work of supports. Not measured,
  // and 0, of several environments, which must have no say in each other's steps.
  bool measures_energy() const { return options_.loses_energy && model_.envs == 1; }
  double energy_gain() const { return gain_; }
  double energy_there() const { return gain_scale_; }
  double support_work() const { return support_work_; }
  // Full gradient at the minimiser over all blocks [N] (at a held block: the support's force), and each effect's share.
  const device::Buffer<Vec3>& gradient() const { return gradient_; }
  const std::vector<device::Buffer<Vec3>>& effect_gradients() const { return effect_gradients_; }
  std::string linear_solver() const { return linear_ == Linear::cg ? "cg" : linear_ == Linear::reuse ? "reuse" : "direct"; }
  std::string linear_reason() const { return linear_reason_; }

 private:
  void choose_linear();
  void number_rows();
  Residual assemble(bool hessian);
  std::string not_finite() const;  // which force, and where
  std::vector<double> forces(const Residual& r) const;  // largest of each environment [N]
  bool converged(const Residual& r, double relative) const;
  void note(const Residual& r, double relative, StepReport& report) const;
  void choose_curvature();
  void soften();
  void build_matrix(device::Fetch& fetch);  // convergence_ knows its rounding once that is done
  bool solve_direct(StepReport& report);
  void choose_preconditioner();  // krylov.cpp, with the next four
  void set_up_cg();
  void build_preconditioner();
  std::vector<double> forcing() const;
  linalg::CgResult run_cg(device::View<const Vec3> b, device::View<Vec3> x, const std::vector<double>& relative, const std::vector<double>& absolute);
  bool solve_cg(StepReport& report);
  bool solve_linear(StepReport& report, bool supports_move);
  void direction(StepReport& report, const Residual& r, double relative, bool supports_move);
  double line_search(StepReport& report, const Residual& r, double relative, bool supports_move);
  bool iterate(const effects::StepInfo& info, StepReport& report, double relative, const std::function<void()>& stop);
  void find_groups();
  bool needs_jacobian(const Residual& r, Index iteration, double relative);
  void remember_nearest(const Residual& r);
  Residual fresh_residual(device::Buffer<Vec3>& at);  // coupled.cpp, from here on
  void to_blocks(device::View<const Vec3> rows, device::Buffer<Vec3>& out);
  void precondition(device::View<const Vec3> in, device::View<Vec3> out);
  void jacobian_product(const device::Buffer<Vec3>& r0, device::View<const Vec3> v, device::View<Vec3> out);
  std::vector<double> natural_level();
  bool monotone_step(StepReport& report, Residual& r, double relative);
  bool solve_coupled(const effects::StepInfo& info, StepReport& report, double relative, const std::function<void()>& stop);
  bool refresh_lagged(device::View<const Vec3> q);
  void relax_lagged(Index round);
  using Energies = std::vector<std::vector<double>>;  // [J], of every effect and environment; empty where unknown
  void find_energies(device::View<const Vec3> q, Energies& of, device::Fetch& fetch);
  std::vector<double> sum(const Energies& energies);
  std::vector<double> energy(device::View<const Vec3> q, Energies& of);  // finds those that are unknown
  std::vector<double> energy(device::View<const Vec3> q);
  void remember(Energies&& at_q);
  void measure_gain(const Energies& at_end, device::Fetch& fetch);  // energy_guard.cpp; fetches
  void trace(const effects::StepInfo& info, const Residual& r, Index iteration, StepReport& report);

  model::Model& model_;
  EffectList& effects_;
  const Options& options_;
  Clock& clock_;

  // direct: a new factor in every iteration; reuse: factors serve later iterations of the step as preconditioners.
  enum class Linear { direct, reuse, cg } linear_ = Linear::direct;
  bool factor_fresh_ = false;  // the last factor belongs to this step and still pays
  std::string linear_reason_;
  Convergence convergence_;
  double length_ = 1;  // size of the scene [m]
  std::vector<std::uint8_t> held_;  // the model's state of supports when rows were numbered
  Index rows_ = 0;
  device::Buffer<Index> row_of_block_, block_of_row_;
  std::vector<Index> env_rows_;
  device::Buffer<Mat3> row_projector_;
  bool any_partial_ = false;
  bool any_loose_ = false;  // statics: a body without any support, held by contact alone

  linalg::Assembler assembler_;
  linalg::BlockMatrix matrix_;
  linalg::DirectSolver direct_;
  std::unique_ptr<linalg::ConjugateGradients> cg_;  // of the present numbering of rows, as the preconditioner
  std::unique_ptr<linalg::Preconditioner> preconditioner_;
  bool schwarz_ = false;
  device::Buffer<Vec3> row_position_;
  double built_speed_ = 0, speed_ = 0;  // iterations per digit: right after the preconditioner was built (0: not in this step), last time
  std::vector<double> cg_relative_, cg_last_rhs_;  // of the last linear system in this step, per environment; empty before the first
  std::vector<double> wanted_;                     // per environment: the residual at which Newton stops [N]
  std::vector<double> rhs2_;                       // per environment: square of the right-hand side
  std::vector<linalg::StencilSet*> sets_;

  std::vector<double> slope_;  // per environment: gradient . dq_ [J]
  device::Buffer<Vec3> q_, trial_, gradient_, support_, dq_, rhs_, x_;
  device::Buffer<Vec3> lag_q_, lag_move_, lag_last_;  // lagging.cpp
  std::vector<double> lag_share_;
  std::vector<device::Buffer<Vec3>> effect_gradients_;
  Energies known_;  // at q_
  Energies start_;  // where the step begins
  std::vector<double> energy_scale_;
  std::vector<double> last_force_;  // per environment: the residual before the last iteration [N]; 0 before the first
  double nearest_force_ = INFINITY;  // least residual of these iterations [N], and where it was
  device::Buffer<Vec3> nearest_q_;
  double last_step_ = 0;
  double concave_ = 0;  // share of the Hessian's negative curvature that is kept now (effects/curvature.h)
  double last_alpha_ = 0;  // shortest accepted step of the last iteration; 0 before the first
  bool conservative_ = true;     // all effects are
  bool may_couple_ = false;      // coupled.cpp has not failed in this step yet
  Index slow_ = 0;               // iterations in a row that got nowhere
  double gain_ = 0, gain_scale_ = 0, support_work_ = 0;
  bool lags_ = false;  // some effect has quantities that are frozen and refreshed
};

}  // namespace mortise::solver
