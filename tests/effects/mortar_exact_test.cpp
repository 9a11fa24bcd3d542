// `quadrature: exact`: the barrier over a polygon against its closed form, and what follows from it: forces and energy that do not
// depend on how an overlap is divided.
#include <gtest/gtest.h>

#include <functional>

#include "contact_scene.h"
#include "effects/contact/barrier.h"
#include "effects/mortar_contact/level_rule.h"

using namespace mortise;
using namespace mortise::testing;
using namespace mortise::effects::mortar;

namespace {

using Long = long double;

// F with F'' = b for d_hat = 1, and its derivatives: F = F' = 0 at 1 and beyond.
Long F(Long t) {
  if (t >= 1) return 0;
  return -(t * t * t * t / 12 - t * t * t / 3 + t * t / 2) * std::log(t) + 7 * t * t * t * t / 144 - 5 * t * t * t / 18 + 3 * t * t / 4 -
         11 * t / 18 + Long(13) / 144;
}

// Divided difference F[t0, ..., tn] of distinct nodes.
Long difference(std::vector<Long> t) {
  std::vector<Long> f;
  for (Long x : t) f.push_back(F(x));
  for (std::size_t order = 1; order < t.size(); ++order)
    for (std::size_t i = 0; i + order < t.size(); ++i) f[i] = (f[i + 1] - f[i]) / (t[i + order] - t[i]);
  return f[0];
}

// Mean of b over a triangle with corner gaps t: twice F[t0, t1, t2], since the integral of f'' over the standard simplex is f[t0, t1, t2]
// (Hermite, Genocchi).
double mean_barrier(const double t[3]) { return static_cast<double>(2 * difference({t[0], t[1], t[2]})); }

double by_rule(const double t[3], const std::function<double(double, const double*)>& f) {
  double sum = 0;
  level_rule(t, 1, 1e9, [&](const double* b, double w) { sum += w * f(b[0] * t[0] + b[1] * t[1] + b[2] * t[2], b); });
  return sum;
}
double by_gauss(int n, const double t[3], const std::function<double(double, const double*)>& f) {
  double sum = 0;
  for (int q = 0; q < n; ++q) {
    const TrianglePoint p = triangle_point(n, q);
    sum += p.weight * f(p.b[0] * t[0] + p.b[1] * t[1] + p.b[2] * t[2], p.b);
  }
  return sum;
}
double b(double t, const double*) { return effects::barrier::value(t, 1); }

const double kGaps[][3] = {{0.3, 0.5, 0.7}, {0.7, 0.3, 0.5},    {0.5, 0.7, 0.3},    {0.02, 0.6, 0.4}, {0.9, 1.2, 0.4},
                           {0.2, 1.7, 3.0}, {0.95, 1.05, 0.99}, {0.31, 0.33, 0.30}, {1e-3, 0.9, 0.5}, {0.6, 0.2, 0.9}};

}  // namespace

TEST(LevelRule, IntegratesLinearFunctionsOverEveryTriangle) {
  const double equal[][3] = {{0.4, 0.4, 0.4}, {0.4, 0.4, 0.8}, {0.8, 0.4, 0.4}, {0.4, 0.8, 0.4}, {0.3, 0.3 + 1e-12, 0.3}, {0.5, 0.9, 0.9}};
  const auto check = [](const double t[3]) {
    EXPECT_NEAR(by_rule(t, [](double, const double*) { return 1.0; }), 1, 1e-14);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(by_rule(t, [k](double, const double* b) { return b[k]; }), 1.0 / 3, 1e-14);
  };
  for (const auto& t : kGaps) check(t);
  for (const auto& t : equal) check(t);
}

TEST(LevelRule, BarrierHasItsClosedForm) {
  for (const auto& t : kGaps) {
    const double exact = mean_barrier(t);
    EXPECT_NEAR(by_rule(t, b), exact, 1e-11 * exact + 1e-15) << t[0] << " " << t[1] << " " << t[2];
  }
  // Seven Gauss points are not enough where the gap varies: what the rule is for.
  const double wide[3] = {0.1, 0.8, 0.5};
  EXPECT_GT(std::abs(by_gauss(7, wide, b) / mean_barrier(wide) - 1), 1e-5);
}

// Nodal loads: the derivative of 2 F[t0, t1, t2] by t_k is 2 F[t0, t1, t2, t_k].
TEST(LevelRule, LoadsAreTheDerivativesOfTheClosedForm) {
  for (const auto& t : kGaps)
    for (int k = 0; k < 3; ++k) {
      const double load = by_rule(t, [k](double g, const double* b) { return b[k] * effects::barrier::first(g, 1); });
      const Long h = 1e-5L * t[k];
      std::vector<Long> up{t[0], t[1], t[2]}, down = up;
      up[k] += h, down[k] -= h;
      EXPECT_NEAR(load, static_cast<double>((2 * difference(up) - 2 * difference(down)) / (2 * h)), 1e-7 * std::abs(load));
    }
}

// A quadrilateral with a linear gap, cut along one diagonal or the other.
TEST(LevelRule, DoesNotDependOnTheDivision) {
  const double x[4][2] = {{0, 0}, {1, 0.1}, {1.2, 0.9}, {-0.1, 0.8}};
  double g[4];
  for (int i = 0; i < 4; ++i) g[i] = 0.2 + 0.5 * x[i][0] + 0.15 * x[i][1];
  const auto area = [&](int i, int j, int k) { return ((x[j][0] - x[i][0]) * (x[k][1] - x[i][1]) - (x[k][0] - x[i][0]) * (x[j][1] - x[i][1])) / 2; };
  const auto sum = [&](const std::function<double(const double*)>& mean, int i) {
    const int j = (i + 1) % 4, k = (i + 2) % 4, l = (i + 3) % 4;
    const double one[3] = {g[i], g[j], g[k]}, two[3] = {g[i], g[k], g[l]};
    return area(i, j, k) * mean(one) + area(i, k, l) * mean(two);
  };
  const auto exact = [](const double* t) { return by_rule(t, b); };
  const auto gauss = [](const double* t) { return by_gauss(7, t, b); };
  EXPECT_NEAR(sum(exact, 0), sum(exact, 1), 1e-12 * sum(exact, 0));
  EXPECT_GT(std::abs(sum(gauss, 0) - sum(gauss, 1)), 1e-8 * sum(gauss, 0));
}

namespace {

// Energy [J] of a pad under a tilted tool that has been moved by dx.
double energy(const std::string& quadrature, double dx) {
  Params p = Params::make_table(), pair = Params::make_table(), pairs = Params::make_list();
  pair.set("slave", Params::make_text("pad")), pair.set("master", Params::make_text("tool"));
  pairs.push(pair);
  p.set("pairs", pairs);
  p.set("d_hat", Params::make_number(0.05)), p.set("stiffness", Params::make_number(1e4));
  p.set("weights", Params::make_text("consistent")), p.set("taper_width", Params::make_number(0.1));
  p.set("quadrature", Params::make_text(quadrature)), p.set("gradient", Params::make_text("frozen"));
  p.set("gap", Params::make_text("pointwise"));
  p.set("guard", Params::make_number(0)), p.set("rest_share", Params::make_number(0)), p.set("two_pass", Params::make_flag(false));
  model::ModelInput in;
  in.scene = Params::make_table();
  auto tool = stiff_body("tool", geometry::box({0.5, 0.6, 0.2}, std::array<Index, 3>{3, 2, 1}), gel());
  const Mat3 R = Eigen::AngleAxisd(0.08, Vec3::UnitY()).toRotationMatrix();
  double low = 1e9;
  for (Vec3& x : tool.nodes) x = R * x, low = std::min(low, x.z());
  for (Vec3& x : tool.nodes) x += Vec3(0.013 + dx, 0.02, 0.25 + 0.004 - low);
  in.bodies = {soft_body("pad", geometry::box({1, 1, 0.5}, std::array<Index, 3>{4, 4, 1}), gel()), tool};
  model::Model model(std::move(in));
  const auto contact = make_effect("mortar_contact", p, model);
  contact->begin_step({});
  return contact->energy_now();
}

}  // namespace

// A tilted face that slides over a flat one of other triangles keeps its energy: overlaps are divided anew all the time.
TEST(LevelRule, SlidingOverAFlatFaceCostsNothing) {
  const auto spread = [](const std::string& quadrature) {
    double least = 1e300, most = 0;
    for (int i = 0; i < 12; ++i) {
      const double e = energy(quadrature, 1e-3 * i);
      least = std::min(least, e), most = std::max(most, e);
    }
    return (most - least) / most;
  };
  EXPECT_LT(spread("exact"), 1e-11);
  EXPECT_GT(spread("3"), 1e-6);
}
