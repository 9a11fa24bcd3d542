// Systems with the whole Jacobian of a solution, and with its transpose.
#include "solver/tangent.h"

#include <gtest/gtest.h>

#include <random>

#include "solver/kernels.h"
#include "toy.h"

using namespace mortise;
using namespace mortise::solver;

namespace {

const Vec3 kLeft(0.7, -0.2, 1.1), kRight(-0.3, 0.9, 0.4);

// grad = K d + l (r . d) at every block: a force that has no energy.
class Unsymmetric final : public effects::Effect {
 public:
  Unsymmetric(const effects::Kind& kind, model::Model& model, Mat3 K, bool complete)
      : complete_(complete),
        field_(kind, model,
               {[](Index, const Vec3&, const Vec3&) { return 0.0; }, [K](Index, const Vec3& d) -> Vec3 { return K * d + kLeft * kRight.dot(d); },
                [K](Index, const Vec3&) { return K; }}) {}
  const effects::Kind& kind() const override { return field_.kind(); }
  std::unique_ptr<effects::Linearisation> linearisation() const override { return field_.linearisation(); }
  void linearise(effects::Positions q, effects::Want want, effects::Linearisation& at) override {
    field_.linearise(q, want, at);
    const Index blocks = at.stencils.blocks().n;
    at.unsymmetric.resize(want.whole ? 1 : 0, blocks);
    if (!want.whole) return;
    at.unsymmetric.left.upload(std::vector<Vec3>(blocks, kLeft));
    at.unsymmetric.right.upload(std::vector<Vec3>(blocks, kRight));
  }
  void energy(effects::Positions, const effects::Linearisation&, device::EnvValues) override {}
  bool complete(const effects::Linearisation&) const override { return complete_; }

 private:
  bool complete_;
  toy::Field field_;
};

std::vector<Vec3> random_forces(Index n, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<Vec3> out(n);
  for (Vec3& f : out)
    for (int k = 0; k < 3; ++k) f[k] = normal(random);
  return out;
}

// Of which symmetric part, where the effect says that H + U is all, or not.
void solves_both(const Mat3& K, bool complete) {
  static const toy::Kind kind = toy::kind("toy_unsymmetric", toy::Role::contact, false);
  toy::Problem p;
  p.effects.push_back(std::make_unique<Unsymmetric>(kind, p.model, K, complete));
  Newton newton(p.model, p.effects, p.options, p.clock);
  System& system = newton.system();
  system.begin_solve();
  Tangent tangent(system);
  tangent.linearise(p.model.q);
  ASSERT_EQ(tangent.assembled(), complete);
  const std::vector<Vec3> f = random_forces(system.rows.count(), 3);
  const device::Buffer<Vec3> force(f);
  device::Buffer<Vec3> x;
  tangent.solve(force.view(), false, x);
  const Mat3 J = K + kLeft * kRight.transpose();
  double tolerance = complete ? 1e-9 : 1e-5;
  const std::vector<Vec3> found = x.download();
  for (std::size_t i = 0; i < f.size(); ++i) EXPECT_LT((found[i] - J.inverse() * f[i]).norm(), tolerance * f[i].norm());
  tolerance = 1e-9;  // of what is assembled, which here is all
  tangent.solve(force.view(), true, x);
  const std::vector<Vec3> adjoint = x.download();
  for (std::size_t i = 0; i < f.size(); ++i) EXPECT_LT((adjoint[i] - J.transpose().inverse() * f[i]).norm(), tolerance * f[i].norm());
}

const Mat3 kStiff = (Mat3() << 4, 1, 0, 1, 5, -1, 0, -1, 3).finished();

}  // namespace

TEST(Tangent, SolvesWithTheJacobianAndItsTranspose) { solves_both(kStiff, true); }

// Where the Hessian has no factor the shifted, or a convex one, serves: here none is convex.
TEST(Tangent, SaysWhereThereIsNoFactor) {
  toy::Problem p;
  const toy::Kind kind = toy::kind("toy_concave", toy::Role::contact);
  p.effects.push_back(std::make_unique<Unsymmetric>(kind, p.model, -kStiff, true));
  Newton newton(p.model, p.effects, p.options, p.clock);
  newton.system().begin_solve();
  Tangent tangent(newton.system());
  EXPECT_THROW(tangent.linearise(p.model.q), Failure);
}

// Where something is missing from H + U products are differences of forces.
TEST(Tangent, TakesDifferencesOfForcesWhereSomethingIsMissing) { solves_both(kStiff, false); }
