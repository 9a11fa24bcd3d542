// What the mesh of a soft body leaves out (missed.h): against the integral over jumps, by other means.
#include "effects/elasticity/missed.h"

#include <gtest/gtest.h>

#include <array>

#include "effects/elasticity/mean_volume.h"
#include "effects/elasticity/recovery.h"
#include "geometry/midsides.h"
#include "geometry/quadratic.h"
#include "geometry/tet_rule.h"
#include "model/clusters.h"
#include "problem.h"

using namespace mortise;

namespace {

constexpr double kE = 1e5, kNu = 0.4, kMu = kE / (2 * (1 + kNu)), kLambda = kE * kNu / ((1 + kNu) * (1 - 2 * kNu));

using State = Eigen::Matrix<double, 8, 1>;  // e (xx yy zz xy yz zx), theta, p
using Field = std::vector<Vec3>;
using effects::elasticity::Recovery;

geometry::TetMesh mesh(int order) {
  geometry::TetMesh m = geometry::box({1, 1.3, 1.1}, std::array<Index, 3>{2, 2, 3});
  std::mt19937_64 rng(4);
  std::uniform_real_distribution<double> u(-0.06, 0.06);
  for (Vec3& x : m.points) x += Vec3(u(rng), u(rng), u(rng));
  return order == 1 ? m : geometry::with_midsides(m);
}

model::ModelInput gel(const std::string& law, int order, bool averaged) {
  Params material = mortise::testing::material(law, kE, kNu, 1000);
  material.set("volumetric", Params::make_text(averaged ? "averaged" : "full"));
  model::ModelInput in;
  in.scene = Params::make_table();
  in.bodies.push_back(mortise::testing::soft_body("gel", mesh(order), material));
  return in;
}

// Small strains of one displacement, by elements.
class States {
 public:
  States(const model::BodyInput& body, const Recovery& recovery, const Field& u, bool averaged)
      : body_(body), u_(u), averaged_(averaged), n_(body.midsides.empty() ? 4 : 10) {
    const std::vector<Index> cluster = n_ == 4 && averaged ? model::star_clusters(body) : std::vector<Index>();
    std::map<Index, double> sum, volume;
    for (std::size_t t = 0; t < body.tets.size(); ++t) {
      const Index c = cluster.empty() ? static_cast<Index>(t) : cluster[t];
      for (const geometry::TetRulePoint& p : geometry::tet_rule_5()) sum[c] += p.weight * this->volume(t) * strain(t, p.l).trace();
      volume[c] += this->volume(t);
    }
    for (std::size_t t = 0; t < body.tets.size(); ++t) {
      const Index c = cluster.empty() ? static_cast<Index>(t) : cluster[t];
      mean_.push_back(sum[c] / volume[c]);
    }
    star_.assign(body.nodes.size(), State::Zero());
    const Index points = n_ == 4 ? 1 : geometry::kTetPoints;
    for (std::size_t i = 0; i < star_.size(); ++i)
      for (Index k = recovery.first[i]; k < recovery.first[i + 1]; ++k) {
        double l[4];
        geometry::tet_point(recovery.point[k] % points, l);
        star_[i] += recovery.weight[k] * at(recovery.point[k] / points, l);
      }
  }
  State jump(std::size_t t, const double l[4]) const {
    State sum = -at(t, l);
    for (int a = 0; a < n_; ++a) sum += (n_ == 4 ? l[a] : geometry::tet_shape_function(a, l)) * star_[node(t, a)];
    return sum;
  }
  double volume(std::size_t t) const { return edges(t).determinant() / 6; }
  // What of lambda acts on means.
  double of_mean() const { return !averaged_ ? 0 : n_ == 4 ? kLambda : kLambda - kMu; }

 private:
  Index node(std::size_t t, int a) const { return a < 4 ? body_.tets[t].v[a] : body_.midsides[t].v[a - 4]; }
  Mat3 edges(std::size_t t) const {
    Mat3 out;
    for (int k = 0; k < 3; ++k) out.col(k) = body_.nodes[node(t, k + 1)] - body_.nodes[node(t, 0)];
    return out;
  }
  Mat3 strain(std::size_t t, const double l[4]) const {
    Mat3 slopes = Mat3::Zero();
    for (int a = 0; a < n_; ++a) {
      const Vec3 linear = a == 0 ? Vec3(-1, -1, -1) : a < 4 ? Vec3(Vec3::Unit(a - 1)) : Vec3::Zero();
      slopes += u_[node(t, a)] * (n_ == 4 ? linear : geometry::tet_slope(a, l)).transpose();
    }
    const Mat3 H = slopes * edges(t).inverse();
    return 0.5 * (H + H.transpose());
  }
  State at(std::size_t t, const double l[4]) const {
    const Mat3 e = strain(t, l);
    State out;
    out << e(0, 0), e(1, 1), e(2, 2), e(0, 1), e(1, 2), e(2, 0), e.trace(), of_mean() * mean_[t];
    return out;
  }
  const model::BodyInput& body_;
  const Field& u_;
  bool averaged_;
  int n_;
  std::vector<double> mean_;
  std::vector<State> star_;
};

double product(const model::Model& m, const model::BodyInput& body, const Field& u, const Field& z, bool averaged) {
  const Recovery recovery(m);
  const States of_u(body, recovery, u, averaged), of_z(body, recovery, z, averaged);
  double sum = 0;
  for (std::size_t t = 0; t < body.tets.size(); ++t)
    for (const geometry::TetRulePoint& p : geometry::tet_rule_5()) {
      const State a = of_u.jump(t, p.l), b = of_z.jump(t, p.l);
      const double shear = a.head<3>().dot(b.head<3>()) + 2 * a.segment<3>(3).dot(b.segment<3>(3)), of_mean = of_u.of_mean();
      sum += p.weight * of_u.volume(t) *
             (2 * kMu * shear + (kLambda - of_mean) * a[6] * b[6] + (averaged ? a[7] * b[6] + a[6] * b[7] - a[7] * b[7] / of_mean : 0));
    }
  return sum;
}

Field any(std::size_t n, unsigned seed) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> u(-1e-3, 1e-3);
  Field out;
  for (std::size_t i = 0; i < n; ++i) out.emplace_back(u(rng), u(rng), u(rng));
  return out;
}

// What mending all of it adds to the gradient, at rest positions that are moved by u and then turned.
Field mended(model::Model& m, const Field& u, const Mat3& turn = Mat3::Identity()) {
  Field at = m.rest.download();
  for (std::size_t i = 0; i < at.size(); ++i) at[i] = turn * (at[i] + u[i]);
  const fd::Vector x = fd::flatten(at);
  const auto e = fd::make_effect("elasticity", Params::make_table(), m);
  const fd::Vector before = fd::effect_assemble(*e, x, false).gradient;
  const device::Buffer<Vec3> q(at);
  e->effect->mend(effects::Fault::mesh, 1);
  e->effect->keep_pace(*e->effect, q.view());
  return fd::blocks_of(fd::effect_assemble(*e, x, false).gradient - before);
}

double dot(const Field& a, const Field& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
  return sum;
}

}  // namespace

TEST(Missed, IsTheIntegralOverJumps) {
  for (const int order : {1, 2})
    for (const bool averaged : {false, true}) {
      const model::ModelInput in = gel("linear", order, averaged);
      model::Model m(in);
      const std::size_t n = in.bodies[0].nodes.size();
      const Field u = any(n, 1), z = any(n, 2), g = mended(m, u);
      const double expected = -product(m, in.bodies[0], u, z, averaged);
      EXPECT_NEAR(dot(g, z), expected, 1e-9 * std::abs(expected)) << order << averaged;
      effects::elasticity::Missed missed(m);
      Field at = in.bodies[0].nodes;
      for (std::size_t i = 0; i < n; ++i) at[i] += u[i];
      const device::Buffer<Vec3> q(at);
      device::Buffer<double> pressure;
      effects::elasticity::Tets tets(m);
      effects::elasticity::cluster_pressures(tets, m.clusters, q.view(), {}, pressure);
      tets.pressure = std::as_const(pressure).view();
      missed.mend(tets, q.view(), 2);
      const double twice = -product(m, in.bodies[0], u, u, averaged);
      EXPECT_NEAR(missed.energy(), twice, 1e-9 * std::abs(twice)) << order << averaged;
    }
}

// Averages by volume on linear elements, which leave what is the same everywhere; on quadratic ones polynomials of second order as they are.
TEST(Missed, NodesHaveBetterValues) {
  for (const int order : {1, 2}) {
    const model::ModelInput in = gel("linear", order, false);
    const model::BodyInput& body = in.bodies[0];
    const model::Model m(in);
    const Recovery recovery(m);
    const auto of = [order](const Vec3& x) { return order == 1 ? 3 : 1 + x[0] - 2 * x[1] * x[2] + 3 * x[2] * x[2] + x[0] * x[1]; };
    const std::vector<double> volume = m.volume.rest_volume.download();
    for (std::size_t i = 0; i < body.nodes.size(); ++i) {
      double sum = 0;
      for (Index k = recovery.first[i]; k < recovery.first[i + 1]; ++k) {
        const Index p = recovery.point[k];
        Vec3 x = Vec3::Zero();
        double l[4];
        geometry::tet_point(p % geometry::kTetPoints, l);
        for (int a = 0; order == 2 && a < 4; ++a) x += l[a] * body.nodes[body.tets[p / geometry::kTetPoints].v[a]];
        sum += recovery.weight[k] * of(x);
        if (order == 1) {
          EXPECT_NEAR(recovery.weight[k] / volume[p], recovery.weight[recovery.first[i]] / volume[recovery.point[recovery.first[i]]], 1e-9);
        }
      }
      EXPECT_NEAR(sum, of(body.nodes[i]), order == 1 ? 1e-12 : 1e-5);
    }
  }
}

// Linear stresses have no jumps on quadratic elements.
TEST(Missed, NothingWhereStressesAreLinear) {
  const model::ModelInput in = gel("linear", 2, false);
  model::Model m(in);
  Field u;
  for (const Vec3& X : in.bodies[0].nodes) u.push_back(0.1 * Vec3(X[0] * X[1] - X[2] * X[2], X[2] * X[0], 2 * X[1] * X[1] + X[0]));
  const Field other = any(u.size(), 3);
  double most = 0, usual = 0;
  for (const Vec3& f : mended(m, u)) most = std::max(most, f.norm());
  for (const Vec3& f : mended(m, other)) usual = std::max(usual, f.norm());
  EXPECT_LT(most, 1e-5 * usual);
}

// Forces within a body cancel, and turn with it; small strains have those of the linear law.
TEST(Missed, TurnsWithTheBody) {
  const Mat3 turn = Eigen::AngleAxisd(1.2, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  for (const std::string law : {"neo_hookean", "corotated"})
    for (const int order : {1, 2})
      for (const bool averaged : {false, true}) {
        const model::ModelInput in = gel(law, order, averaged);
        model::Model m(in), linear(gel("linear", order, averaged));
        Field u = any(in.bodies[0].nodes.size(), 5);
        for (Vec3& v : u) v *= 1e-6;
        const Field g = mended(m, u), turned = mended(m, u, turn), small = mended(linear, u);
        Vec3 all = Vec3::Zero();
        double size = 0, turns = 0, differs = 0;
        for (std::size_t i = 0; i < g.size(); ++i) {
          all += g[i], size = std::max(size, g[i].norm());
          turns = std::max(turns, (turned[i] - turn * g[i]).norm()), differs = std::max(differs, (g[i] - small[i]).norm());
        }
        EXPECT_GT(size, 0);
        EXPECT_LT(all.norm(), 1e-6 * size) << law << order << averaged;
        EXPECT_LT(turns, 1e-6 * size) << law << order << averaged;
        EXPECT_LT(differs, 1e-3 * size) << law << order << averaged;
      }
}
