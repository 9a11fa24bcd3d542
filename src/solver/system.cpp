#include "solver/system.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>

#include "linalg/supports.h"
#include "solver/kernels.h"
#include "solver/timed.h"
#include "solver/tuning.h"

namespace mortise::solver {
namespace {

std::vector<double> lengths(const model::Model& model) {
  std::vector<Vec3> lo(model.envs, Vec3::Constant(INFINITY)), hi(model.envs, Vec3::Constant(-INFINITY));
  const std::vector<Vec3> rest = model.rest_points.download();
  for (const model::Body& body : model.bodies)
    for (Index p = body.point_begin; p < body.point_end; ++p)
      lo[body.env] = lo[body.env].cwiseMin(rest[p]), hi[body.env] = hi[body.env].cwiseMax(rest[p]);
  std::vector<double> out;
  for (Index e = 0; e < model.envs; ++e) out.push_back((hi[e] - lo[e]).norm());
  return out;
}

}  // namespace

System::System(model::Model& model_, EffectList& effects, const Options& options_, Clock& clock_)
    : model(model_),
      options(options_),
      clock(clock_),
      potential(model_, effects, clock_),
      convergence(model_, options_),
      hold(model_.envs),
      length(lengths(model_)) {
  for (const auto& effect : effects) touching_ = touching_ || effect->kind().role == effects::Role::contact;
}

void System::begin_solve() {
  rows_changed_ = rows.number(model, options.is_static);
  if (rows_changed_) {
    convergence.set_rows(rows.of_block_host);
    const bool tied = model.ties.any();
    const std::vector<Index>& of_block = tied ? rows.tied.of_block : rows.of_block_host;
    std::vector<Index> env_rows{0};
    for (Index e = 0; e < model.envs; ++e)
      env_rows.push_back(std::accumulate(of_block.begin() + model.env_blocks[e], of_block.begin() + model.env_blocks[e + 1], env_rows.back(),
                                         [](Index end, Index row) { return std::max(end, row + 1); }));
    potential.assembler().set_rows(device::Buffer<Index>(of_block), tied ? rows.tied.count() : rows.count(), env_rows);
    if (tied) elimination_.set(rows.tied.offset, rows.tied.column, rows.tied.weight, rows.count());
  }
  convergence.begin_step();
  hold.begin_solve();
}

Residual System::linearise(device::View<const Vec3> q, effects::Want want, Linearised& at, bool fresh) {
  potential.linearise(q, want, at, fresh);
  return residual(q, at);
}

Residual System::residual(device::View<const Vec3> q, const Linearised& at) const {
  device::Fetch fetch;
  return residual(q, at, fetch);
}

Residual System::residual(device::View<const Vec3> q, const Linearised& at, device::Fetch& fetch) const {
  Residual r = convergence.begin();
  for (std::size_t k = 0; k < at.gradients.size(); ++k) {
    device::View<const Vec3> gradient = at.gradients[k].view();
    if (model.ties.any()) {
      folded_.copy_from(at.gradients[k]);
      model.ties.fold(folded_.view());
      gradient = std::as_const(folded_).view();
    }
    convergence.see_effect(potential.effects()[k]->kind(), gradient, r, fetch);
  }
  convergence.see_sum(at.gradient.view(), q, r, fetch);
  device::Buffer<Vec3> c;
  supports(q, c);
  largest(std::as_const(c).view(), model.env_blocks, {r.support_gap, fetch});
  fetch.now("residual");
  convergence.finish(r);
  return r;
}

std::string System::gone_for_good(const Residual& r, Index env) const {
  for (Index i = model.env_bodies[env]; options.is_static && i < model.env_bodies[env + 1]; ++i) {
    if (!(r.way[i] > tuning::kGone * length[env])) continue;
    std::ostringstream why;
    why << "'" << model.bodies[i].name << "' has gone " << r.way[i] << " m in a scene of " << length[env] << " m: nothing holds it against its loads";
    return why.str();
  }
  return {};
}

std::string System::not_finite(const Linearised& at, Index env) const {
  for (std::size_t k = 0; k < at.gradients.size(); ++k)
    if (!std::isfinite(largest(at.gradients[k].view(), model.env_blocks)[env]))
      return "the force of '" + std::string(potential.effects()[k]->name()) + "' is not finite at " +
             name_block(model, worst_block(model, at.gradients[k], env));
  return "the force residual is not finite";
}

void System::find_groups(Linearised& at, const EnvMask& whose) {
  potential.sample(at);
  std::vector<const model::ContactView*> contacts;
  for (std::size_t k = 0; k < at.of.size(); ++k)
    if (potential.effects()[k]->kind().role == effects::Role::contact) contacts.push_back(&at.of[k]->contact);
  convergence.connect(contacts, whose);
}

void System::supports(device::View<const Vec3> q, device::Buffer<Vec3>& c) const {
  support_move(q, std::as_const(model.target).view(), std::as_const(model.projector).view(), c);
  if (model.ties.any()) model.ties.carry(c.view());
  if (model.ties.driven()) model.ties.add_offset(q, c.view());
}

void System::matrix(Linearised& at, device::View<const Vec3> q, const EnvMask& whose, linalg::BlockMatrix& A, device::Fetch& now,
                    device::Fetch& later) {
  const Timed timed(clock, "solver", "matrix");
  if (model.ties.any()) {
    potential.assembler().matrix(at.sets(), whole_, now);
    elimination_.reduce(whole_, A);
  } else {
    potential.assembler().matrix(at.sets(), A, now);
  }
  convergence.see_matrix(A, q, rows.block.view(), whose, later);
  if (rows.any_partial) linalg::project(A, rows.projector.view());
  // Without a shift rounding decides how far a body that nothing holds goes along its free motions.
  shift_diagonal(A, tuning::kLoose, rows.env, rows.loose);
  for (Index e = 0; e < model.envs; ++e)
    if (whose[e] && rows.loose[e])
      hold.set_stiffness(e, rows.loose_env[e + 1] - rows.loose_env[e],
                         hold_rows(A, hold.scale(e), hold.firm(e), std::as_const(rows.loose_row).view(), rows.loose_env[e], rows.loose_env[e + 1],
                                   rows.block.view(), convergence.lever(), convergence.position()));
}

linalg::Operator System::whole(Linearised& at, const linalg::BlockMatrix& A) {
  return [this, &at, &A](device::View<const Vec3> in, device::View<Vec3> out) {
    linalg::multiply(A, in, model.working(rows.env), out);
    to_blocks(in, {}, EnvMask(model.envs, 1), way_);
    potential.unsymmetric_product(at, false, std::as_const(way_).view(), force_);
    add_to_rows(std::as_const(force_).view(), model.working(rows.env), rows.block.view(), rows.projector.view(), out);
  };
}

linalg::Operator System::jacobian(Linearised& at, bool transposed) {
  return on_rows(
      [this, &at, transposed](device::View<const Vec3> in, device::Buffer<Vec3>& out) { potential.jacobian_product(at, transposed, in, out); });
}

linalg::Operator System::on_rows(BlockProduct product) {
  return [this, product = std::move(product)](device::View<const Vec3> in, device::View<Vec3> out) {
    to_blocks(in, {}, EnvMask(model.envs, 1), way_);
    product(std::as_const(way_).view(), force_);
    device::clear(out.p, out.n * sizeof(Vec3));
    add_to_rows(std::as_const(force_).view(), model.working(rows.env), rows.block.view(), rows.projector.view(), out);
  };
}

void System::right_hand_side(const Linearised& at, device::View<const Vec3> Hc, device::Buffer<Vec3>& rhs) const {
  solver::right_hand_side(at.gradient.view(), Hc, rows.block.view(), rows.projector.view(), rhs);
}

void System::to_blocks(device::View<const Vec3> x, device::View<const Vec3> c, const EnvMask& whose, device::Buffer<Vec3>& dq) const {
  step_of(x, c, rows.of_block.view(), std::as_const(model.projector).view(), dq);
  if (model.ties.any()) model.ties.carry(dq.view());
  if (model.ties.driven() && c.n > 0) model.ties.add_offset_of(c, dq.view());
  clear_envs(dq, whose, 0, model.env_blocks);
}

bool System::solved(const Residual& r, Index env, double relative, double last_step) const {
  if (!convergence.solved(r, env, relative) || r.support_gap[env] > tuning::kSupportGap * length[env]) return false;
  return options.step_tolerance <= 0 || last_step <= options.step_tolerance;
}

}  // namespace mortise::solver
