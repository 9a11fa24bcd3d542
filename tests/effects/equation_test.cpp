// Equations of joints' coordinates: derivatives by differences, on hinges with and without a body in common, racks and slides on free bodies.
#include "effects/joint/equation.h"

#include <gtest/gtest.h>

#include <random>

#include "finite_difference.h"

using namespace mortise;
using namespace mortise::fd;
using effects::joint::Equation;

namespace {

constexpr int kBlocks = 12;  // of three bodies: (p, a1, a2, a3) each

struct EquationProblem {
  Equation e;
  Vector q = Vector::Zero(3 * kBlocks);

  EquationProblem(bool x_slides, bool two, bool y_slides, bool common, double strain, unsigned seed) {
    std::mt19937_64 rng(seed);
    std::normal_distribution<double> n;
    const auto any = [&] { return Vec3(n(rng), n(rng), n(rng)); };
    for (int body = 0; body < 3; ++body) {
      const Mat3 A = Eigen::AngleAxisd(n(rng), any().normalized()).toRotationMatrix();
      q.segment<3>(12 * body) = any();
      for (int k = 0; k < 3; ++k) q.segment<3>(12 * body + 3 * (k + 1)) = Vec3(A.col(k)) + strain * any();
    }
    const auto coordinate = [&](bool slides, Index child, Index parent) {
      model::Coordinate c;
      c.slides = slides, c.slider = child, c.carrier = parent, c.carried_freely = slides && parent >= 0;
      c.u = any().normalized(), c.X = any();
      if (!slides) c.hinge = model::hinge_about(c.u, child + 1, parent < 0 ? -1 : parent + 1), c.slider = -1, c.u = c.X = Vec3::Zero();
      return c;
    };
    e.x = coordinate(x_slides, 4, 0);
    if (two) e.y = coordinate(y_slides, 8, common ? 0 : -1);
    e.two = two, e.ratio = -1.7, e.offset = 0.3, e.lambda = 2 * n(rng), e.K = 5;
    e.x.before = model::coordinate(e.x, read(q).x);
    if (two) e.y.before = model::coordinate(e.y, read(q).y);
  }
  effects::joint::EquationReading read(const Vector& x) const {
    const std::vector<Vec3> blocks = blocks_of(x);
    return effects::joint::reading(e, {blocks.data(), kBlocks});
  }
  double energy(const Vector& x) const { return effects::joint::energy(e, read(x)); }
  std::pair<Vector, Matrix> stencil(const Vector& x, double concave) const {
    constexpr int n = effects::joint::kEquationBlocks;
    Index block[n];
    Vec3 grad[n];
    std::vector<Mat3> hess(n * (n + 1) / 2);
    effects::joint::equation_stencil(e, read(x), concave, block, grad, hess.data());
    std::pair<Vector, Matrix> out{Vector::Zero(x.size()), Matrix::Zero(x.size(), x.size())};
    for (Index a = 0; a < n; ++a) {
      if (block[a] < 0) continue;
      out.first.segment<3>(3 * block[a]) += grad[a];
      for (Index b = a; b < n; ++b) {
        if (block[b] < 0) continue;
        const Mat3& h = hess[linalg::pair_place(a, b, n)];
        out.second.block<3, 3>(3 * block[a], 3 * block[b]) += h;
        if (a != b) out.second.block<3, 3>(3 * block[b], 3 * block[a]) += h.transpose();
      }
    }
    return out;
  }
};

}  // namespace

TEST(JointEquations, DerivativesAreExact) {
  for (int what = 0; what < 16; ++what)
    for (double strain : {0.0, 0.1})
      for (unsigned seed : {1u, 2u, 3u, 4u}) {
        const bool x_slides = what & 1, two = what & 2, y_slides = what & 4, common = what & 8;
        if (!two && (y_slides || common)) continue;
        const EquationProblem p(x_slides, two, y_slides, common, strain, 100 * what + seed);
        const auto r = p.read(p.q);
        if (!x_slides && std::hypot(model::sine(r.x), model::cosine(r.x)) < 0.5) continue;  // a collapsed body: differences lose their digits
        const auto [g, H] = p.stencil(p.q, 1);
        EXPECT_LT(relative_error(g, difference_gradient([&](const Vector& x) { return p.energy(x); }, p.q, 3e-4)), 1e-7) << what << " " << seed;
        EXPECT_LT(relative_error(H, difference_jacobian([&](const Vector& x) { return p.stencil(x, 1).first; }, p.q, 3e-4)), 1e-7)
            << what << " " << seed;
        EXPECT_GT(lowest_eigenvalue(p.stencil(p.q, 0).second), -1e-11 * H.norm()) << what << " " << seed;
        // What acts on one body acts back on others: no force, and no moment, unless the world bears it.
        if (two && !common) continue;
        Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
        for (int b = 0; b < kBlocks; ++b) {
          if (b % 4 == 0) force += Vec3(g.segment<3>(3 * b));
          moment += Vec3(p.q.segment<3>(3 * b)).cross(Vec3(g.segment<3>(3 * b)));
        }
        EXPECT_LT(force.norm(), 1e-12 * g.norm());
        EXPECT_LT(moment.norm(), 1e-12 * g.norm() * p.q.norm());
      }
}

// A way that turns a hinge by less than can be counted is not cut; one that turns it further is.
TEST(JointEquations, WayKeepsTurnsCountable) {
  for (unsigned seed = 1; seed < 60; ++seed) {
    const EquationProblem p(false, true, false, true, 0.05, seed);
    std::mt19937_64 rng(seed);
    std::normal_distribution<double> n;
    Vector w(p.q.size());
    for (Eigen::Index k = 0; k < w.size(); ++k) w[k] = 2 * n(rng);
    const std::vector<Vec3> way = blocks_of(w);
    const double alpha = effects::joint::equation_way(p.e, p.read(p.q), effects::joint::reading(p.e, {way.data(), kBlocks}, true));
    ASSERT_GT(alpha, 0);
    double x = p.e.x.before, y = p.e.y.before;  // followed along the way
    for (int k = 1; k <= 400; ++k) {
      const auto r = p.read(p.q + std::min(alpha, 1.0) * k / 400 * w);
      x = model::unwrapped(model::hinge_angle(r.x), x), y = model::unwrapped(model::hinge_angle(r.y), y);
      EXPECT_NEAR(model::coordinate(p.e.x, r.x), x, 1e-9);
      EXPECT_NEAR(model::coordinate(p.e.y, r.y), y, 1e-9);
    }
  }
}
