// friction: the law, its derivatives through the whole effect, what it follows, and what it reports.
#include <gtest/gtest.h>

#include "base/error.h"
#include "contact_scene.h"
#include "effects/contact/barrier.h"
#include "effects/friction/law.h"

using namespace mortise;
using namespace mortise::testing;
using effects::friction::f0;
using effects::friction::f1_over_x;
using effects::friction::hessian;

namespace {

constexpr double kHat = 0.05, kKappa = 1e4, kCreep = 0.1, kDt = 0.01, kMu = 0.4;
const effects::StepInfo kStep{0, kDt, 0, false};

Params friction_params(double mu = kMu) {
  Params p = Params::make_table();
  p.set("follows", Params::make_text("barrier_contact"));
  p.set("mu", Params::make_number(mu));
  p.set("creep_speed", Params::make_number(kCreep));
  return p;
}

// A block 0.6 d_hat over another one, or over a half-space.
model::ModelInput block(bool on_plane, bool stiff) {
  model::ModelInput in;
  in.scene = Params::make_table();
  const auto mesh = geometry::box({1, 1, 0.5}, std::array<Index, 3>{2, 2, 1});
  const Vec3 up(0.05, 0.03, 0.5 + 0.6 * kHat);
  if (on_plane)
    in.bodies.push_back(half_space("floor", {0, 0, 0.25}, {0, 0, 1}));
  else
    in.bodies.push_back(soft_body("pad", geometry::box({1, 1, 0.5}, std::array<Index, 3>{3, 3, 1}), gel()));
  in.bodies.push_back(stiff ? stiff_body("block", mesh, gel(), up) : soft_body("block", mesh, gel(), up));
  return in;
}

struct Problem {
  model::Model model;
  std::unique_ptr<fd::Subject> contact, friction;
  explicit Problem(bool on_plane, bool stiff = false, Params params = friction_params())
      : model(block(on_plane, stiff)),
        contact(make_effect("barrier_contact", contact_params(kHat, kKappa), model)),
        friction(make_effect("friction", params, model)) {
    contact->begin_step(kStep);
    friction->begin_step(kStep);
    lag();
  }
  void lag() { friction->effect->lag(contact->here().contact, friction->here()); }
  // The state x is accepted, and a new step begins.
  void accept(const fd::Vector& x) {
    const device::Buffer<Vec3> q(fd::blocks_of(x));
    contact->freeze(q.view());
    lag();
    friction->end_step(q.view());
    model.q.copy_from(q);
    contact->begin_step(kStep);
    friction->begin_step(kStep);
    contact->freeze(q.view());
    lag();
  }
  // The block moved by d, all else at rest.
  fd::Vector moved(const Vec3& d) const {
    fd::Vector x = positions(model);
    const model::Body& b = model.bodies.back();
    for (Index i = b.block_begin; i < (b.type == model::BodyType::soft ? b.block_end : b.block_begin + 1); ++i) x.segment<3>(3 * i) += d;
    return x;
  }
  Vec3 force_on_block(const fd::Vector& x) {
    const auto g = fd::effect_assemble(*friction, x, false).gradient;
    const model::Body& b = model.bodies.back();
    Vec3 f = Vec3::Zero();
    for (Index i = b.block_begin; i < (b.type == model::BodyType::soft ? b.block_end : b.block_begin + 1); ++i) f -= g.segment<3>(3 * i);
    return f;
  }
  // With the samples of x itself.
  fd::Vector fresh_force(const fd::Vector& x) {
    const device::Buffer<Vec3> q(fd::blocks_of(x));
    contact->freeze(q.view());
    lag();
    return fd::effect_assemble(*friction, x, false).gradient;
  }
  // d fresh_force / dx as it is assembled: the symmetric part and the pieces beside it.
  fd::Matrix jacobian(const fd::Vector& x) {
    const device::Buffer<Vec3> q(fd::blocks_of(x));
    contact->freeze(q.view());
    contact->effect->sample_changes(contact->here());
    lag();
    const effects::Curvature exact(true, 1);
    fd::Matrix J = fd::effect_assemble(*friction, x, exact).hessian;
    effects::Linearisation& at = friction->here();
    friction->effect->linearise(q.view(), {true, exact, true}, at);
    for (const bool transposed : {false, true}) {
      fd::Matrix U(x.size(), x.size());
      for (Eigen::Index i = 0; i < x.size(); ++i) {
        const device::Buffer<Vec3> d(fd::blocks_of(fd::Vector::Unit(x.size(), i)));
        linalg::multiply(at.unsymmetric, transposed, d.view(), at.stencils);
        const linalg::StencilView s = at.stencils.view();
        const auto block = fd::fetch(s.block);
        const auto piece = fd::fetch(s.grad);
        U.col(i).setZero();
        for (std::size_t k = 0; k < block.size(); ++k) U.col(i).segment<3>(3 * block[k]) += piece[k];
      }
      if (!transposed) {
        J += U;
        kept_ = U;
      } else {
        EXPECT_LT((U - kept_.transpose()).norm(), 1e-14 * U.norm());
      }
    }
    return J;
  }
  fd::Matrix kept_;
  double normal_force() const { return kKappa * effects::barrier::phi(0.6); }  // on the unit square, if the blocks were aligned
};

}  // namespace

TEST(FrictionLaw, IsSmoothAndSlopesToOne) {
  const double e = 0.3, h = 1e-5;
  for (double x : {0.01, 0.1, 0.29, 0.31, 2.0}) {
    EXPECT_NEAR((f0(x + h, e) - f0(x - h, e)) / (2 * h), x * f1_over_x(x, e), 1e-8);
    if (x < e) {
      EXPECT_NEAR(x * f1_over_x(x, e), 2 * (x / e) - (x / e) * (x / e), 1e-14);
    } else {
      EXPECT_DOUBLE_EQ(x * f1_over_x(x, e), 1);
    }
  }
  EXPECT_DOUBLE_EQ(f0(e, e), e);
  EXPECT_GT(f0(0, e), 0);
}

// With no share of its softening, the Hessian is that of a paraboloid which touches f0(|v|) at u and lies above it everywhere: with the whole share
// it is the second derivative, which lies below past the turn from slip to stick.
TEST(FrictionLaw, TheMajorantLiesAbove) {
  const double e = 0.3;
  const Vec3 n = Vec3(1, 2, -1).normalized(), a = n.unitOrthogonal(), b = n.cross(a);
  bool exact_is_below = false;
  for (double x : {1e-3, 0.1, 0.29, 0.31, 2.0, 50.0}) {
    const Vec3 u = x * (0.6 * a + 0.8 * b), slope = f1_over_x(x, e) * u;
    const Mat3 K = hessian(u, n, e, 0), exact = hessian(u, n, e, 1);
    for (int i = -12; i <= 12; ++i)
      for (int j = -12; j <= 12; ++j) {
        const double scale = i % 2 ? 0.1 * e : x;
        const Vec3 v = scale * (0.5 * i * a + 0.5 * j * b), d = v - u;
        const double here = f0(x, e) + slope.dot(d), rounding = 1e-13 * (f0(v.norm(), e) + x);
        EXPECT_GE(here + 0.5 * d.dot(K * d), f0(v.norm(), e) - rounding) << x << " " << i << " " << j;
        exact_is_below = exact_is_below || here + 0.5 * d.dot(exact * d) < f0(v.norm(), e) - 0.1 * x;
      }
  }
  EXPECT_TRUE(exact_is_below);
}

// Benchmark B16: on an incline of 26.565 degrees a block that sticks creeps at eps_v (1 - sqrt(1 - tan(theta)/mu)).
TEST(Friction, StickingCreepsAsTheLawSays) {
  const double tangent = std::tan(26.565 * EIGEN_PI / 180);
  const double table[][2] = {{0.5, .9985}, {0.6, .5917}, {0.8, .3876}};
  for (const auto& [mu, share] : table) {
    Problem p(true, true, friction_params(mu));
    const double exact = 1 - std::sqrt(1 - tangent / mu), weight = p.normal_force();
    EXPECT_NEAR(exact, share, 2e-4);
    const Vec3 f = p.force_on_block(p.moved(Vec3(exact * kCreep * kDt, 0, 0)));
    EXPECT_NEAR(f.x() / (-weight * tangent), 1, 1e-9) << mu;
    EXPECT_NEAR(f.y(), 0, 1e-9 * weight);
    EXPECT_NEAR(f.z(), 0, 1e-9 * weight);
  }
}

TEST(Friction, SlidingFeelsTheFullForceAndNothingElse) {
  Problem p(true);
  const Vec3 along = Vec3(3, 4, 0) * 10 * kCreep * kDt;
  const Vec3 f = p.force_on_block(p.moved(along));
  EXPECT_NEAR((f + kMu * p.normal_force() * along.normalized()).norm(), 0, 1e-9 * p.normal_force());
  EXPECT_NEAR(p.force_on_block(p.moved(Vec3(0, 0, -0.01))).norm(), 0, 1e-12);  // normal motion is no slip
}

TEST(Friction, DerivativesMatchDifferences) {
  double gradient = 0, hessian = 0;
  for (bool plane : {false, true})
    for (bool stiff : {false, true})
      for (double slip : {0.3, 3.0}) {  // inside and outside the creep distance
        Problem p(plane, stiff);
        const double e = kCreep * kDt;
        const auto x = shaken(p.moved(Vec3(slip * e, 0.5 * slip * e, 0)), 0.1 * e, 4);
        const auto errors = fd::effect_errors(*p.friction, x, 1e-3 * e);
        EXPECT_LT(errors.gradient, 1e-6);
        EXPECT_LT(errors.hessian, 1e-5);
        gradient = std::max(gradient, errors.gradient), hessian = std::max(hessian, errors.hessian);
        const auto d = fd::effect_assemble(*p.friction, x, true);
        EXPECT_GT(d.gradient.norm(), 0);
        EXPECT_GT(fd::lowest_eigenvalue(d.hessian), -1e-12);
        if (plane) continue;
        Vec3 total = Vec3::Zero();
        for (const model::Body& b : p.model.bodies)
          for (Index i = b.block_begin; i < (b.type == model::BodyType::soft ? b.block_end : b.block_begin + 1); ++i)
            total += d.gradient.segment<3>(3 * i);
        EXPECT_LT(total.norm(), 1e-12 * d.gradient.norm());
      }
  std::printf("friction: gradient %.1e hessian %.1e\n", gradient, hessian);
}

// The whole Jacobian: forces with the samples of every state, which slide, turn and press differently, against their differences. At random states
// and at adversarial ones: points over corners and edges, slips within and beyond the creep distance, gaps near nothing and near d_hat.
TEST(Friction, TheWholeJacobianMatchesDifferencesOfForces) {
  double worst = 0;
  for (bool plane : {false, true})
    for (bool stiff : {false, true})
      for (const Vec3& shift : {Vec3(0.013, 0.021, 0), Vec3(3e-4, 2e-4, 0.3 * kHat), Vec3(0.3334, 0.2, 0), Vec3(0.25, 0.125, -0.55 * kHat),
                                Vec3(-0.1667, 0.1667, -0.2 * kHat)})
        for (unsigned seed : {5u, 6u}) {
          Problem p(plane, stiff);
          const fd::Vector x = shaken(p.moved(shift), 0.02 * kHat, seed);
          const fd::Matrix J = p.jacobian(x);
          const fd::Matrix difference = fd::difference_jacobian([&](const fd::Vector& at) { return p.fresh_force(at); }, x, 2e-6 * kHat);
          EXPECT_GT(J.norm(), 0);
          const double error = fd::relative_error(J, difference);
          EXPECT_LT(error, 1e-6) << plane << stiff << " " << shift.transpose() << " seed " << seed;
          worst = std::max(worst, error);
        }
  std::printf("friction, whole Jacobian: %.1e\n", worst);
}

// Where the step ended its force is that of the next one's beginning; what slips drags its anchor along, which holds it wherever it stops.
TEST(Friction, WhatSticksRests) {
  for (bool plane : {false, true})
    for (bool stiff : {false, true}) {
      SCOPED_TRACE(std::string(plane ? "on a plane" : "on a pad") + (stiff ? ", stiff" : ""));
      Problem p(plane, stiff);
      const double e = kCreep * kDt, full = kMu * p.normal_force();
      const fd::Vector stuck = p.moved(Vec3(0.5 * e, 0.2 * e, 0));
      const Vec3 force = p.force_on_block(stuck);
      p.accept(stuck);
      const Vec3 held = p.force_on_block(stuck);
      EXPECT_NEAR((held - force).norm(), 0, (plane ? 1e-9 : 2e-3) * full) << "a pad's rim is pressed otherwise there";
      p.accept(stuck);
      EXPECT_NEAR((p.force_on_block(stuck) - held).norm(), 0, 1e-9 * full) << "nothing relaxes";
      if (!plane) continue;
      const fd::Vector slipped = p.moved(Vec3(0, 5 * e, 0));
      const Vec3 along = Vec3(0.5, 5.2, 0).normalized();
      p.accept(slipped);
      EXPECT_NEAR((p.force_on_block(slipped) + full * along).norm(), 0, 1e-9 * full);
      EXPECT_NEAR(p.force_on_block(p.moved(-e * along)).norm(), 0, 1e-9 * full) << "back by as far as it gave way";
      Recorder r;
      p.friction->report(r);
      const std::vector<double>& slip = r.values["friction/slip"];
      for (std::size_t i = 0; i < slip.size(); i += 3) EXPECT_NEAR(std::abs(slip[i + 1]), 5 * e, 1e-9 * e) << "of the step alone";
      p.accept(p.moved(Vec3(0, 0, 2 * kHat)));
      p.accept(p.moved(Vec3(0, 0, -2 * kHat)));
      EXPECT_NEAR(p.force_on_block(slipped).norm(), 0, 1e-9 * full) << "what touches nothing forgets";
    }
}

// Points far apart that are deflected differently.
TEST(Friction, TheWholeJacobianKnowsAnchors) {
  for (bool plane : {false, true})
    for (bool stiff : {false, true}) {
      Problem p(plane, stiff);
      p.accept(shaken(p.moved(Vec3(0.01, 0.02, 0)), 0.02 * kHat, 7));
      const fd::Vector x = shaken(p.moved(Vec3(0.013, 0.021, 0)), 0.01 * kHat, 8);
      const fd::Matrix difference = fd::difference_jacobian([&](const fd::Vector& at) { return p.fresh_force(at); }, x, 2e-6 * kHat);
      EXPECT_LT(fd::relative_error(p.jacobian(x), difference), 1e-6) << plane << stiff;
    }
}

TEST(Friction, HessianAtRestIsFinite) {
  Problem p(false);
  const auto d = fd::effect_assemble(*p.friction, positions(p.model), true);
  EXPECT_EQ(d.gradient.norm(), 0);
  EXPECT_TRUE(d.hessian.allFinite());
  EXPECT_GT(d.hessian.norm(), 0);
}

// lag() takes over the contact forces of a linearisation; until then they stay.
TEST(Friction, ForcesStayFrozenUntilLag) {
  Problem p(true);
  const fd::Vector pressed = p.moved(Vec3(1, 0, -0.3 * kHat));
  const Vec3 before = p.force_on_block(pressed);
  const device::Buffer<Vec3> q(fd::blocks_of(pressed));
  p.contact->freeze(q.view());
  EXPECT_EQ(p.force_on_block(pressed), before);
  p.lag();
  EXPECT_NEAR(p.force_on_block(pressed).x() / (-kMu * kKappa * effects::barrier::phi(0.3)), 1, 1e-9);
  EXPECT_NEAR(before.x() / (-kMu * p.normal_force()), 1, 1e-9);
}

TEST(Friction, PairsOverrideTheCoefficient) {
  Params params = friction_params();
  Params pair = Params::make_table();
  pair.set("a", Params::make_text("block"));
  pair.set("b", Params::make_text("floor"));
  pair.set("mu", Params::make_number(0.1));
  params.set("pairs", Params::make_list({pair}));
  Problem p(true, false, params);
  EXPECT_NEAR(p.force_on_block(p.moved(Vec3(1, 0, 0))).x() / (-0.1 * p.normal_force()), 1, 1e-9);
}

TEST(Friction, NeedsAContactToFollow) {
  model::Model m(block(true, false));
  const auto friction = make_effect("friction", friction_params(), m);
  EXPECT_THROW(friction->here(), Error);
}

TEST(Friction, ReportsForcesAndDissipation) {
  for (bool plane : {false, true}) {
    Problem p(plane);
    const double slip = 5 * kCreep * kDt;
    const device::Buffer<Vec3> q(fd::blocks_of(p.moved(Vec3(slip, 0, 0))));
    p.friction->end_step(q.view());
    Recorder r;
    p.friction->report(r);
    const Vec3 f = p.force_on_block(p.moved(Vec3(slip, 0, 0)));
    EXPECT_LT(f.x(), 0);
    EXPECT_NEAR(r("friction/force_block_x"), f.x(), 1e-10 * f.norm());
    EXPECT_NEAR(r("friction/dissipation"), -f.x() * slip, 1e-10 * f.norm() * slip);
    EXPECT_NEAR(r("friction/power"), -f.x() * slip / kDt, 1e-8 * f.norm() * slip / kDt);
    double sum = 0;
    for (std::size_t i = 0; i < r.values["friction_force"].size(); i += 3) sum += r.values["friction_force"][i];
    EXPECT_NEAR(sum, plane ? f.x() : 0, 1e-10 * f.norm());
    for (std::size_t i = 0; i < r.values["friction/force"].size() / 3; ++i)  // friction works against slip
      EXPECT_LT(r.values["friction/force"][3 * i] * r.values["friction/slip"][3 * i], 0);
  }
}
