#pragma once
// How the linear system of a Newton iteration, A x = b, is solved, in every environment by itself: a factor each time (direct), factors that
// serve later iterations of the step as preconditioners (reuse), or conjugate gradients (cg). What is kept from one iteration to the next never
// outlives the step, so that a restart between steps meets the same.
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/archive.h"
#include "linalg/block_matrix.h"
#include "linalg/gmres.h"
#include "solver/curvature_policy.h"
#include "solver/envs.h"
#include "solver/options.h"
#include "solver/report.h"
#include "solver/rows.h"

namespace mortise::solver {

// What else is to be known once there is x: a strategy that waits for its end anyway asks where x may be the solution, and brings `fetch` with that.
struct Aside {
  device::Fetch& fetch;
  std::function<void(device::Fetch&)> ask;
  bool done = false;  // of the x that solve() left; else the caller asks
};

struct LinearSystem {
  linalg::BlockMatrix& A;  // block diagonal over environments; may be shifted
  device::View<const Vec3> b;
  device::View<Vec3> x;
  const std::vector<double>& b2;            // per environment: |b|^2
  const std::vector<double>& wanted;        // per environment: the residual at which Newton stops [N]
  device::View<const Vec3> q;               // positions of blocks
  const linalg::Operator* whole = nullptr;  // where the matrix of the system is not A but has unsymmetric parts too: its products; A is near it then
  Aside* aside = nullptr;
};

class Linear {
 public:
  virtual ~Linear() = default;
  virtual const char* name() const = 0;
  // Newton starts; where `changed`, with other rows than before.
  virtual void begin_solve(bool changed) = 0;

  // Solves the environments of `todo`; x stands still in all others. Returns those whose matrix is not positive definite although less negative
  // curvature would make it so; where nothing would, the environment fails.
  virtual EnvMask solve(const LinearSystem& system, const EnvMask& todo, const CurvaturePolicy& curvature, EnvTable& envs,
                        const StepReports& report) = 0;

  // As the preconditioner M of an unsymmetric system. Has an earlier A left an M that still pays?
  virtual bool ready(Index env) const = 0;
  // Does M stay that of its own A? Else it is only as good as the A that apply() is given.
  virtual bool keeps_factors() const = 0;
  // M of this A in the environments of `todo`; false where there is none.
  virtual EnvMask prepare(const LinearSystem& system, const EnvMask& todo) = 0;
  // out = M^-1 in, in the environments of `todo`; 0 in all others.
  virtual void apply(linalg::BlockMatrix& A, device::View<const Vec3> in, device::View<Vec3> out, const EnvMask& todo) = 0;
  // The environments of `whose` have come to the end of their step.
  virtual void end_step(const EnvMask& whose) { (void)whose; }
  // What outlives a step and decides last digits, the order in which rows are eliminated, as it was at the end of the last one.
  virtual void checkpoint(Archive& archive) { (void)archive; }
  // What is kept has turned out to be of no use.
  virtual void distrust(Index env) = 0;
};

std::unique_ptr<Linear> make_direct(const model::Model& model, const Rows& rows, bool reuse);
std::unique_ptr<Linear> make_cg(const model::Model& model, const Rows& rows, const Options& options);

struct LinearChoice {
  std::string kind, reason;
};
// As the scene says, or by the size of the largest environment.
LinearChoice choose_linear(const model::Model& model, const Options& options);

}  // namespace mortise::solver
