// Changes of volume that are resisted on average: clusters of linear tetrahedra, quadratic tetrahedra.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "geometry/midsides.h"
#include "model/clusters.h"
#include "problem.h"

using namespace mortise;

namespace {

Params gel(const std::string& law, const char* volumetric = "averaged", double nu = 0.49) {
  Params p = mortise::testing::material(law, 1e5, nu, 1000);
  p.set("volumetric", Params::make_text(volumetric));
  return p;
}

// A box of 2 x 4 x 3 cells, shaken so that no two elements are alike; with `order` 2 of 1 x 2 x 1.
geometry::TetMesh mesh(int order) {
  geometry::TetMesh m =
      order == 1 ? geometry::box({1, 2, 1.5}, std::array<Index, 3>{2, 4, 3}) : geometry::box({1, 2, 1}, std::array<Index, 3>{1, 2, 1});
  std::mt19937_64 rng(3);
  std::uniform_real_distribution<double> u(-0.06, 0.06);
  for (Vec3& x : m.points)
    for (int k = 0; k < 3; ++k) x[k] += u(rng);
  return order == 1 ? m : geometry::with_midsides(m);
}

// A stiff ball, a body that is averaged, one that is not, in every environment.
model::ModelInput bodies(const std::string& law, int order, int envs = 1) {
  model::ModelInput in;
  in.scene = Params::make_table();
  for (int e = 0; e < envs; ++e) {
    in.bodies.push_back(
        mortise::testing::stiff_body("ball", geometry::sphere(0.5, 0.5), mortise::testing::material("linear", 1e9, 0.3, 2000), {0, 5, 0}));
    in.bodies.push_back(mortise::testing::soft_body("plain", geometry::box({1, 1, 1}, 1.0), gel(law, "full"), {5, 0, 0}));
    in.bodies.push_back(mortise::testing::soft_body("gel", mesh(order), gel(law)));
    for (std::size_t i = in.bodies.size() - 3; i < in.bodies.size(); ++i) in.bodies[i].env = e;
  }
  return in;
}

}  // namespace

TEST(MeanVolume, DerivativesOfTheWholeEffect) {
  for (const char* law : {"linear", "corotated", "neo_hookean"})
    for (const int order : {1, 2}) {
      model::Model m(bodies(law, order));
      const auto e = fd::make_effect("elasticity", Params::make_table(), m);
      for (const double swell : {1.03, 0.95}) {  // pressure of both signs
        const fd::Vector x = swell * fd::shaken(m, 0.01);
        const fd::Errors errors = fd::effect_errors(*e, x, 1e-3);
        EXPECT_LT(errors.gradient, 1e-6) << law << order;
        EXPECT_LT(errors.hessian, 1e-5) << law << order;
      }
      const fd::Dense d = fd::effect_assemble(*e, 0.7 * fd::shaken(m, 0.1), true);
      EXPECT_GT(fd::lowest_eigenvalue(d.hessian), -1e-13) << law << order;
    }
}

// A deformation that is the same everywhere has the same forces and stresses as without averages, also at large strain: lambda
// alone is averaged, not the law's whole resistance to changes of volume.
TEST(MeanVolume, UniformDeformationsAreAsWithoutAverages) {
  const Mat3 F = (Mat3() << 1.05, 0.1, 0, 0, 1.02, -0.05, 0.02, 0, 0.9).finished();
  for (const char* law : {"linear", "corotated", "neo_hookean"})
    for (const int order : {1, 2}) {
      std::vector<fd::Vector> force;
      std::vector<std::vector<double>> stress;
      std::vector<double> energy;
      for (const char* volumetric : {"averaged", "full"}) {
        model::ModelInput in;
        in.scene = Params::make_table();
        in.bodies.push_back(mortise::testing::soft_body("gel", mesh(order), gel(law, volumetric)));
        model::Model m(in);
        std::vector<Vec3> q = m.rest.download();
        for (Vec3& x : q) x = F * x;
        m.q.upload(q);
        const auto e = fd::make_effect("elasticity", Params::make_table(), m);
        force.push_back(fd::effect_assemble(*e, fd::flatten(q), false).gradient);
        fd::Recorder sink;
        e->report(sink);
        stress.push_back(sink.cell["cauchy_stress"]);
        energy.push_back(sink.scalars["elasticity.energy"]);
      }
      EXPECT_LT((force[0] - force[1]).norm() / force[1].norm(), 1e-11) << law << order;
      EXPECT_NEAR(energy[0] / energy[1], 1, 1e-12) << law << order;
      for (std::size_t i = 0; i < stress[0].size(); ++i) ASSERT_NEAR(stress[0][i], stress[1][i], 1e-11 * 1e6) << law << order;
    }
}

TEST(MeanVolume, EnvironmentsAreCountedApart) {
  model::Model both(bodies("neo_hookean", 1, 2)), one(bodies("neo_hookean", 1));
  const auto e2 = fd::make_effect("elasticity", Params::make_table(), both), e1 = fd::make_effect("elasticity", Params::make_table(), one);
  const fd::Vector x = fd::shaken(both, 0.05);
  const std::vector<double> energies = fd::effect_energies(*e2, x, 2);
  EXPECT_EQ(energies[0], fd::effect_energies(*e1, x.head(3 * one.blocks), 1)[0]);
  EXPECT_NE(energies[0], energies[1]);
}

// Of many clusters, in some direction.
TEST(MeanVolume, SlopeOfALargeMesh) {
  for (const char* law : {"linear", "neo_hookean"}) {
    model::ModelInput in;
    in.scene = Params::make_table();
    in.bodies.push_back(mortise::testing::soft_body("gel", geometry::box({1, 1.4, 0.6}, std::array<Index, 3>{18, 14, 4}), gel(law)));
    model::Model m(in);
    EXPECT_EQ(m.clusters.size(), 9 * 7 * 2);
    const auto e = fd::make_effect("elasticity", Params::make_table(), m);
    const fd::Vector x = 0.98 * fd::shaken(m, 0.005), d = fd::shaken(m, 1, 9) - fd::shaken(m, 0);
    const auto E = [&](double s) { return fd::effect_energy(*e, x + s * d); };
    const double h = 1e-5, slope = (8 * (E(h) - E(-h)) - (E(2 * h) - E(-2 * h))) / (12 * h);
    EXPECT_NEAR(fd::effect_assemble(*e, x, false).gradient.dot(d) / slope, 1, 1e-8) << law;
  }
}

namespace {

Index clusters_of(const char* volumetric, double nu, const geometry::TetMesh& m) {
  model::ModelInput in;
  in.scene = Params::make_table();
  in.bodies.push_back(mortise::testing::soft_body("gel", m, gel("neo_hookean", volumetric, nu)));
  const model::Model model(in);
  return model.clusters.size();
}

}  // namespace

TEST(MeanVolume, AutoAveragesAboveAThreshold) {
  const geometry::TetMesh m = geometry::box({1, 1, 1}, 0.5);
  EXPECT_EQ(clusters_of("auto", 0.4, m), 0);
  EXPECT_EQ(clusters_of("auto", 0.41, m), 1);
  EXPECT_EQ(clusters_of("full", 0.49, m), 0);
  EXPECT_EQ(clusters_of("averaged", 0.3, m), 1);
  EXPECT_EQ(clusters_of("averaged", 0.3, geometry::with_midsides(m)), 0);  // every element by itself
}

// Blocks of eight cells in boxes; whatever the mesh, every tetrahedron is in one cluster, which hangs together and is neither
// tiny nor huge.
TEST(Clusters, AreStars) {
  const auto of = [](const geometry::TetMesh& m) { return model::star_clusters(mortise::testing::soft_body("b", m, gel("linear"))); };
  const geometry::TetMesh box = geometry::box({1, 1, 1}, std::array<Index, 3>{6, 4, 2});
  const std::vector<Index> blocks = of(box);
  EXPECT_EQ(*std::max_element(blocks.begin(), blocks.end()), 5);
  for (std::size_t t = 0; t < blocks.size(); ++t) {
    Vec3 centre = Vec3::Zero();
    for (Index v : box.tets[t].v) centre += 0.25 * box.points[v];
    const Index block = static_cast<Index>((centre[0] + 0.5) * 3) + 3 * static_cast<Index>((centre[1] + 0.5) * 2);
    EXPECT_EQ(blocks[t], block);
  }
  for (const geometry::TetMesh& m :
       {mesh(1), geometry::sphere(1, 0.3), geometry::capsule(1, 1.3, 0.5), geometry::box({4, 4, 1}, 1.0), geometry::box({1, 1, 1}, 1.0)}) {
    const std::vector<Index> cluster = of(m);
    std::map<Index, std::vector<std::size_t>> members;
    for (std::size_t t = 0; t < cluster.size(); ++t) members[cluster[t]].push_back(t);
    ASSERT_EQ(members.begin()->first, 0);
    ASSERT_EQ(members.rbegin()->first + 1, static_cast<Index>(members.size()));
    for (const auto& [c, tets] : members) {
      EXPECT_GE(tets.size(), 6u);
      EXPECT_LE(tets.size(), 80u);
      std::set<Index> reached(m.tets[tets[0]].v, m.tets[tets[0]].v + 4);
      std::set<std::size_t> left(tets.begin() + 1, tets.end());
      for (bool more = true; more;) {
        more = false;
        for (auto t = left.begin(); t != left.end();) {
          const Tet& tet = m.tets[*t];
          const bool joins = std::count_if(tet.v, tet.v + 4, [&](Index v) { return reached.contains(v); }) >= 3;
          if (joins) reached.insert(tet.v, tet.v + 4), more = true;
          t = joins ? left.erase(t) : std::next(t);
        }
      }
      EXPECT_TRUE(left.empty()) << c;
    }
  }
}
