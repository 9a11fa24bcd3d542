// Quadratic tetrahedra in the effects that act on the bulk and on the surface.
#include <gtest/gtest.h>

#include "geometry/midsides.h"
#include "problem.h"

using namespace mortise;
using namespace mortise::effects;
using mortise::testing::vec;
using mortise::testing::where_side;

namespace {

constexpr double kDensity = 1000;

// A quadratic box with edges that are bent inside, and a linear one beside it.
model::ModelInput bent_and_straight(const std::string& law, double bend = 0.05) {
  model::ModelInput in;
  in.scene = Params::make_table();
  geometry::TetMesh mesh = geometry::with_midsides(geometry::box({1, 1, 2}, 1.0));
  const auto corners = static_cast<std::size_t>(geometry::box({1, 1, 2}, 1.0).points.size());
  std::mt19937_64 rng(3);
  std::uniform_real_distribution<double> u(-bend, bend);
  for (std::size_t i = corners; i < mesh.points.size(); ++i) mesh.points[i] += Vec3(u(rng), u(rng), u(rng));
  const Params material = mortise::testing::material(law, 1e5, 0.4, kDensity);
  in.bodies.push_back(mortise::testing::soft_body("bent", mesh, material));
  in.bodies.push_back(mortise::testing::soft_body("straight", geometry::box({1, 1, 1}, 1.0), material, {3, 0, 0}));
  return in;
}

model::ModelInput straight_box() {
  model::ModelInput in;
  in.scene = Params::make_table();
  in.bodies.push_back(mortise::testing::soft_body("box", geometry::with_midsides(geometry::box({1, 2, 3}, 1.0)),
                                                  mortise::testing::material("linear", 1e5, 0.3, kDensity)));
  return in;
}

fd::Matrix mass_matrix(const model::Model& m) {
  fd::Matrix M = fd::Matrix::Zero(m.blocks, m.blocks);
  const auto row = m.mass.row_offset.download(), column = m.mass.column.download();
  const auto value = m.mass.value.download();
  for (Index i = 0; i < m.blocks; ++i)
    for (Index k = row[i]; k < row[i + 1]; ++k) {
      EXPECT_EQ(M(i, column[k]), 0) << "entry twice";
      M(i, column[k]) = value[k];
    }
  return M;
}

}  // namespace

TEST(Quadratic, ElasticityDerivatives) {
  for (const char* law : {"linear", "corotated", "neo_hookean"}) {
    model::Model m(bent_and_straight(law));
    const auto e = fd::make_effect("elasticity", Params::make_table(), m);
    EXPECT_NEAR(fd::effect_energy(*e, fd::shaken(m, 0)), 0, 1e-18);
    const fd::Vector x = 1.02 * fd::shaken(m, 0.001);
    const fd::Errors errors = fd::effect_errors(*e, x, 1e-3);
    EXPECT_LT(errors.gradient, 1e-6) << law;
    EXPECT_LT(errors.hessian, 1e-5) << law;
    const fd::Vector crushed = 0.6 * fd::shaken(m, 0.1);
    const fd::Dense d = fd::effect_assemble(*e, crushed, true);
    EXPECT_LT(fd::relative_error(d.gradient, fd::difference_gradient([&](const fd::Vector& y) { return fd::effect_energy(*e, y); }, crushed, 1e-4)),
              1e-6);
    EXPECT_GT(fd::lowest_eigenvalue(d.hessian), -1e-13) << law;
  }
}

// u = quadratic field: strains vary linearly, and the elements hold the field exactly. Bending by u_z = c x^2 / 2, u_x = -c x z has
// eps_xx = -c z and nothing else, so E = 1/2 (lambda + 2 mu) c^2 int z^2 dV.
TEST(Quadratic, ElementsBendExactly) {
  model::Model m(straight_box());
  const auto e = fd::make_effect("elasticity", Params::make_table(), m);
  const double c = 1e-3, E = 1e5, nu = 0.3, mu = E / (2 * (1 + nu)), lambda = E * nu / ((1 + nu) * (1 - 2 * nu));
  std::vector<Vec3> q = m.rest.download();
  for (Vec3& x : q) x += Vec3(-c * x[0] * x[2], 0, c * x[0] * x[0] / 2);
  EXPECT_NEAR(fd::effect_energy(*e, fd::flatten(q)) / (0.5 * (lambda + 2 * mu) * c * c * 1 * 2 * (27.0 / 12)), 1, 1e-10);

  m.q.upload(q);
  fd::Recorder sink;
  e->report(sink);
  ASSERT_EQ(sink.cell.at("cauchy_stress").size(), static_cast<std::size_t>(6 * m.bodies[0].tet_end));
  EXPECT_NEAR(sink.scalars.at("elasticity.det_F_min"), 1 - c * 1.5, c * 0.7);
}

TEST(Quadratic, MassIsConsistentAndPositive) {
  const model::Model m(straight_box());
  const fd::Matrix M = mass_matrix(m);
  EXPECT_NEAR(M.sum(), 6 * kDensity, 1e-9);
  EXPECT_EQ((M - M.transpose()).norm(), 0);
  EXPECT_GT(fd::lowest_eigenvalue(M), 1e-4);
  EXPECT_LT(m.bodies[0].centre.norm(), 1e-14);
  // Turning about z: v = w x r is in the space, so the kinetic energy is that of the brick, 1/2 m (a^2 + b^2)/12 w^2.
  double twice = 0;
  const auto rest = m.rest.download();
  for (Index i = 0; i < m.blocks; ++i)
    for (Index j = 0; j < m.blocks; ++j) twice += M(i, j) * (rest[i][0] * rest[j][0] + rest[i][1] * rest[j][1]);
  EXPECT_NEAR(twice, 6 * kDensity * (1 + 4) / 12, 1e-9);

  const model::Model bent(bent_and_straight("linear"));
  const fd::Matrix B = mass_matrix(bent);
  EXPECT_GT(fd::lowest_eigenvalue(B), 1e-5);
  EXPECT_NEAR(B.sum(), bent.bodies[0].mass + bent.bodies[1].mass, 1e-9);
}

// On a plane face a uniform pressure loads the middles of the edges and not the corners.
TEST(Quadratic, PressureLoadIsConsistent) {
  model::Model m(straight_box());
  Params load = fd::table({{"body", Params::make_text("box")},
                           {"where", where_side("z_max")},
                           {"traction_factor", Params::make_number(1)},
                           {"pressure", Params::make_number(2000)}});
  const auto e = fd::make_effect("pressure_load", Params::make_list({load}), m);
  StepInfo step;
  step.dt = 1;
  e->begin_step(step);
  const auto g = fd::blocks_of(fd::effect_assemble(*e, fd::shaken(m, 0), true).gradient);
  const auto corners = static_cast<Index>(geometry::box({1, 2, 3}, 1.0).points.size());
  const auto rest = m.rest.download();
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
  for (Index b = 0; b < m.blocks; ++b) {
    if (b < corners) {
      EXPECT_LT(g[b].norm(), 1e-10);
    } else if (rest[b][2] > 1.499) {
      // faces have 1/2 m^2; an edge belongs to one or two of them
      const double share = -g[b][2] / (2000 * 0.5 / 3);
      EXPECT_TRUE(std::abs(share + 1) < 1e-12 || std::abs(share + 2) < 1e-12) << share;
    }
    force -= g[b], moment -= rest[b].cross(g[b]);
  }
  EXPECT_LT((force - Vec3(0, 0, -4000)).norm(), 1e-9);
  EXPECT_LT(moment.norm(), 1e-9);
}

// Pressure all around a bent body has no resultant and works on its volume: -p dV/dq.
TEST(Quadratic, PressureAroundABentBodyBalances) {
  model::Model m(bent_and_straight("linear"));
  Params load = fd::table({{"body", Params::make_text("bent")},
                           {"where", where_side("all")},
                           {"traction_factor", Params::make_number(1)},
                           {"pressure", Params::make_number(2000)}});
  const auto e = fd::make_effect("pressure_load", Params::make_list({load}), m);
  StepInfo step;
  step.dt = 1;
  e->begin_step(step);
  const fd::Dense d = fd::effect_assemble(*e, fd::shaken(m, 0), true);
  const auto g = fd::blocks_of(d.gradient);
  const auto rest = m.rest.download();
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
  double work = 0;  // of swelling: q grows by q
  for (Index b = 0; b < m.blocks; ++b) force += g[b], moment += rest[b].cross(g[b]), work -= g[b].dot(rest[b]);
  EXPECT_LT(force.norm(), 1e-9);
  EXPECT_LT(moment.norm(), 1e-9);
  EXPECT_NEAR(work, -2000 * 3 * m.bodies[0].volume, 1e-8);
}

// Weight is the row sum of the mass, int rho N_a g dV: corners of a tetrahedron carry -1/20 of it, middles 1/5.
TEST(Quadratic, GravityIsConsistent) {
  model::ModelInput in;
  in.scene = Params::make_table();
  const geometry::TetMesh one{{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 6)}, {{{0, 1, 2, 3}}}};
  in.bodies.push_back(mortise::testing::soft_body("tet", geometry::with_midsides(one), mortise::testing::material("linear", 1e5, 0.3, kDensity)));
  model::Model m(std::move(in));
  const auto e = fd::make_effect("gravity", fd::table({{"acceleration", vec({0, 0, -10})}}), m);
  const auto g = fd::blocks_of(fd::effect_assemble(*e, fd::shaken(m, 0), true).gradient);
  for (Index b = 0; b < 10; ++b) EXPECT_NEAR(g[b][2], kDensity * 10 * (b < 4 ? -0.05 : 0.2), 1e-9);
}

TEST(Quadratic, InertiaKeepsFreeMotion) {
  model::Model m(bent_and_straight("neo_hookean"));
  const auto e = fd::make_effect("inertia", fd::table({{"integrator", Params::make_text("backward_euler")}}), m);
  StepInfo step;
  step.dt = 0.1;
  e->begin_step(step);
  const fd::Errors errors = fd::effect_errors(*e, fd::shaken(m, 0.01), 1e-3);
  EXPECT_LT(errors.gradient, 1e-6);
  EXPECT_LT(errors.hessian, 1e-5);
  EXPECT_GT(fd::lowest_eigenvalue(fd::effect_assemble(*e, fd::shaken(m, 0), true).hessian), 0);
}

TEST(Quadratic, InsideOutElementsAreRefused) { EXPECT_THROW(model::Model m(bent_and_straight("linear", 1.0)), Error); }
