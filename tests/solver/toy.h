#pragma once
// Effects with plain formulas, under names of their own, on soft boxes of which every node is a block: what strategies of the solver are tried on.
#include <functional>

#include "effects/list.h"
#include "scene_builder.h"
#include "solver/newton.h"

namespace mortise::toy {

using effects::Kind;
using effects::Linearisation;
using effects::Positions;
using effects::Role;
using effects::Want;
using mortise::solver::EffectList;
using mortise::solver::Options;

// One tetrahedron per environment: four blocks each.
inline model::ModelInput boxes(int envs) {
  model::ModelInput in;
  in.scene = Params::make_table();
  for (int e = 0; e < envs; ++e) {
    geometry::TetMesh mesh;
    mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.tets = {{{0, 1, 2, 3}}};
    in.bodies.push_back(testing::soft_body("body", mesh, testing::material("linear", 1e5, 0.3, 1000)));
    in.bodies.back().env = e;
  }
  return in;
}

// Per block an energy, its gradient and its Hessian at q, d = q - rest, where d0 is that of the state that is frozen; env says whose block it is.
// All on the host.
struct Law {
  std::function<double(Index env, const Vec3& d, const Vec3& d0)> energy;
  std::function<Vec3(Index env, const Vec3& d)> gradient;
  std::function<Mat3(Index env, const Vec3& d)> hessian;
};

struct FieldLinearisation final : Linearisation {
  std::vector<Vec3> x;
};

class Field final : public effects::Effect {
 public:
  Field(const Kind& kind, model::Model& model, Law law)
      : kind_(kind), model_(model), law_(std::move(law)), rest_(model.rest.download()), env_(model.block_env.download()) {}
  const Kind& kind() const override { return kind_; }
  bool loses_energy() const override { return kind_.role == Role::inertia; }
  std::unique_ptr<Linearisation> linearisation() const override { return std::make_unique<FieldLinearisation>(); }
  void linearise(Positions q, Want want, Linearisation& at) override {
    const std::vector<Vec3> x = static_cast<FieldLinearisation&>(at).x = host(q);
    if (!want.forces) return;
    at.stencils.resize_uniform(model_.blocks, 1);
    at.stencils.need_hessian();
    std::vector<Index> block;
    std::vector<Vec3> grad;
    std::vector<Mat3> hess;
    for (Index b = 0; b < model_.blocks; ++b) {
      block.push_back(b);
      grad.push_back(law_.gradient(env_[b], x[b] - rest_[b]));
      hess.push_back(law_.hessian(env_[b], x[b] - rest_[b]));
    }
    const linalg::StencilView v = at.stencils.view();
    device::copy_in(v.block.p, block.data(), block.size() * sizeof(Index));
    device::copy_in(v.grad.p, grad.data(), grad.size() * sizeof(Vec3));
    device::copy_in(v.hess.p, hess.data(), hess.size() * sizeof(Mat3));
    if (!at.shaped) at.stencils.pattern_changed(), at.shaped = true;
    at.unsymmetric.resize(want.moving.wanted ? 3 : 0, model_.blocks);
    if (!want.moving.wanted) return;
    // What the Hessian lacks of the gradient's derivative.
    std::vector<Vec3> left, right;
    for (int c = 0; c < 3; ++c)
      for (Index b = 0; b < model_.blocks; ++b) {
        const Vec3 d = x[b] - rest_[b], step = 1e-9 * Vec3::Unit(c);
        left.push_back((law_.gradient(env_[b], d + step) - law_.gradient(env_[b], d - step)) / 2e-9 - hess[b].col(c));
        right.push_back(Vec3::Unit(c));
      }
    at.unsymmetric.left.upload(left), at.unsymmetric.right.upload(right);
  }
  void energy(Positions q, const Linearisation& frozen, device::EnvValues out) override {
    const std::vector<Vec3> x = host(q), &x0 = static_cast<const FieldLinearisation&>(frozen).x;
    for (Index b = 0; b < model_.blocks; ++b) out.value[env_[b]] += law_.energy(env_[b], x[b] - rest_[b], x0[b] - rest_[b]);
  }

 private:
  static std::vector<Vec3> host(Positions q) {
    std::vector<Vec3> out(q.n);
    device::copy_out(out.data(), q.p, q.n * sizeof(Vec3));
    return out;
  }
  const Kind& kind_;
  model::Model& model_;
  Law law_;
  std::vector<Vec3> rest_;
  std::vector<Index> env_;
};

inline Kind kind(const char* name, Role role, bool symmetric = true) { return {name, role, "", nullptr, nullptr, {}, {}, {}, symmetric, false}; }

// k/2 |d|^2 - f . d
inline Law spring(std::function<double(Index)> k, std::function<Vec3(Index)> f) {
  return {[=](Index e, const Vec3& d, const Vec3&) { return 0.5 * k(e) * d.squaredNorm() - f(e).dot(d); },
          [=](Index e, const Vec3& d) -> Vec3 { return k(e) * d - f(e); }, [=](Index e, const Vec3&) -> Mat3 { return k(e) * Mat3::Identity(); }};
}

inline Options options() {
  Options o;
  o.dt = 1;
  return o;
}

// A model with the effects in it, and what a solver needs besides.
struct Problem {
  model::Model model;
  EffectList effects;
  Options options = toy::options();
  solver::Clock clock;
  explicit Problem(int envs = 1) : model(boxes(envs)) {}
  void add(const Kind& kind, Law law) { effects.push_back(std::make_unique<Field>(kind, model, std::move(law))); }
  std::vector<Vec3> moved(const device::Buffer<Vec3>& q) const {
    std::vector<Vec3> d = q.download(), rest = model.rest.download();
    for (std::size_t b = 0; b < d.size(); ++b) d[b] -= rest[b];
    return d;
  }
};

}  // namespace mortise::toy
