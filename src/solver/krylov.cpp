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

#include "linalg/jacobi.h"
#include "linalg/schwarz.h"
#include "solver/kernels.h"
#include "solver/newton.h"

namespace mortise::solver {
namespace {

constexpr double kRoughest = 0.03;

linalg::RowPlaces row_places(const model::Model& model, const std::vector<Index>& block_of_row) {
  const std::vector<Vec3> rest = model.rest.download();
  std::vector<Index> body_of_block(model.blocks, -1);
  for (std::size_t b = 0; b < model.bodies.size(); ++b)
    std::fill(body_of_block.begin() + model.bodies[b].block_begin, body_of_block.begin() + model.bodies[b].block_end, static_cast<Index>(b));
  linalg::RowPlaces rows;
  for (Index block : block_of_row) {
    const model::Body& body = model.bodies[body_of_block[block]];
    const bool axis = body.type == model::BodyType::stiff && block != body.block_begin;
    rows.place.push_back(rest[axis ? body.block_begin : block]);
    rows.body.push_back(body_of_block[block]);
    rows.moves.push_back(axis ? 0 : 1);
  }
  return rows;
}

void gather(device::View<const Vec3> from, device::View<const Index> place, device::Buffer<Vec3>& to) {
  to.resize(place.n);
  const device::View<Vec3> out = to.view();
  device::parallel_for("krylov.positions", place.n, [=] MORTISE_HD(Index i) { out[i] = from[place[i]]; });
}

}  // namespace

// Schwarz needs a quarter to a half of the iterations of block Jacobi, but each costs twice as much on CPU threads, and setting it up as
// much as some fifteen of them: up to some ten thousand rows neither wins (benchmarks/linear).
void Newton::choose_preconditioner() {
  constexpr Index kSchwarzRows = 20000;
  Index most = 0;
  for (Index e = 0; e < model_.envs; ++e) most = std::max(most, env_rows_[e + 1] - env_rows_[e]);
  schwarz_ = options_.preconditioner == "mas" || (options_.preconditioner == "auto" && most >= kSchwarzRows);
}

void Newton::set_up_cg() {
  if (cg_) return;
  choose_preconditioner();
  if (schwarz_)
    preconditioner_ = std::make_unique<linalg::Schwarz>(row_places(model_, block_of_row_.download()), env_rows_);
  else
    preconditioner_ = std::make_unique<linalg::BlockJacobi>();
  cg_ = std::make_unique<linalg::ConjugateGradients>(env_rows_);
}

std::vector<double> Newton::forcing() const {
  std::vector<double> eta(model_.envs, options_.cg_tolerance);
  if (!options_.cg_forcing) return eta;
  for (Index e = 0; e < model_.envs; ++e) {
    double share = kRoughest;
    if (!cg_last_rhs_.empty()) {
      const double ratio = std::sqrt(rhs2_[e]) / cg_last_rhs_[e];  // not a number where both are zero
      if (ratio < 1) share = std::min(kRoughest, 0.9 * std::max(ratio * ratio, cg_relative_[e] * cg_relative_[e]));
    }
    eta[e] = std::max(share, options_.cg_tolerance);
  }
  return eta;
}

linalg::CgResult Newton::run_cg(device::View<const Vec3> b, device::View<Vec3> x, const std::vector<double>& relative, const std::vector<double>& absolute) {
  linalg::CgOptions options;
  options.max_iterations = options_.cg_iterations;
  options.absolute = absolute;
  return cg_->solve(matrix_, *preconditioner_, b, x, relative, options);
}

void Newton::build_preconditioner() {
  set_up_cg();
  gather(q_.view(), block_of_row_.view(), row_position_);
  preconditioner_->build(matrix_, row_position_.view());
}

// False if the matrix is not positive definite and can be made so.
bool Newton::solve_cg(StepReport& report) {
  // A preconditioner of an earlier iteration of the step serves on as long as it nearly keeps its speed, in iterations per digit. Not
  // with several environments: they would have a say in each other's choice.
  constexpr double kSlower = 1.5;
  if (model_.envs > 1 || built_speed_ == 0 || speed_ > kSlower * built_speed_) {
    build_preconditioner();
    built_speed_ = 0;
  }

  const std::vector<double> relative = forcing();
  std::vector<double> absolute;
  if (options_.cg_forcing)
    for (double w : wanted_) absolute.push_back(0.1 * w);
  const linalg::CgResult cg = run_cg(rhs_.view(), x_.view(), relative, absolute);
  report.cg += cg.iterations();
  for (Index e = 0; e < model_.envs; ++e) {
    const linalg::CgResult::Env& env = cg.env[e];
    if (env.end == linalg::CgEnd::not_positive_definite && concave_ > 0) {
      built_speed_ = 0;
      return false;
    }
    if (env.end == linalg::CgEnd::iteration_limit || (env.end == linalg::CgEnd::not_positive_definite && env.iterations == 0)) {
      std::ostringstream why;
      why << "conjugate gradients stopped after " << env.iterations << " iterations at " << env.residual / env.rhs << " of the right-hand side (wanted " << relative[e] << ")";
      throw Failure{why.str()};
    }
  }
  speed_ = cg.env[0].iterations / std::max(1.0, std::log10(cg.env[0].rhs / cg.env[0].residual));
  if (built_speed_ == 0) built_speed_ = speed_;
  cg_relative_ = relative;
  cg_last_rhs_.clear();
  for (const linalg::CgResult::Env& env : cg.env) cg_last_rhs_.push_back(env.rhs);
  return true;
}

}  // namespace mortise::solver
