// Conjugate gradients for the Newton direction: preconditioner, and how exactly every system is solved.
//
// Far from the solution a direction to many digits is wasted. With b_k the right-hand side of iteration k, each environment asks for
//
//   |b_k - A x| <= max(eta_k |b_k|, wanted / 10),   eta_k = clamp(0.9 (|b_k| / |b_k-1|)^2, cg_tolerance, 0.03)
//
// and eta_k no smaller than 0.9 eta_k-1^2 (Eisenstat, Walker, SIAM J. Sci. Comput. 17, 1996, choice 2 and its safeguard, here
// always on); `wanted` is the residual at which Newton stops, so that the last system is solved as exactly as that needs.
#include <algorithm>
#include <cmath>
#include <sstream>

#include "linalg/cg.h"
#include "linalg/jacobi.h"
#include "linalg/per_environment.h"
#include "linalg/schwarz.h"
#include "solver/kernels.h"
#include "solver/linear_whole.h"
#include "solver/tuning.h"

namespace mortise::solver {
namespace {

// Of the rows [first, last).
linalg::RowPlaces row_places(const model::Model& model, const std::vector<Index>& block_of_row, Index first, Index last) {
  const std::vector<Vec3> rest = model.rest.download();
  std::vector<Index> body_of_block(model.blocks, -1);
  for (std::size_t b = 0; b < model.bodies.size(); ++b)
    std::fill(body_of_block.begin() + model.bodies[b].block_begin, body_of_block.begin() + model.bodies[b].block_end, static_cast<Index>(b));
  linalg::RowPlaces rows;
  for (Index r = first; r < last; ++r) {
    const Index block = block_of_row[r];
    const model::Body& body = model.bodies[body_of_block[block]];
    const bool axis = body.type == model::BodyType::stiff && block != body.block_begin;
    rows.place.push_back(rest[axis ? body.block_begin : block]);
    rows.body.push_back(body_of_block[block]);
    rows.moves.push_back(axis ? 0 : 1);
  }
  return rows;
}

class Cg final : public Linear {
 public:
  Cg(const model::Model& model, const Rows& rows, const Options& options) : model_(model), rows_(rows), options_(options), env_(model.envs) {}

  const char* name() const override { return "cg"; }
  void begin_solve(bool changed) override {
    if (changed) cg_.reset();
    for (Env& e : env_) e = {.rate = e.rate};
  }

  EnvMask solve(const LinearSystem& s, const EnvMask& todo, const CurvaturePolicy& curvature, EnvTable& envs, const StepReports& report) override {
    EnvMask indefinite(todo.size(), 0);
    if (s.A.rows == 0) return indefinite;
    // A preconditioner of an earlier iteration of the step serves on as long as it nearly keeps its speed, in iterations per digit.
    EnvMask anew(todo.size(), 0);
    for (std::size_t e = 0; e < todo.size(); ++e) {
      if (!todo[e] || !(env_[e].built_speed == 0 || env_[e].speed > tuning::kSlower * env_[e].built_speed)) continue;
      anew[e] = 1;
      env_[e].built_speed = 0;
    }
    build(s, anew);

    std::vector<double> relative(todo.size()), absolute;
    for (std::size_t e = 0; e < todo.size(); ++e) relative[e] = forcing(env_[e], s.b2[e]);
    if (options_.cg_forcing)
      for (double w : s.wanted) absolute.push_back(tuning::kBeyondWanted * w);
    if (s.whole) {
      const std::vector<double> rough(todo.size(), tuning::kInner), nothing(todo.size(), 0.0);
      // The symmetric part alone first: less would not see that it is indefinite.
      for (double& asked : relative) asked = std::max(asked, tuning::kWholeRough);
      EnvMask left = todo;
      const Start start = [&](const Then& then) {
        const linalg::CgResult symmetric = run(s.A, s.b, s.x, relative, absolute, todo, then, &s);
        count(symmetric, todo, report);
        for (Index e = 0; e < rows_.envs(); ++e)
          if (todo[e] && symmetric.env[e].end == linalg::CgEnd::not_positive_definite && curvature.concavity(e) > 0)
            env_[e].built_speed = 0, indefinite[e] = 1, left[e] = 0;
        return left;
      };
      const auto inner = [&](device::View<const Vec3> in, device::View<Vec3> out, const Then& then) {
        device::clear(out.p, out.n * sizeof(Vec3));
        count(run(s.A, in, out, rough, nothing, left, then), left, report);  // none of those that have ended
      };
      const linalg::GmresResult end = solve_whole(model_, s, start, rows_.env, relative, tuning::kWholeMost, inner);
      for (Index e = 0; e < rows_.envs(); ++e) {
        if (!left[e]) continue;
        env_[e].speed = end.of_env[e] / std::max(1.0, -std::log10(end.relative[e]));
        if (env_[e].built_speed == 0) env_[e].built_speed = env_[e].speed;
        env_[e].relative = relative[e], env_[e].last_rhs = std::sqrt(s.b2[e]), env_[e].any = true;
      }
      return indefinite;
    }
    const linalg::CgResult cg = run(s.A, s.b, s.x, relative, absolute, todo, s.aside ? s.aside->ask : Then{}, &s);
    if (s.aside) s.aside->done = true;
    count(cg, todo, report);
    for (Index e = 0; e < rows_.envs(); ++e) {
      if (!todo[e]) continue;
      const linalg::CgResult::Env& end = cg.env[e];
      if (end.end == linalg::CgEnd::not_positive_definite && curvature.concavity(e) > 0) {
        env_[e].built_speed = 0;
        indefinite[e] = 1;
        continue;
      }
      if (end.end == linalg::CgEnd::iteration_limit || (end.end == linalg::CgEnd::not_positive_definite && end.iterations == 0)) {
        std::ostringstream why;
        why << "conjugate gradients stopped after " << end.iterations << " iterations at " << end.residual / end.rhs
            << " of the right-hand side (wanted " << relative[e] << ")";
        envs.fail(e, why.str());
        continue;
      }
      env_[e].speed = end.iterations / std::max(1.0, std::log10(end.rhs / end.residual));
      if (env_[e].built_speed == 0) env_[e].built_speed = env_[e].speed;
      env_[e].relative = relative[e];
      env_[e].last_rhs = end.rhs;
      env_[e].any = true;
    }
    return indefinite;
  }

  bool ready(Index) const override { return false; }
  bool keeps_factors() const override { return false; }
  EnvMask prepare(const LinearSystem& s, const EnvMask& todo) override {
    build(s, todo);
    return todo;
  }
  void apply(linalg::BlockMatrix& A, device::View<const Vec3> in, device::View<Vec3> out, const EnvMask& todo) override {
    device::clear(out.p, out.n * sizeof(Vec3));
    run(A, in, out, std::vector<double>(todo.size(), tuning::kRough), std::vector<double>(todo.size(), 0.0), todo);
  }
  void distrust(Index) override {}

 private:
  using Then = std::function<void(device::Fetch&)>;

  // Within one step, but for `rate`, by which only the host's looks go.
  struct Env {
    double built_speed = 0, speed = 0;  // iterations per digit: right after the preconditioner was built (0: not yet), last time
    double rate = 0;                    // iterations per digit of the last system with A itself
    bool any = false;                   // a system has been solved; how exactly, and its right-hand side:
    double relative = 0, last_rhs = 0;
  };

  static void count(const linalg::CgResult& cg, const EnvMask& whose, const StepReports& report) {
    for (std::size_t e = 0; e < whose.size(); ++e)
      if (whose[e]) report[static_cast<Index>(e)].cg += cg.env[e].iterations;
  }

  // Iterations of a Newton iteration's own system, at the rate of the last one; 0 where there was none.
  Index expected(const std::vector<double>& relative, const std::vector<double>& absolute, const EnvMask& todo, const LinearSystem& of) const {
    double most = 0;
    for (std::size_t e = 0; e < todo.size(); ++e) {
      if (!todo[e]) continue;
      const double least = !absolute.empty() && of.b2[e] > 0 ? absolute[e] / std::sqrt(of.b2[e]) : 0;
      most = std::max(most, env_[e].rate * -std::log10(std::max(relative[e], least)));
    }
    return static_cast<Index>(std::min<double>(most, options_.cg_iterations));
  }

  double forcing(const Env& e, double b2) const {
    if (!options_.cg_forcing) return options_.cg_tolerance;
    double forcing = tuning::kRoughest;
    if (e.any) {
      const double ratio = std::sqrt(b2) / e.last_rhs;  // not a number where both are zero
      if (ratio < 1) forcing = std::min(tuning::kRoughest, tuning::kForcingFactor * std::max(ratio * ratio, e.relative * e.relative));
    }
    return std::max(forcing, options_.cg_tolerance);
  }

  linalg::CgResult run(const linalg::BlockMatrix& A, device::View<const Vec3> b, device::View<Vec3> x, const std::vector<double>& relative,
                       const std::vector<double>& absolute, const EnvMask& todo, const Then& then = {}, const LinearSystem* of = nullptr) {
    linalg::CgOptions options;
    options.then = then;
    options.max_iterations = options_.cg_iterations;
    options.absolute = absolute;
    options.only = todo;
    if (of) options.expected = expected(relative, absolute, todo, *of);
    if (of && of->aside) options.fetch = &of->aside->fetch;
    for (Index e = 0; e < rows_.envs(); ++e) options.only[e] &= static_cast<std::uint8_t>(model_.works_on(e));
    const linalg::CgResult out = cg_->solve(A, *preconditioner_, b, x, relative, options);
    for (std::size_t e = 0; of && e < todo.size(); ++e)
      if (const linalg::CgResult::Env& end = out.env[e]; todo[e] && end.end == linalg::CgEnd::converged && end.residual < end.rhs)
        env_[e].rate = end.iterations / std::log10(end.rhs / end.residual);
    return out;
  }

  // Schwarz needs a quarter to a half of the iterations of block Jacobi, but each costs twice as much on CPU threads, and setting it up as much
  // as some fifteen of them.
  bool schwarz(Index rows) const { return options_.preconditioner == "mas" || (options_.preconditioner == "auto" && rows >= tuning::kSchwarzRows); }
  std::unique_ptr<linalg::Preconditioner> schwarz_of(Index first, Index last) const {
    return std::make_unique<linalg::Schwarz>(row_places(model_, rows_.of_row, first, last), std::vector<Index>{0, last - first});
  }

  void set_up() {
    if (cg_) return;
    // Jacobi for all environments at once, unless one of them is large enough for Schwarz.
    bool any_schwarz = false;
    for (Index e = 0; e < rows_.envs(); ++e) any_schwarz |= schwarz(rows_.env[e + 1] - rows_.env[e]);
    if (!any_schwarz) {
      preconditioner_ = std::make_unique<linalg::BlockJacobi>(rows_.env);
    } else if (rows_.envs() == 1) {
      preconditioner_ = schwarz_of(0, rows_.count());
    } else {
      preconditioner_ =
          std::make_unique<linalg::PerEnvironment>(rows_.env, [this](Index first, Index last) -> std::unique_ptr<linalg::Preconditioner> {
            if (schwarz(last - first)) return schwarz_of(first, last);
            return std::make_unique<linalg::BlockJacobi>(std::vector<Index>{0, last - first});
          });
    }
    cg_ = std::make_unique<linalg::ConjugateGradients>(rows_.env);
  }

  void build(const LinearSystem& s, const EnvMask& todo) {
    set_up();
    if (!any(todo)) return;
    gather(s.q, rows_.block.view(), position_);
    preconditioner_->choose(todo);
    preconditioner_->build(s.A, std::as_const(position_).view());
  }

  const model::Model& model_;
  const Rows& rows_;
  const Options& options_;
  std::vector<Env> env_;
  std::unique_ptr<linalg::Preconditioner> preconditioner_;
  std::unique_ptr<linalg::ConjugateGradients> cg_;  // of the present rows
  device::Buffer<Vec3> position_;
};

}  // namespace

std::unique_ptr<Linear> make_cg(const model::Model& model, const Rows& rows, const Options& options) {
  return std::make_unique<Cg>(model, rows, options);
}

}  // namespace mortise::solver
