// Newton's loop and its strategies on effects with plain formulas.
#include <gtest/gtest.h>

#include <optional>

#include "solver/kernels.h"
#include "toy.h"

using namespace mortise;
using namespace mortise::solver;
using toy::Law;
using toy::Problem;

namespace {

const toy::Kind kStore = toy::kind("toy_store", toy::Role::contact), kInertia = toy::kind("toy_inertia", toy::Role::inertia),
                kTwisted = toy::kind("toy_twisted", toy::Role::contact, false);
const Vec3 kForce(1, 2, -1);

StepReport solve(Problem& p, Newton& newton) {
  StepReport report;
  const EnvMask all(p.model.envs, 1);
  newton.begin(all);
  newton.solve(
      {0, 1, 0, false}, report, [] {}, all);
  return report;
}

// sqrt(1 + |d|^2) - f . d: far away Newton's step overshoots without end.
Law soft_norm(std::function<Vec3(Index)> f) {
  return {[=](Index e, const Vec3& d, const Vec3&) { return std::sqrt(1 + d.squaredNorm()) - f(e).dot(d); },
          [=](Index e, const Vec3& d) -> Vec3 { return d / std::sqrt(1 + d.squaredNorm()) - f(e); },
          [=](Index, const Vec3& d) -> Mat3 {
            const double s = std::sqrt(1 + d.squaredNorm());
            return Mat3::Identity() / s - d * d.transpose() / (s * s * s);
          }};
}

}  // namespace

TEST(Newton, SolvesASpringInOneIteration) {
  Problem p;
  p.add(kStore, toy::spring([](Index) { return 4.0; }, [](Index) { return kForce; }));
  Newton newton(p.model, p.effects, p.options, p.clock);
  const StepReport report = solve(p, newton);
  EXPECT_EQ(report.newton, 1);
  for (const Vec3& d : p.moved(newton.q())) EXPECT_LT((d - kForce / 4).norm(), 1e-14);
  EXPECT_TRUE(newton.envs().is(0, EnvState::solved));
}

namespace {

// Where inertia would carry blocks: `way` in every environment. Nothing may go farther than `wall` in x.
class Carrier final : public effects::Effect {
 public:
  Carrier(model::Model& model, const std::vector<Vec3>& way, double wall) : model_(model), way_(way), wall_(wall) {
    std::vector<Vec3> to = model.q.download();
    const std::vector<Index> env = model.block_env.download();
    for (std::size_t b = 0; b < to.size(); ++b) to[b] += way[env[b]];
    to_.upload(to);
  }
  const effects::Kind& kind() const override { return kInertia; }
  effects::Positions carried() const override { return to_.view(); }
  void linearise(effects::Positions, effects::Want, effects::Linearisation& at) override { at.stencils.resize_uniform(0, 0); }
  void energy(effects::Positions, const effects::Linearisation&, device::EnvValues) override {}
  void max_step(device::View<const Vec3> dq, effects::Linearisation&, device::EnvValues alpha) override {
    std::vector<Vec3> d(dq.n);
    device::copy_out(d.data(), dq.p, dq.n * sizeof(Vec3));
    const std::vector<Index> env = model_.block_env.download();
    for (std::size_t b = 0; b < d.size(); ++b)
      if (d[b][0] > wall_) alpha.value[env[b]] = std::min(alpha.value[env[b]], wall_ / d[b][0]);
  }

 private:
  model::Model& model_;
  std::vector<Vec3> way_;
  double wall_;
  device::Buffer<Vec3> to_;
};

}  // namespace

// Newton starts where inertia carries an environment, where that is downhill and free: the first
// environment is carried to the answer, the second too far to be lower; alone they take none and one iteration, and a wall on the way forbids it.
TEST(Newton, StartsWhereInertiaCarriesUnlessThatIsWorse) {
  Problem p(2);
  p.add(kStore, toy::spring([](Index) { return 4.0; }, [](Index) { return kForce; }));
  const Vec3 answer = kForce / 4;
  p.effects.push_back(std::make_unique<Carrier>(p.model, std::vector<Vec3>{answer, 2.5 * answer}, 1.0));
  const auto first = [&](Problem& of) {
    Newton newton(of.model, of.effects, of.options, of.clock);
    const StepReport report = solve(of, newton);
    for (const Vec3& d : of.moved(newton.q())) EXPECT_LT((d - answer).norm(), 1e-14);
    return report.newton;
  };
  EXPECT_EQ(first(p), 1);
  Problem alone(1);
  alone.add(kStore, toy::spring([](Index) { return 4.0; }, [](Index) { return kForce; }));
  alone.effects.push_back(std::make_unique<Carrier>(alone.model, std::vector<Vec3>{answer}, 1.0));
  EXPECT_EQ(first(alone), 0);                    // it starts solved
  const auto iterations = [](const Vec3* way) {  // of a problem that takes more of them from far away
    Problem of(1);
    of.options.iterations = 50;
    of.add(kStore, soft_norm([](Index) { return Vec3(0.5, 0, 0); }));
    if (way) of.effects.push_back(std::make_unique<Carrier>(of.model, std::vector<Vec3>{*way}, 100.0));
    Newton newton(of.model, of.effects, of.options, of.clock);
    return solve(of, newton).newton;
  };
  const Vec3 uphill(-30, 0, 0);
  EXPECT_EQ(iterations(&uphill), iterations(nullptr));
  Problem walled(1);
  walled.add(kStore, toy::spring([](Index) { return 4.0; }, [](Index) { return kForce; }));
  walled.effects.push_back(std::make_unique<Carrier>(walled.model, std::vector<Vec3>{answer}, 0.1));
  EXPECT_GT(first(walled), 1);
}

// A support that does work on its way: the potential rises, but less than if only the support moved. In the second environment it would rise more. In
// the third a wall stands in the support's way, not in that of the others: they start at the answer, and it where it was.
TEST(Newton, StartsWithSupportsOnTheirTargets) {
  Problem p(3);
  p.add(kStore, toy::spring([](Index) { return 4.0; }, [](Index) { return kForce; }));
  const Vec3 answer = kForce / 4, behind(0.75, 0.5, -0.25);  // lower too
  p.effects.push_back(std::make_unique<Carrier>(p.model, std::vector<Vec3>{answer, 2.5 * answer, answer}, 0.7));
  std::vector<Mat3> projector = p.model.projector.download();
  std::vector<Vec3> target = p.model.target.download();
  for (const Index b : {0, 4, 8}) p.model.held[b] = 2, projector[b].setZero(), target[b] += b == 8 ? behind : -10 * answer;
  p.model.projector.upload(projector);
  p.model.target.upload(target);
  Newton newton(p.model, p.effects, p.options, p.clock);
  const EnvMask all(3, 1);
  std::vector<StepReport> report(3);
  newton.begin(all);
  newton.solve(
      {0, 1, 0, false}, report, [] {}, all);
  EXPECT_EQ(report[0].newton, 0);
  EXPECT_EQ(report[1].newton, 1);
  EXPECT_EQ(report[2].newton, 2);
  const std::vector<Vec3> d = p.moved(newton.q());
  for (Index b = 0; b < 12; ++b) EXPECT_LT((d[b] - (b == 8 ? behind : b % 4 == 0 ? -10 * answer : answer)).norm(), 1e-13) << b;
}

namespace {

// Sees the ways that are asked for.
class Watcher final : public effects::Effect {
 public:
  explicit Watcher(bool& finite) : finite_(finite) {}
  const effects::Kind& kind() const override { return kInertia; }
  void linearise(effects::Positions, effects::Want, effects::Linearisation& at) override { at.stencils.resize_uniform(0, 0); }
  void energy(effects::Positions, const effects::Linearisation&, device::EnvValues) override {}
  void max_step(device::View<const Vec3> dq, effects::Linearisation&, device::EnvValues) override {
    std::vector<Vec3> d(dq.n);
    device::copy_out(d.data(), dq.p, dq.n * sizeof(Vec3));
    for (const Vec3& v : d) finite_ = finite_ && v.allFinite();
  }

 private:
  bool& finite_;
};

}  // namespace

// The host hears that a direction is not finite with how far it may lead: nobody may be asked about one that is not.
TEST(Newton, NobodySeesADirectionThatIsNotFinite) {
  Problem p(2);
  p.options.linear = "direct";
  bool finite = true;
  p.add(kStore, toy::spring([](Index e) { return e == 1 ? 1e-200 : 4.0; }, [](Index e) { return e == 1 ? Vec3(1e150, 0, 0) : kForce; }));
  p.effects.push_back(std::make_unique<Watcher>(finite));
  Newton newton(p.model, p.effects, p.options, p.clock);
  solve(p, newton);
  EXPECT_TRUE(newton.envs().is(0, EnvState::solved));
  ASSERT_TRUE(newton.envs().is(1, EnvState::failed));
  EXPECT_EQ(newton.envs()[1].reason, "the Newton direction is not finite");
  EXPECT_TRUE(finite);
}

// Linear, reuse and cg give every environment the bits that it has alone, however many iterations the others need, and one that fails leaves
// the others alone.
TEST(Newton, EnvironmentsDoNotKnowEachOther) {
  const std::vector<Vec3> force{{0.99, 0, 0}, {0.3, 0.1, 0}, {2, 0, 0}, {0, 0.95, 0.1}};  // |f| > 1 has no minimum
  for (const char* linear : {"direct", "reuse", "cg"}) {
    const auto run = [&](std::vector<Index> which) {
      Problem p(static_cast<int>(which.size()));
      p.options.linear = linear;
      p.options.iterations = 40;
      p.add(kStore, soft_norm([&force, which](Index e) { return force[which[e]]; }));
      Newton newton(p.model, p.effects, p.options, p.clock);
      std::vector<std::vector<Vec3>> out(which.size());
      try {
        solve(p, newton);
      } catch (const Failure&) {
        return out;
      }
      const std::vector<Vec3> d = newton.q().download();
      for (std::size_t e = 0; e < which.size(); ++e) {
        if (newton.envs().is(static_cast<Index>(e), EnvState::solved)) out[e].assign(d.begin() + 4 * e, d.begin() + 4 * (e + 1));
      }
      return out;
    };
    const auto together = run({0, 1, 2, 3});
    EXPECT_TRUE(together[2].empty()) << "has no minimum";
    for (Index e : {0, 1, 3}) {
      ASSERT_FALSE(together[e].empty()) << linear << " " << e;
      EXPECT_EQ(together[e], run({e})[0]) << linear << " " << e;
    }
  }
}

namespace {

// Of how many environments its energies and forces were asked for, question by question.
class Asked final : public effects::Effect {
 public:
  explicit Asked(model::Model& model, std::vector<Index>& times) : model_(model), times_(times) {}
  const effects::Kind& kind() const override { return kStore; }
  void linearise(effects::Positions, effects::Want, effects::Linearisation& at) override { at.stencils.resize_uniform(0, 0), note(); }
  void energy(effects::Positions, const effects::Linearisation&, device::EnvValues) override { note(); }

 private:
  void note() {
    for (Index e = 0; e < model_.envs; ++e) times_[e] += model_.works_on(e);
  }
  model::Model& model_;
  std::vector<Index>& times_;
};

}  // namespace

// What has settled is left out while others go on: everyone is asked about as often as alone, but for once more, when all have settled.
TEST(Newton, SettledEnvironmentsAreLeftOut) {
  const std::vector<Vec3> force{{0.99, 0, 0}, {0.1, 0, 0}, {0.999, 0, 0}};
  const auto asked = [&](std::vector<Index> which) {
    Problem p(static_cast<int>(which.size()));
    p.options.iterations = 100;
    std::vector<Index> times(which.size(), 0);
    p.add(kStore, soft_norm([&force, which](Index e) { return force[which[e]]; }));
    p.effects.push_back(std::make_unique<Asked>(p.model, times));
    Newton newton(p.model, p.effects, p.options, p.clock);
    solve(p, newton);
    EXPECT_TRUE(p.model.at_work.empty());
    return times;
  };
  const std::vector<Index> together = asked({0, 1, 2});
  EXPECT_GT(together[2], 3 * together[1] / 2);
  for (Index e : {0, 1, 2}) {
    const Index alone = asked({e})[0];
    EXPECT_GE(together[e], alone) << e;
    EXPECT_LE(together[e], alone + 2) << e;
  }
}

// It is put back to where the step began, so that the others' step, and a shorter one of its own, find it there.
TEST(Newton, AFailedEnvironmentStandsWhereTheStepBegan) {
  Problem p(2);
  p.options.iterations = 5;
  p.add(kStore, soft_norm([](Index e) { return e == 0 ? Vec3(0.5, 0, 0) : Vec3(2, 0, 0); }));  // |f| > 1 has no minimum
  Newton newton(p.model, p.effects, p.options, p.clock);
  solve(p, newton);
  ASSERT_TRUE(newton.envs().is(1, EnvState::failed));
  for (int b = 4; b < 8; ++b) EXPECT_EQ(p.moved(newton.q())[b], Vec3::Zero());
}

TEST(Newton, AFailureOfTheOnlyEnvironmentIsThrown) {
  Problem p;
  p.options.iterations = 20;
  p.add(kStore, soft_norm([](Index) { return Vec3(2, 0, 0); }));
  Newton newton(p.model, p.effects, p.options, p.clock);
  EXPECT_THROW(solve(p, newton), Failure);
}

namespace {

// The matrix, k, is only part of the truth: the force turns across d as well, and `more` may be there besides.
Law twisted(
    double k, double w, std::function<Vec3(const Vec3& d)> more = [](const Vec3&) -> Vec3 { return Vec3::Zero(); }) {
  Law law = toy::spring([=](Index) { return k; }, [](Index) { return kForce; });
  law.gradient = [=](Index, const Vec3& d) -> Vec3 { return k * d + w * Vec3(0, 0, 1).cross(d) - kForce + more(d); };
  law.energy = [k, gradient = law.gradient](Index e, const Vec3& d, const Vec3& d0) {
    return gradient(e, d0).dot(d - d0) + 0.5 * k * (d - d0).squaredNorm();
  };
  return law;
}

Vec3 root_of_twisted(double k, double w) {
  const Mat3 J = k * Mat3::Identity() + w * (Mat3() << 0, -1, 0, 1, 0, 0, 0, 0, 0).finished();
  return J.inverse() * kForce;
}

// No force, but blocks may go no farther in one step than `way` while they are inside (or outside) of a sphere.
class Mud final : public effects::Effect {
 public:
  struct Where {
    Vec3 centre;
    double radius, way;
    bool inside;
  };
  Mud(model::Model& model, const Where& where) : where_(where), rest_(model.rest.download()) {}
  const effects::Kind& kind() const override { return kInertia; }
  std::unique_ptr<effects::Linearisation> linearisation() const override { return std::make_unique<toy::FieldLinearisation>(); }
  void linearise(effects::Positions q, effects::Want, effects::Linearisation& at) override {
    at.stencils.resize_uniform(0, 0);
    static_cast<toy::FieldLinearisation&>(at).x = host(q);
  }
  void energy(effects::Positions, const effects::Linearisation&, device::EnvValues) override {}
  void max_step(device::View<const Vec3> dq, effects::Linearisation& at, device::EnvValues alpha) override {
    const std::vector<Vec3> d = host(dq), &x = static_cast<toy::FieldLinearisation&>(at).x;
    for (std::size_t b = 0; b < x.size(); ++b)
      if (((x[b] - rest_[b] - where_.centre).norm() < where_.radius) == where_.inside)
        alpha.value[0] = std::min(alpha.value[0], where_.way / d[b].norm());
  }

 private:
  static std::vector<Vec3> host(device::View<const Vec3> v) {
    std::vector<Vec3> out(v.n);
    device::copy_out(out.data(), v.p, v.n * sizeof(Vec3));
    return out;
  }
  Where where_;
  std::vector<Vec3> rest_;
};

}  // namespace

// The frozen iteration creeps, the coupled one ends it.
TEST(Newton, WholeJacobianEndsCreepingIterations) {
  Problem p;
  p.add(kTwisted, twisted(1, 0.97));
  Newton newton(p.model, p.effects, p.options, p.clock);
  const StepReport report = solve(p, newton);
  EXPECT_GT(report.cg, 0) << "products with the whole Jacobian";
  EXPECT_LT(report.newton, 40);
  const Vec3 exact = root_of_twisted(1, 0.97);
  for (const Vec3& d : p.moved(newton.q())) EXPECT_LT((d - exact).norm(), 1e-5 * exact.norm());
}

// Far from the solution, where steps are short, the coupled iteration gives up; the frozen one creeps nearer, where it is tried again.
TEST(Newton, TheWholeJacobianIsTriedAgainNearer) {
  const Vec3 exact = root_of_twisted(1, 0.97);
  Problem p;
  p.add(kTwisted, twisted(1, 0.97));
  p.effects.push_back(std::make_unique<Mud>(p.model, Mud::Where{exact, 0.05 * exact.norm(), 0.03 * exact.norm(), false}));
  Newton newton(p.model, p.effects, p.options, p.clock);
  const StepReport report = solve(p, newton);
  EXPECT_GT(report.newton, 2 * 20) << "the first try failed";
  EXPECT_LT(report.newton, 100);
  for (const Vec3& d : p.moved(newton.q())) EXPECT_LT((d - exact).norm(), 1e-5 * exact.norm());
}

// Where the step begins forces are small, but the coupled iteration gets nowhere; the frozen one leaves for lower energies, and circles there. The
// coupled one has to begin there then, although forces are larger.
TEST(Newton, TheWholeJacobianIsTriedAgainWhereEnergyIsLowest) {
  const Vec3 exact = root_of_twisted(1, 1);
  const double far = exact.norm(), near = 0.2 * far;
  const auto force = [=](const Vec3& d) -> Vec3 { return (d.norm() < near ? 0.05 : 1) * (d + Vec3(0, 0, 1).cross(d) - kForce); };
  Law law = twisted(1, 1);
  law.gradient = [=](Index, const Vec3& d) { return force(d); };
  law.energy = [=](Index, const Vec3& d, const Vec3& d0) {
    return 0.5 * (d0 - exact).squaredNorm() + force(d0).dot(d - d0) + 0.5 * (d - d0).squaredNorm();
  };
  Problem p;
  p.add(kTwisted, law);
  p.effects.push_back(std::make_unique<Mud>(p.model, Mud::Where{Vec3::Zero(), near, 0.01 * far, true}));
  Newton newton(p.model, p.effects, p.options, p.clock);
  const StepReport report = solve(p, newton);
  EXPECT_GT(report.newton, 20) << "the first try failed";
  for (const Vec3& d : p.moved(newton.q())) EXPECT_LT((d - exact).norm(), 1e-5 * far);
}

// Iterations run around the root on an ellipse that has two of four states nearer to balance; elsewhere forces change so wildly that the coupled
// iteration gets nowhere. It has to begin at the nearest state that was met, not where creeping was seen.
TEST(Newton, TheWholeJacobianBeginsAtTheNearestState) {
  const Vec3 root(-1, 0.25, 0);
  const Mat3 J = (Mat3() << 1, -4, 0, 0.25, 1, 0, 0, 0, 1).finished();  // of e = d - root: e, after an iteration, is (4 y, -x/4, 0)
  Law law = toy::spring([](Index) { return 1.0; }, [](Index) { return Vec3::Zero(); });
  law.gradient = [=](Index, const Vec3& d) -> Vec3 {
    const Vec3 e = d - root;
    Vec3 wild = Vec3::Zero();
    for (const Vec3& at : {Vec3(1, -0.25, 0), Vec3(-1, 0.25, 0), Vec3(1, 0.25, 0)})  // all but (-1, -1/4, 0)
      if ((e - at).norm() < 1e-6) wild -= 100 * (e - at);
    return J * e + wild;
  };
  law.energy = [gradient = law.gradient](Index e, const Vec3& d, const Vec3& d0) {
    return gradient(e, d0).dot(d - d0) + 0.5 * (d - d0).squaredNorm();
  };
  Problem p;
  p.add(kTwisted, law);
  Newton newton(p.model, p.effects, p.options, p.clock);
  const StepReport report = solve(p, newton);
  EXPECT_LT(report.newton, 25) << "twenty until creeping is seen, and one or two from the nearest";
  for (const Vec3& d : p.moved(newton.q())) EXPECT_LT((d - root).norm(), 1e-5);
}

namespace {

// J = H + U with H = 1 and U = -3: its directions go uphill.
class Uphill final : public effects::Effect {
 public:
  explicit Uphill(model::Model& model) : model_(model) {}
  const effects::Kind& kind() const override { return kTwisted; }
  void linearise(effects::Positions, effects::Want want, effects::Linearisation& at) override {
    const Index n = model_.blocks;
    at.stencils.resize_uniform(n, 1);
    at.stencils.need_hessian();
    if (want.whole) at.unsymmetric.resize(3, n);
    const linalg::StencilView v = at.stencils.view();
    const Mat3 H = Mat3::Identity();
    for (Index b = 0; b < n; ++b) {
      device::copy_in(v.block.p + b, &b, sizeof b);
      device::copy_in(v.grad.p + b, &kForce, sizeof kForce);
      device::copy_in(v.hess.p + b, &H, sizeof H);
      for (int c = 0; c < 3 && want.whole; ++c) {
        const Vec3 right = Vec3::Unit(c), left = -3 * right;
        device::copy_in(at.unsymmetric.left.view().p + c * n + b, &left, sizeof left);
        device::copy_in(at.unsymmetric.right.view().p + c * n + b, &right, sizeof right);
      }
    }
    if (!at.shaped) at.stencils.pattern_changed(), at.shaped = true;
  }
  void energy(effects::Positions, const effects::Linearisation&, device::EnvValues) override {}

 private:
  model::Model& model_;
};

}  // namespace

// Where the whole Jacobian points uphill negative curvature is taken out first, and then the symmetric part alone is followed.
TEST(Direction, FollowsTheSymmetricPartWhereTheWholePointsUphill) {
  for (const bool concave : {false, true}) {
    Problem p;
    p.effects.push_back(std::make_unique<Uphill>(p.model));
    System system(p.model, p.effects, p.options, p.clock);
    system.begin_solve();
    const auto linear = make_direct(p.model, system.rows, false);
    linear->begin_solve(true);
    CurvaturePolicy curvature(1);
    if (concave) curvature.choose(0, 1);
    Direction direction(system, *linear, curvature);
    EnvTable envs(1);
    envs[0].whole = true;
    Linearised at = system.potential.linearised();
    const Residual r = system.linearise(std::as_const(p.model.q).view(), direction.want(envs), at);
    StepReport report;
    device::Fetch fetch;
    direction.begin(p.model.q, r, {1e-9}, at, envs, report, fetch);
    fetch.now();
    direction.end(envs);
    EXPECT_LT(direction.slope()[0], 0);
    for (const Vec3& d : direction.way().download()) EXPECT_LT((d + kForce).norm(), 1e-12);
    EXPECT_EQ(report.softened > 0, concave);
  }
}

// A force that jumps over zero has no root, and iterations no end: that is seen long before their limit, once the coupled iteration has failed too.
TEST(Newton, IterationsInACircleAreGivenUp) {
  Problem p;
  p.options.iterations = 1000;
  const Vec3 root = root_of_twisted(1, 1.5);
  p.add(kTwisted, twisted(1, 1.5, [=](const Vec3& d) -> Vec3 { return 0.1 * (d - root).normalized(); }));
  Newton newton(p.model, p.effects, p.options, p.clock);
  try {
    solve(p, newton);
    FAIL() << "solved";
  } catch (const Failure& f) {
    EXPECT_NE(f.reason.find("Newton stopped after "), std::string::npos) << f.reason;
    EXPECT_LT(std::stoi(f.reason.substr(21)), 100) << f.reason;
  }
}

// gain = Phi(q1) - Phi(q0) - grad Phi(q1) . (q1 - q0) - inertia(q1), whatever the effects are called.
TEST(EnergyLedger, GainIsWhatTheIntegratorAdds) {
  const double k = 3, m = 5;
  Problem p;
  p.add(kInertia, toy::spring([=](Index) { return m; }, [](Index) { return Vec3(2, 0, 0); }));  // 1/2 m |d - d_hat|^2 but for a constant
  p.add(kStore, toy::spring([=](Index) { return k; }, [](Index) { return Vec3::Zero(); }));
  Newton newton(p.model, p.effects, p.options, p.clock);
  solve(p, newton);
  const double d = 2 / (k + m), store = 4 * 0.5 * k * d * d, inertia = 4 * (0.5 * m * d * d - 2 * d);
  const StepEnergy& e = newton.energies().of_step(0);
  EXPECT_NEAR(e.gain, store - 2 * store - inertia, 1e-12);
  EXPECT_NEAR(e.there, store, 1e-12);
  EXPECT_TRUE(newton.energies().measures());
}

namespace {

void line_step(LineSearch search, device::Buffer<Vec3>& q, device::Buffer<Vec3>& dq, const std::vector<double>& slope, device::View<const Vec3> c,
               Linearised& at, EnvTable& envs, const StepReports& report, const LineSearch::Forces& forces = {}) {
  device::Fetch fetch;
  search.begin(std::as_const(q).view(), dq, c, at, envs, fetch);
  search.end(q, dq, slope, at, envs, report, forces);
}

// Two environments at rest under a unit spring and a force; dq is Newton's step in the first, `times` that in the second. beside: energy per block
// that does not change [J].
struct Searched {
  explicit Searched(double times, double beside = 0) {
    p.add(kStore, toy::spring([](Index) { return 1.0; }, [](Index) { return kForce; }));
    if (beside > 0)
      p.add(kStore, {[beside](Index, const Vec3&, const Vec3&) { return beside; }, [](Index, const Vec3&) -> Vec3 { return Vec3::Zero(); },
                     [](Index, const Vec3&) -> Mat3 { return Mat3::Zero(); }});
    system.emplace(p.model, p.effects, p.options, p.clock);
    system->begin_solve();
    energies.emplace(p.model, system->potential);
    energies->begin_solve();
    at = system->potential.linearised();
    q.copy_from(p.model.q);
    system->linearise(std::as_const(q).view(), {true, true}, at);
    std::vector<Vec3> d(8, kForce);
    for (int b = 4; b < 8; ++b) d[b] *= times;
    dq.upload(d);
  }
  void step(const std::vector<double>& slope, device::View<const Vec3> c = {}, const LineSearch::Forces& forces = {}) {
    line_step(LineSearch(*system, *energies), q, dq, slope, c, at, envs, report, forces);
  }

  Problem p{2};
  std::optional<System> system;
  std::optional<EnergyLedger> energies;
  Linearised at;
  device::Buffer<Vec3> q, dq;
  EnvTable envs{2};
  StepReport report;
};

}  // namespace

TEST(LineSearch, HalvesUntilArmijoInEveryEnvironmentByItself) {
  Searched s(7);
  s.step(dot(std::as_const(s.at.gradient).view(), std::as_const(s.dq).view(), s.p.model.env_blocks));
  EXPECT_EQ(s.envs[0].alpha, 1);
  EXPECT_EQ(s.envs[1].alpha, 0.25);  // 7/2 still goes up
  EXPECT_EQ(s.report.line_search, 2);
  const auto moved = s.p.moved(s.q);
  EXPECT_LT((moved[0] - kForce).norm(), 1e-15);
  EXPECT_LT((moved[4] - 1.75 * kForce).norm(), 1e-15);
}

// The first goes its full way although its energy rises, as forces are closer to balance there; that the second is halved changes nothing of it.
TEST(LineSearch, AFullStepThatIsCloserStandsWhileOthersAreHalved) {
  Searched s(7);
  s.dq.upload(std::vector<Vec3>(8, 7 * kForce));
  s.envs[0].whole = true;
  LineSearch::Forces forces;
  forces.closer = [](const device::Buffer<Vec3>&, const EnvMask& whose) { return whose; };
  const std::vector<double> slope = dot(std::as_const(s.at.gradient).view(), std::as_const(s.dq).view(), s.p.model.env_blocks);
  s.step(slope, {}, forces);
  EXPECT_EQ(s.envs[0].alpha, 1);
  EXPECT_EQ(s.envs[1].alpha, 0.25);
}

// Far steps after which forces are far from balance are not taken at all.
TEST(LineSearch, AFarStepThatLeadsAstrayIsNotTaken) {
  Searched s(1);
  LineSearch::Forces forces;
  forces.far = {1, 0};
  forces.astray = [](const device::Buffer<Vec3>&, const EnvMask& whose) { return whose; };
  const std::vector<double> slope = dot(std::as_const(s.at.gradient).view(), std::as_const(s.dq).view(), s.p.model.env_blocks);
  s.step(slope, {}, forces);
  EXPECT_EQ(s.envs[0].alpha, 0);
  EXPECT_EQ(s.p.moved(s.q)[0], Vec3::Zero());
  EXPECT_EQ(s.envs[1].alpha, 1) << "a near one is not asked about";
}

// Supports do work: along their way energy rises, and what the merit takes off for their arrival makes up for it.
TEST(LineSearch, SupportsMayRaiseTheEnergy) {
  Problem p;
  p.add(kStore, toy::spring([](Index) { return 4.0; }, [](Index) { return Vec3::Zero(); }));
  System system(p.model, p.effects, p.options, p.clock);
  system.begin_solve();
  EnergyLedger energies(p.model, system.potential);
  energies.begin_solve();
  Linearised at = system.potential.linearised();
  const device::Buffer<Vec3> supports(std::vector<Vec3>(4, kForce));
  device::Buffer<Vec3> q, dq;
  q.copy_from(p.model.q);
  dq.copy_from(supports);
  system.linearise(std::as_const(q).view(), {true, true}, at);
  EnvTable envs(1);
  envs[0].step = kForce.norm();
  StepReport report;
  line_step(LineSearch(system, energies), q, dq, {0.0}, supports.view(), at, envs, report);
  EXPECT_EQ(envs[0].alpha, 1);
}

// What is forgotten of one environment is found again; of the other, what was known stands.
TEST(EnergyLedger, ForgetsOneEnvironmentAlone) {
  Searched s(7);
  const auto find = [&](const device::Buffer<Vec3>& q) {
    device::Fetch fetch;
    s.energies->find(q.view(), s.at, fetch);
    fetch.now();
    return s.energies->sum(s.energies->known());
  };
  const std::vector<double> here = find(s.q);
  std::vector<Vec3> x = s.q.download();
  for (Vec3& p : x) p += kForce;
  const device::Buffer<Vec3> there(x);
  s.energies->forget(0);
  const std::vector<double> after = find(there);
  EXPECT_NEAR(after[0], here[0] - 4 * 0.5 * kForce.squaredNorm(), 1e-12);
  EXPECT_EQ(after[1], here[1]);
}

TEST(LineSearch, FailsWhereNothingDescends) {
  Searched s(-1);  // uphill
  s.step({-24, -24});
  EXPECT_TRUE(s.envs.is(1, EnvState::failed));
  EXPECT_EQ(s.envs[0].alpha, 1);
  EXPECT_LT((s.p.moved(s.q)[0] - kForce).norm(), 1e-15);
  EXPECT_EQ(s.p.moved(s.q)[4], Vec3::Zero());
}

// With 1e18 J beside them, of which 1e5 J are rounding, energies say nothing; the slope along the way does, where it is asked.
TEST(LineSearch, TheSlopeDecidesWhereEnergyIsBlind) {
  for (const bool doubtful : {false, true}) {
    Searched s(7, 1e18);
    LineSearch::Forces forces;
    forces.doubtful.assign(2, doubtful);
    forces.slope = [&](const device::Buffer<Vec3>& trial, const EnvMask&) {
      Linearised there = s.system->potential.linearised();
      s.system->potential.linearise(std::as_const(trial).view(), {}, there);
      return dot(std::as_const(there.gradient).view(), std::as_const(s.dq).view(), s.p.model.env_blocks);
    };
    const std::vector<double> slope = dot(std::as_const(s.at.gradient).view(), std::as_const(s.dq).view(), s.p.model.env_blocks);
    s.step(slope, {}, forces);
    EXPECT_EQ(s.envs[0].alpha, 1);
    EXPECT_EQ(s.envs[1].alpha, doubtful ? 0.25 : 1);  // 7/2 still goes beyond the mirrored start
  }
}

// A wall that the Hessian does not know yet: a support that does most of the moving is let into it, one that hardly moves is not what hits it.
TEST(LineSearch, OnlySupportsThatMoveMostAreLetIntoNewContact) {
  Problem p(2);
  p.add(kStore, {[](Index, const Vec3& d, const Vec3&) {
                   const double in = std::max(0.0, d.x() - 0.1);
                   return 0.5 * d.squaredNorm() - kForce.dot(d) + 1e6 * in * in;
                 },
                 [](Index, const Vec3& d) -> Vec3 { return d - kForce; }, [](Index, const Vec3&) -> Mat3 { return Mat3::Identity(); }});
  System system(p.model, p.effects, p.options, p.clock);
  system.begin_solve();
  EnergyLedger energies(p.model, system.potential);
  energies.begin_solve();
  Linearised at = system.potential.linearised();
  device::Buffer<Vec3> q, dq(std::vector<Vec3>(8, kForce));
  q.copy_from(p.model.q);
  system.linearise(std::as_const(q).view(), {true, true}, at);
  std::vector<Vec3> left(8, kForce);  // of the supports' ways
  for (int b = 4; b < 8; ++b) left[b] *= 0.01;
  const device::Buffer<Vec3> supports(left);
  EnvTable envs(2);
  envs[0].step = envs[1].step = kForce.norm();
  StepReport report;
  const std::vector<double> slope = dot(std::as_const(at.gradient).view(), std::as_const(dq).view(), p.model.env_blocks);
  line_step(LineSearch(system, energies), q, dq, slope, supports.view(), at, envs, report);
  EXPECT_EQ(envs[0].alpha, 0.25);
  EXPECT_EQ(envs[1].alpha, 0.0625);
}

// Aitken's share by hand: r = 1, then -2 with w = 1 gives w = 1/3; in the second environment r = 1, then 1/2 gives more than 1: no relaxation.
TEST(LagLoop, RelaxesEveryEnvironmentByItself) {
  Problem p(2);
  p.add(kStore, toy::spring([](Index) { return 1.0; }, [](Index) { return kForce; }));
  System system(p.model, p.effects, p.options, p.clock);
  system.begin_solve();
  Linearised at = system.potential.linearised(), near = system.potential.linearised();
  LagLoop lag(system, 1e-3, true);
  device::Buffer<Vec3> q;
  q.copy_from(p.model.q);
  lag.begin_solve(q);
  EXPECT_EQ(lag.relative(0), 10 * 1e-3);
  const auto move = [&](double first, double second) {
    std::vector<Vec3> x = p.model.q.download();
    for (int b = 0; b < 8; ++b) x[b] += (b < 4 ? first : second) * Vec3(1, 0, 0);
    q.upload(x);
  };
  move(1, 1);
  lag.relax(q, {1, 1}, near, at);  // the first round is not relaxed: q_lag = q
  EXPECT_NEAR(p.moved(lag.state())[0].x(), 1, 1e-15);
  move(-1, 1.5);
  lag.relax(q, {1, 1}, near, at);
  EXPECT_NEAR(p.moved(lag.state())[0].x(), 1 - 2.0 / 3, 1e-14);
  EXPECT_NEAR(p.moved(lag.state())[4].x(), 1.5, 1e-15);
  lag.refreshed(0, 0.05), lag.refreshed(1, 1e-9);
  EXPECT_EQ(lag.relative(0), 0.1 * 0.05);
  EXPECT_EQ(lag.relative(1), 0.1 * 1e-3);
}

namespace {
const Law kAtan{[](Index, const Vec3&, const Vec3&) { return 0.0; },
                [](Index, const Vec3& d) -> Vec3 {
                  return {std::atan(d.x()), std::atan(d.y()), std::atan(d.z())};
                },
                [](Index, const Vec3& d) -> Mat3 { return (Vec3(1, 1, 1) + d.cwiseProduct(d)).cwiseInverse().asDiagonal(); }};

// The coupled iteration on kAtan, in environments that are stuck `start` from its root; kept: alpha of every step, per environment.
struct Stuck {
  Stuck(Problem& of, const std::vector<Vec3>& start) : p(of), envs(static_cast<Index>(start.size())), alpha(start.size()) {
    System system(p.model, p.effects, p.options, p.clock);
    system.begin_solve();
    const auto linear = make_direct(p.model, system.rows, false);
    linear->begin_solve(true);
    CurvaturePolicy curvature(envs.size());
    linalg::BlockMatrix A;
    Linearised at = system.potential.linearised(), near = system.potential.linearised();
    std::vector<Vec3> x = p.model.q.download();
    for (std::size_t b = 0; b < x.size(); ++b) x[b] += start[b / 4];
    q.upload(x);
    for (Index e = 0; e < envs.size(); ++e) envs[e].state = EnvState::stuck;
    StepReport report;
    const Coupled::Watch watch{[](const Residual&, Index, const EnvMask&) {},
                               [&](const EnvMask& whose, const std::vector<Index>& products) {
                                 for (Index e = 0; e < envs.size(); ++e)
                                   if (whose[e]) alpha[e].push_back(envs[e].alpha);
                                 all_products += *std::max_element(products.begin(), products.end());
                               }};
    Coupled(system, *linear, curvature, A)
        .solve(
            q, 1e-6, at, near, envs, report, [this] { ++asked; }, watch);
  }
  Problem& p;
  device::Buffer<Vec3> q;
  EnvTable envs;
  std::vector<std::vector<double>> alpha;
  Index all_products = 0, asked = 0;  // of all iterations together; how often it asked whether to stop
};

}  // namespace

// atan has no second root, but from 3 Newton's step goes to -9.5, and on from there: the natural level has to fall. In the first environment the
// start is near, and full steps are right.
TEST(Coupled, TakesShareOfStepsThatLowersTheNaturalLevel) {
  Problem p(2);
  p.add(kTwisted, kAtan);
  const Stuck s(p, {Vec3(0.3, 0, 0.1), Vec3(3, 0, -2)});
  EXPECT_TRUE(s.envs.is(0, EnvState::solved));
  EXPECT_TRUE(s.envs.is(1, EnvState::solved));
  EXPECT_EQ(*std::min_element(s.alpha[0].begin(), s.alpha[0].end()), 1);
  EXPECT_LT(*std::min_element(s.alpha[1].begin(), s.alpha[1].end()), 1);
  for (const Vec3& d : p.moved(s.q)) EXPECT_LT(d.norm(), 1e-5);
}

// Every product looks at all forces anew: a run that is asked to stop does not go through a whole iteration's first.
TEST(Coupled, AsksBeforeEveryProductWhetherToStop) {
  Problem p;
  p.add(kTwisted, kAtan);
  const Stuck s(p, {Vec3(0.3, 0, 0.1)});
  ASSERT_TRUE(s.envs.is(0, EnvState::solved));
  EXPECT_EQ(s.asked, static_cast<Index>(s.alpha[0].size()) + 1 + s.all_products);
}

// Where something keeps steps short no solution is near: after three of them it gives up and says so.
TEST(Coupled, GivesUpWhereStepsStayShort) {
  Problem p;
  p.add(kTwisted, kAtan);
  p.effects.push_back(std::make_unique<Carrier>(p.model, std::vector<Vec3>{Vec3::Zero()}, 0.05));
  const Stuck s(p, {Vec3(-1, 0, 0)});
  EXPECT_TRUE(s.envs.is(0, EnvState::stuck));
  EXPECT_EQ(s.alpha[0].size(), 3u);
  for (double a : s.alpha[0]) EXPECT_LT(a, 0.25);
}
