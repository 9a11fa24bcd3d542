// Factors: a new one for every system, or conjugate gradients with the last one as long as that is cheaper. Unsymmetric systems are solved by GMRES
// with the factor of their symmetric part.
#include <algorithm>
#include <cmath>
#include <utility>

#include "effects/per_environment.h"
#include "linalg/stale_factor.h"
#include "linalg/submatrix.h"
#include "solver/kernels.h"
#include "solver/linear_whole.h"
#include "solver/tuning.h"

namespace mortise::solver {
namespace {

class Direct final : public Linear {
 public:
  Direct(const model::Model& model, const Rows& rows, bool reuse) : model_(model), rows_(rows), reuse_(reuse), parts_(model.envs) {}

  const char* name() const override { return reuse_ ? "reuse" : "direct"; }
  void begin_solve(bool changed) override {
    for (Index e = 0; e < rows_.envs(); ++e) {
      Part& part = parts_[e];
      part.fresh = part.precise = false;
      part.size = 0;
      if (std::exchange(part.loaded, false) || changed) part.solver.set_order(of_rows(e, part.order));
    }
  }
  void end_step(const EnvMask& whose) override {
    for (Index e = 0; e < rows_.envs(); ++e) {
      if (!whose[e]) continue;
      parts_[e].solver.settle_order();
      see_order(e);
      parts_[e].kept = parts_[e].order;
    }
  }
  void checkpoint(Archive& archive) override {
    std::vector<double> place(model_.blocks, -1.0), flops;  // among its environment's, of every block; -1: not in the order
    for (const Part& part : parts_) {
      for (std::size_t k = 0; k < part.kept.rows.size(); ++k) place[part.kept.rows[k]] = static_cast<double>(k);
      flops.push_back(part.kept.flops);
    }
    archive.io("elimination", place, effects::in_values(model_.env_blocks));
    archive.io("elimination_flops", flops, effects::one_each(model_.envs));
    for (Index e = 0; e < model_.envs; ++e) {
      if (!archive.loads(e)) continue;
      std::vector<std::pair<double, Index>> in_order;
      for (Index b = model_.env_blocks[e]; b < model_.env_blocks[e + 1]; ++b)
        if (place.at(b) >= 0) in_order.push_back({place[b], b});
      std::sort(in_order.begin(), in_order.end());
      Part& part = parts_[e];
      part.kept = {{}, flops.at(e)};
      for (const auto& [at, block] : in_order) part.kept.rows.push_back(block);
      part.order = part.kept;
      part.loaded = true;
    }
  }

  EnvMask solve(const LinearSystem& s, const EnvMask& todo, const CurvaturePolicy& curvature, EnvTable& envs, const StepReports& report) override {
    if (s.whole) return solve_whole(s, todo, curvature, envs, report);
    EnvMask indefinite(todo.size(), 0);
    for (Index e = 0; e < rows_.envs(); ++e) {
      if (!todo[e] || empty(e)) continue;
      Part& part = parts_[e];
      linalg::BlockMatrix& A = of(s.A, e);
      const device::View<const Vec3> b = range(s.b, e);
      const device::View<Vec3> x = range(s.x, e);
      if (keeps(e) && part.fresh && iterate(part, A, b, x, report[e])) continue;
      if (!factor(e, A, curvature, envs, report, indefinite)) continue;
      if (part.solver.precision() == linalg::Precision::rough) {
        if (iterate(part, A, b, x, report[e])) continue;
        part.precise = true;
        if (!factor(e, A, curvature, envs, report, indefinite)) continue;
      }
      part.solver.solve(b, x);
    }
    return indefinite;
  }

  bool ready(Index env) const override { return parts_[env].fresh; }
  bool keeps_factors() const override { return true; }
  EnvMask prepare(const LinearSystem& s, const EnvMask& todo) override {
    EnvMask good(todo.size(), 0);
    for (Index e = 0; e < rows_.envs(); ++e)
      if (todo[e]) {
        good[e] = factor(e, of(s.A, e));
        parts_[e].fresh = parts_[e].fresh && good[e];
      }
    return good;
  }
  void apply(linalg::BlockMatrix&, device::View<const Vec3> in, device::View<Vec3> out, const EnvMask& todo) override {
    for (Index e = 0; e < rows_.envs(); ++e) {
      const device::View<Vec3> x = range(out, e);
      if (todo[e] && model_.works_on(e))
        parts_[e].solver.solve(range(in, e), x);
      else
        device::clear(x.p, x.n * sizeof(Vec3));
    }
  }
  void distrust(Index env) override { parts_[env].fresh = false; }

 private:
  struct Part {
    linalg::DirectSolver solver;
    linalg::SubMatrix own;  // of several environments
    bool fresh = false;     // the last factor belongs to this step and still pays
    bool precise = false;   // single precision was too rough for this step's matrices
    // Of the step's last unsymmetric system: |b|, 0 before the first [N], and how closely it was to be solved.
    double size = 0, relative = 0;
    // Eisenstat and Walker: what the next right-hand side owes to this solution is to be less than what it owes to how far from linear forces are.
    // The same system once more, with less negative curvature, is solved as closely.
    double forcing(double b) {
      const double ratio = size > 0 ? b / size : 0;
      if (b != size) relative = std::clamp(tuning::kForcingFactor * ratio * ratio, tuning::kWholeRough, tuning::kWholeRoughest), size = b;
      return relative;
    }
    // The solver's order, in blocks of the model, which outlive rows; and what it was when the last step ended.
    linalg::DirectSolver::Order order, kept;
    long long orderings = 0;
    bool loaded = false;  // it has not come to the solver yet
  };
  // What only contact holds, in statics, slides away on the errors that iterations leave in soft directions.
  bool keeps(Index e) const { return reuse_ && !rows_.loose[e]; }
  bool empty(Index e) const { return rows_.env[e] == rows_.env[e + 1]; }
  // Where a factor is most of the work and only preconditions, it need not be precise.
  linalg::Precision precision(Index e, const linalg::BlockMatrix& A) const {
    return keeps(e) && !parts_[e].precise && A.rows > tuning::kDirectBlocks ? linalg::Precision::rough : linalg::Precision::full;
  }

  // may_change: there is less negative curvature to be had where A turns out to be indefinite.
  bool factor(Index e, const linalg::BlockMatrix& A, bool may_change = false) {
    Part& part = parts_[e];
    const linalg::Precision wanted = precision(e, A);
    const bool done = part.solver.factor(A, may_change && wanted == linalg::Precision::rough ? linalg::Precision::trial : wanted);
    see_order(e);
    return done;
  }
  void see_order(Index e) {
    Part& part = parts_[e];
    if (part.orderings == part.solver.stats().orderings) return;
    part.orderings = part.solver.stats().orderings;
    part.order = part.solver.order();
    for (Index& row : part.order.rows) row = rows_.of_row[rows_.env[e] + row];
  }
  // An order of blocks as one of rows; none where these are not the blocks that have rows.
  linalg::DirectSolver::Order of_rows(Index e, const linalg::DirectSolver::Order& blocks) const {
    linalg::DirectSolver::Order out{{}, blocks.flops};
    if (static_cast<Index>(blocks.rows.size()) != rows_.env[e + 1] - rows_.env[e]) return {};
    for (Index block : blocks.rows) {
      const Index row = rows_.of_block_host[block];
      if (row < 0) return {};
      out.rows.push_back(row - rows_.env[e]);
    }
    return out;
  }

  // By conjugate gradients with the factor that there is; false where they do not get there soon.
  bool iterate(Part& part, const linalg::BlockMatrix& A, device::View<const Vec3> b, device::View<Vec3> x, StepReport& report) {
    const linalg::StaleResult cg = linalg::solve_with_stale_factor(A, part.solver, b, x, tuning::kStaleForcing, tuning::kStaleMost);
    report.cg += cg.iterations;
    part.fresh = cg.converged && cg.iterations <= tuning::kStaleMost / 2;
    return cg.converged;
  }

  // A factor of A, shifted if need be; none where A is indefinite and need not be, or the environment fails.
  bool factor(Index e, linalg::BlockMatrix& A, const CurvaturePolicy& curvature, EnvTable& envs, const StepReports& report, EnvMask& indefinite) {
    Part& part = parts_[e];
    double shift = tuning::kFirstShift;
    part.fresh = factor(e, A, curvature.concavity(e) > 0);
    while (!part.fresh && curvature.concavity(e) == 0 && shift <= tuning::kLargestShift) {
      shift_diagonal(A, shift, {0, A.rows}, {1});
      shift *= tuning::kShiftGrowth;
      ++report[e].regularised;
      part.fresh = factor(e, A);
    }
    if (part.fresh) return true;
    if (curvature.concavity(e) > 0)
      indefinite[e] = 1;
    else
      envs.fail(e, "the matrix is not positive definite");
    return false;
  }

  // Where an old factor does not get there a new one is made.
  EnvMask solve_whole(const LinearSystem& s, const EnvMask& todo, const CurvaturePolicy& curvature, EnvTable& envs, const StepReports& report) {
    EnvMask indefinite(todo.size(), 0), left(todo.size(), 0);
    for (Index e = 0; e < rows_.envs(); ++e) left[e] = todo[e] && !empty(e);
    std::vector<double> relative(todo.size(), tuning::kWholeRough);
    for (Index e = 0; e < rows_.envs(); ++e)
      if (left[e] && keeps(e)) relative[e] = parts_[e].forcing(std::sqrt(s.b2[e]));
    for (int round = 0; any(left); ++round) {
      EnvMask stale(todo.size(), 0);
      for (Index e = 0; e < rows_.envs(); ++e) {
        if (!left[e]) continue;
        stale[e] = keeps(e) && round == 0 && parts_[e].fresh;
        if (!stale[e]) left[e] = factor(e, of(s.A, e), curvature, envs, report, indefinite);
      }
      if (s.aside) s.aside->done = false;
      const linalg::GmresResult end =
          solver::solve_whole(model_, s, left, rows_.env, relative, tuning::kWholeMost,
                              linalg::awaited([&](device::View<const Vec3> in, device::View<Vec3> out) { apply(s.A, in, out, left); }));
      for (Index e = 0; e < rows_.envs(); ++e) {
        if (!left[e]) continue;
        report[e].cg += end.of_env[e];
        const bool solved = end.relative[e] <= relative[e];
        parts_[e].fresh = solved && end.of_env[e] <= tuning::kWholeStale;
        left[e] = stale[e] && !solved;  // else as near as it came
      }
    }
    return indefinite;
  }

  // The environment's part of A: the factor of one does not know the others.
  linalg::BlockMatrix& of(linalg::BlockMatrix& A, Index e) { return rows_.envs() == 1 ? A : parts_[e].own.of(A, rows_.env[e], rows_.env[e + 1]); }
  template <class T>
  device::View<T> range(device::View<T> v, Index e) const {
    return {v.p + rows_.env[e], rows_.env[e + 1] - rows_.env[e]};
  }

  const model::Model& model_;
  const Rows& rows_;
  const bool reuse_;
  std::vector<Part> parts_;
};

}  // namespace

std::unique_ptr<Linear> make_direct(const model::Model& model, const Rows& rows, bool reuse) { return std::make_unique<Direct>(model, rows, reuse); }

LinearChoice choose_linear(const model::Model& model, const Options& options) {
  if (options.linear != "auto") return {options.linear, "asked for by the scene"};
  Index blocks = 0;
  for (Index e = 0; e < model.envs; ++e) blocks = std::max(blocks, model.env_blocks[e + 1] - model.env_blocks[e]);
  const std::string size = std::to_string(blocks) + " blocks";
  if (!device::kHostThreads && options.batch) return {"cg", "many environments, whose factors a GPU's host would make one after another"};
  if (blocks <= tuning::kDirectBlocks) return {"direct", size + ", a new factor each time up to " + std::to_string(tuning::kDirectBlocks)};
  const Index limit = device::kHostThreads ? tuning::kReuseBlocks : tuning::kDirectBlocks;  // on a GPU conjugate gradients are quicker from here on
  if (blocks <= limit) return {"reuse", size + ", factors up to " + std::to_string(limit)};
  return {"cg", size + ", more than " + std::to_string(limit)};
}

}  // namespace mortise::solver
