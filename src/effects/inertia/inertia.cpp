#include "effects/inertia/inertia.h"

#include <algorithm>
#include <utility>

#include "effects/body_blocks.h"
#include "effects/list.h"
#include "effects/per_environment.h"

namespace mortise::effects {
namespace {

const ParamTable kTable{"effect inertia",
                        "Bodies resist acceleration; makes the scene dynamic.",
                        {param::choice("integrator", {"backward_euler", "bdf2"}, "backward_euler",
                                       "Time integrator: backward_euler is first-order and damps, bdf2 is second-order and damps far less.")}};

// One nonzero m_ij, i <= j, of the mass matrix.
struct MassPair {
  Index i, j;
  double m;
};

// Masses that stand on nodes are spread by a share s: M a becomes M a + s (M_spread - M) a, of the accelerations of what was carried to `from` and
// went to q; it goes into what `hat` says.
void spread_masses(const model::Model& model, const std::vector<std::uint8_t>& on_nodes, double s, Positions from, Positions q, View<Vec3> hat) {
  const device::Buffer<std::uint8_t> lumped_blocks(on_nodes);
  const View<const std::uint8_t> lumped = lumped_blocks.view();
  const View<const Index> row = model.mass.row_offset.view(), column = model.mass.column.view();
  const View<const double> mass = model.mass.value.view();
  device::parallel_for("inertia.spread", hat.n, [=] MORTISE_HD(Index b) {
    if (!lumped[b]) return;
    Vec3 spread = Vec3::Zero();
    double sum = 0;
    for (Index k = row[b]; k < row[b + 1]; ++k) spread += mass[k] * (q[column[k]] - from[column[k]]), sum += mass[k];
    hat[b] -= s * (spread / sum - (q[b] - from[b]));
  });
}

class Inertia final : public Effect {
 public:
  Inertia(const Params& params, model::Model& model) : model_(model), bdf2_(params.text("integrator") == "bdf2") {
    find_pairs();
    q_begin_.copy_from(model.q);
    q_prev_.copy_from(model.q);
    v_.copy_from(model.initial_velocity);
    v_prev_.copy_from(v_);
    q_hat_.copy_from(model.q);
    integrator_.resize(2 * model.envs);
    integrators_.upload(integrator_);
    find_integrators();
    dt_prev_.assign(model.envs, 0.0);
  }

  // Supports and ties are known by now.
  void connect() override { find_pairs(), find_integrators(); }

  void write_pattern(linalg::StencilSet& stencils) const {
    device::Buffer<Index> counts;
    counts.copy_from(counts_);
    stencils.resize(std::move(counts));
    const linalg::StencilView out = stencils.view();
    const View<const MassPair> p = std::as_const(pairs_).view();
    device::parallel_for("inertia.pattern", p.n, [=] MORTISE_HD(Index s) {
      out.block[out.offset[s]] = p[s].i;
      if (p[s].i != p[s].j) out.block[out.offset[s] + 1] = p[s].j;
    });
    stencils.pattern_changed();
  }

  const Kind& kind() const override;
  bool loses_energy() const override { return true; }
  bool second_order(Index env) const override { return integrator_[env].a2 != 0; }
  bool starts(Index env) const override { return bdf2_ && dt_prev_[env] == 0; }
  std::vector<PlanItem> plan() const override {
    return {{"mass entries", pairs_.bytes() + counts_.bytes()},
            {"history", q_begin_.bytes() + q_prev_.bytes() + v_.bytes() + v_prev_.bytes() + q_hat_.bytes()}};
  }

  void integrate(StepInfo& step) const override {
    step.integrators.clear();
    for (Index e = 0; e < model_.envs; ++e) step.integrators.push_back(step.of_first_order(e) ? backward_euler(step.dt) : own(step, e));
  }
  // Changes no history, so that a step may be tried again with a smaller dt.
  void begin_step(const StepInfo& step) override {
    for (Index e = 0; e < model_.envs; ++e)
      if (step.taken_by(e)) integrator_[e] = step.integrator(e), integrator_[model_.envs + e] = own(step, e);
    integrators_.upload(integrator_);
    const View<const Integrator> in = std::as_const(integrators_).view();
    const View<const Index> by = std::as_const(by_).view();
    const Positions qn = std::as_const(model_.q).view(), qn1 = std::as_const(q_prev_).view();
    const Positions vn = std::as_const(v_).view(), vn1 = std::as_const(v_prev_).view();
    const View<Vec3> hat = q_hat_.view();
    device::parallel_for("inertia.predict", hat.n, [=] MORTISE_HD(Index b) { hat[b] = inertia::q_hat(in[by[b]], qn[b], qn1[b], vn[b], vn1[b]); });
    q_begin_.copy_from(model_.q);
  }

  Positions carried() const override { return q_hat_.view(); }

  void energy(Positions q, const Linearisation&, device::EnvValues per_env) override {
    const View<const MassPair> pair = std::as_const(pairs_).view();
    const Positions hat = std::as_const(q_hat_).view();
    const View<const Integrator> in = std::as_const(integrators_).view();
    const View<const Index> by = std::as_const(by_).view();
    device::env_sum(
        "inertia.energy", model_.working(env_offset_),
        [=] MORTISE_HD(Index s) {
          const MassPair p = pair[s];
          return inertia::energy(p.i == p.j, inertia::c_of(in[by[p.i]]) * p.m, q[p.i] - hat[p.i], q[p.j] - hat[p.j]);
        },
        per_env);
  }

  // Of bodies that go where the scene says nothing is counted: what they gain is the work of what moves them, and where their motion begins or
  // kinks the formula finds accelerations that they do not have.
  void own_gain(Positions q, device::EnvValues gain, device::EnvValues there) override {
    const View<const MassPair> pair = std::as_const(pairs_).view();
    const Positions hat = std::as_const(q_hat_).view(), qn = std::as_const(q_begin_).view(), qn1 = std::as_const(q_prev_).view(),
                    vn = std::as_const(v_).view();
    const View<const Integrator> in = std::as_const(integrators_).view();
    const View<const Index> by = std::as_const(by_).view();
    const Index envs = model_.envs;
    device::env_sum(
        "inertia.own_gain", model_.working(env_offset_),
        [=] MORTISE_HD(Index s) {
          const MassPair p = pair[s];
          if (by[p.i] >= envs) return 0.0;
          const Integrator of = in[by[p.i]];
          const Index ij[2] = {p.i, p.j};
          Vec3 v[2], before[2], d[2], w[2];
          for (int k = 0; k < 2; ++k) {
            const Index b = ij[k];
            v[k] = of.rate(q[b], qn[b], qn1[b]), before[k] = vn[b], d[k] = q[b] - hat[b], w[k] = q[b] - qn[b];
          }
          return inertia::own_gain(p.i == p.j, p.m, inertia::c_of(of), v, before, d, w);
        },
        gain);
    device::env_sum(
        "inertia.kinetic", model_.working(env_offset_),
        [=] MORTISE_HD(Index s) { return inertia::energy(pair[s].i == pair[s].j, pair[s].m, vn[pair[s].i], vn[pair[s].j]); }, there);
  }

  void mend(Fault fault, double share) override {
    if (fault == Fault::mesh) spread_ = share;
    if (fault != Fault::steps) return;
    mended_ = share;
    for (device::Buffer<Vec3>* v : {&a_, &a_prev_, &more_}) v->copy_from(v_), v->zero();
  }
  // With the accelerations of the leader: of its own, what is mended would take part in the motion, and grow with it.
  void keep_pace(const Effect& leader, Positions q) override {
    if (spread_ != 0) spread_masses(model_, lumped_blocks(), spread_, static_cast<const Inertia&>(leader).q_hat_.view(), q, q_hat_.view());
    if (mended_ == 0) return;
    const LeftOut own = left_out(integrator_[0], known_), given = left_out(integrator_[1], known_);
    const double s = mended_, own_c = inertia::c_of(integrator_[0]), given_c = inertia::c_of(integrator_[1]), dt = integrator_[0].dt;
    const View<const Index> by = std::as_const(by_).view();
    const Positions leads = std::as_const(static_cast<const Inertia&>(leader).q_hat_).view();
    const View<Vec3> hat = q_hat_.view(), an = a_.view(), an1 = a_prev_.view(), more = more_.view();
    device::parallel_for("inertia.follow", hat.n, [=] MORTISE_HD(Index b) {
      const double c = by[b] == 0 ? own_c : given_c;
      const LeftOut& left = by[b] == 0 ? own : given;
      const Vec3 a = c * (q[b] - leads[b]);
      hat[b] -= s / c * (left.a0 * a - left.a1 * an[b] + left.a2 * an1[b]);
      more[b] = s * dt * (left.v0 * a - left.v1 * an[b]);
      an1[b] = an[b];
      an[b] = a;
    });
    known_ = std::min(known_ + 1, 2);
  }

  void linearise(Positions q, Want want, Linearisation& at) override {
    if (!want.forces) return;
    if (!at.shaped) write_pattern(at.stencils), at.shaped = true;
    const bool stiffness = want.matrix.wanted;
    if (stiffness) at.stencils.need_hessian();
    const View<const MassPair> pair = std::as_const(pairs_).view();
    const Positions hat = std::as_const(q_hat_).view();
    const linalg::StencilView out = at.stencils.view();
    const View<const Integrator> in = std::as_const(integrators_).view();
    const View<const Index> by = std::as_const(by_).view();
    device::parallel_for("inertia.assemble", model_.working(env_offset_), [=] MORTISE_HD(Index s) {
      const MassPair p = pair[s];
      const double cm = inertia::c_of(in[by[p.i]]) * p.m;
      Vec3* grad = out.grad.p + out.offset[s];
      Mat3* hess = stiffness ? out.hess.p + out.hess_offset[s] : nullptr;
      if (p.i == p.j) {
        grad[0] = cm * (q[p.i] - hat[p.i]);
        if (hess) hess[0] = cm * Mat3::Identity();
      } else {
        grad[0] = cm * (q[p.j] - hat[p.j]);
        grad[1] = cm * (q[p.i] - hat[p.i]);
        if (hess) hess[0] = Mat3::Zero(), hess[1] = cm * Mat3::Identity(), hess[2] = Mat3::Zero();
      }
    });
  }

  void end_step(const StepInfo& step, Positions q, const Linearisation&) override {
    std::vector<std::uint8_t> taken;
    for (Index e = 0; e < model_.envs; ++e) {
      taken.push_back(step.taken_by(e));
      if (taken.back()) dt_prev_[e] = integrator_[e].dt;
    }
    const device::Buffer<std::uint8_t> mask(taken);
    const View<const std::uint8_t> mine = mask.view();
    const View<const Integrator> in = std::as_const(integrators_).view();
    const View<const Index> env = std::as_const(model_.block_env).view(), by = std::as_const(by_).view();
    const Positions qn = std::as_const(q_begin_).view();
    const View<Vec3> qn1 = q_prev_.view(), vn = v_.view(), vn1 = v_prev_.view();
    device::parallel_for("inertia.velocity", q.n, [=] MORTISE_HD(Index b) {
      if (!mine[env[b]]) return;
      const Vec3 v = in[by[b]].rate(q[b], qn[b], qn1[b]);
      qn1[b] = qn[b];
      vn1[b] = vn[b];
      vn[b] = v;
    });
    if (mended_ == 0) return;
    const View<const Vec3> more = std::as_const(more_).view();
    device::parallel_for("inertia.mend", more.n, [=] MORTISE_HD(Index b) { vn[b] += more[b]; });
  }

  void report(const FieldSinks& sinks, const Linearisation&) override {
    device::Buffer<Vec3> y;
    model_.points_of(std::as_const(v_).view(), y);
    const std::vector<Vec3> velocity = y.download();
    report_points(sinks, model_, "velocity", "m/s", 3, {velocity.empty() ? nullptr : velocity[0].data(), 3 * velocity.size()});

    // Kinetic energy 1/2 v.Mv; momentum of a rigid translation, sum_ij share_i m_ij v_j; and of a rigid rotation about the
    // origin, which turns every block alike, sum_ij q_i x m_ij v_j.
    const std::vector<Vec3> v = v_.download(), q = model_.q.download();
    const std::vector<double> weight = translation_weight(model_);
    const std::vector<MassPair> pairs = pairs_.download();
    for (Index e = 0; e < sinks.size(); ++e) {
      double kinetic = 0;
      Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
      for (Index i = env_offset_[e]; i < env_offset_[e + 1]; ++i) {
        const MassPair& p = pairs[i];
        kinetic += inertia::energy(p.i == p.j, p.m, v[p.i], v[p.j]);
        linear += p.m * weight[p.i] * v[p.j];
        angular += p.m * q[p.i].cross(v[p.j]);
        if (p.i == p.j) continue;
        linear += p.m * weight[p.j] * v[p.i];
        angular += p.m * q[p.j].cross(v[p.i]);
      }
      sinks[e].scalar("inertia", "kinetic_energy", "J", kinetic);
      const char* axes[] = {"x", "y", "z"};
      for (int a = 0; a < 3; ++a) sinks[e].scalar("inertia", std::string("momentum_") + axes[a], "kg m/s", linear[a]);
      for (int a = 0; a < 3; ++a) sinks[e].scalar("inertia", std::string("angular_momentum_") + axes[a], "kg m^2/s", angular[a]);
    }
  }

  void checkpoint(Archive& archive) override {
    archive.io("dt_prev", dt_prev_, one_each(model_.envs));
    io(archive, "q_prev", q_prev_, model_.env_blocks);
    io(archive, "v", v_, model_.env_blocks);
    io(archive, "v_prev", v_prev_, model_.env_blocks);
  }

 private:
  // The integrator of an environment that the step asks for no other of.
  Integrator own(const StepInfo& step, Index e) const { return bdf2_ && dt_prev_[e] > 0 ? bdf2(step.dt, dt_prev_[e]) : backward_euler(step.dt); }

  void find_integrators() {
    std::vector<Index> by = model_.block_env.download();
    for (const model::Body& body : model_.bodies)
      for (Index b = body.block_begin; b < body.block_end && body.prescribed(); ++b) by[b] += model_.envs;
    by_.upload(by);
  }

  void find_pairs() {
    const auto row = model_.mass.row_offset.download(), column = model_.mass.column.download();
    const auto value = model_.mass.value.download();
    const auto env = model_.block_env.download();
    const std::vector<std::uint8_t> lumped = lumped_blocks();
    std::vector<MassPair> pairs;
    std::vector<Index> counts, pair_env;
    for (Index i = 0; i < model_.blocks; ++i) {
      double sum = 0;
      for (Index k = row[i]; k < row[i + 1]; ++k) sum += value[k];
      for (Index k = row[i]; k < row[i + 1]; ++k) {
        const Index j = column[k];
        if (j < i || value[k] == 0 || (lumped[i] && j != i)) continue;
        pairs.push_back({i, j, lumped[i] ? sum : value[k]});
        counts.push_back(i == j ? 1 : 2);
        pair_env.push_back(env[i]);
      }
    }
    counts.push_back(0);
    env_offset_ = env_offsets(pair_env, model_.envs);
    pairs_.upload(pairs);
    counts_.upload(counts);
  }

  // Blocks of bodies of linear tetrahedra that supports keep from turning: with masses on nodes matrices have a fifth less in them.
  std::vector<std::uint8_t> lumped_blocks() const {
    std::vector<std::uint8_t> out(model_.blocks, 0);
    const std::vector<geometry::Midsides> midsides = model_.volume.midsides.download();
    for (const model::Body& body : model_.bodies)
      if (body.stays && (midsides.empty() || midsides[body.tet_begin].v[0] < 0))
        std::fill(out.begin() + body.block_begin, out.begin() + body.block_end, 1);
    return out;
  }

  model::Model& model_;
  bool bdf2_;
  device::Buffer<MassPair> pairs_;
  device::Buffer<Index> counts_;  // blocks of every pair's stencil
  std::vector<Index> env_offset_;

  // Of every environment; and of its prescribed bodies, which go on as before where a step of second order is taken anew by backward Euler: between
  // steps of second order it makes 1/2 and 7/4 of an acceleration.
  std::vector<Integrator> integrator_;
  device::Buffer<Integrator> integrators_;
  device::Buffer<Index> by_;              // which of them every block goes by
  device::Buffer<Vec3> q_hat_, q_begin_;  // of the step under way
  // History: velocity now, positions and velocity one step before, and the length of every environment's last step (0 before the first).
  device::Buffer<Vec3> v_, q_prev_, v_prev_;
  std::vector<double> dt_prev_;
  // Mended by a share: accelerations of the leader's last steps, of how many there are, and what velocities of the step get besides.
  double mended_ = 0, spread_ = 0;
  device::Buffer<Vec3> a_, a_prev_, more_;
  int known_ = 0;
};

}  // namespace

const Kind& inertia_kind() {
  static const Kind kind{"inertia",
                         Role::inertia,
                         "bodies resist acceleration (backward Euler or BDF2)",
                         &kTable,
                         [](const Params& p, model::Model& m) -> std::unique_ptr<Effect> { return std::make_unique<Inertia>(p, m); },
                         {"Hairer, Wanner: Solving Ordinary Differential Equations II. Springer, 1996 (variable-step BDF2)"},
                         {"velocity"}};
  return kind;
}

const Kind& Inertia::kind() const { return inertia_kind(); }

}  // namespace mortise::effects
