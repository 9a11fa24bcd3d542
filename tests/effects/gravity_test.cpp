#include <gtest/gtest.h>

#include "problem.h"

using namespace mortise;

namespace {
const Vec3 kG(1, -2, -9.81);
std::unique_ptr<fd::Subject> gravity(model::Model& m) {
  return fd::make_effect("gravity", fd::table({{"acceleration", mortise::testing::vec(kG)}}), m);
}
}  // namespace

TEST(Gravity, ForceIsTheWeightOfEachBody) {
  model::Model m(fd::box_and_ball());
  const auto e = gravity(m);
  const auto g = fd::blocks_of(fd::effect_assemble(*e, fd::shaken(m, 0.1), true).gradient);
  for (const model::Body& body : m.bodies) {
    Vec3 force = Vec3::Zero();
    for (Index b = body.block_begin; b < body.block_end; ++b) force -= g[b];
    EXPECT_LT((force - body.mass * kG).norm(), 1e-9 * body.mass) << body.name;
  }
  for (Index b = m.bodies[1].block_begin + 1; b < m.bodies[1].block_end; ++b) EXPECT_EQ(g[b], Vec3::Zero());
}

TEST(Gravity, EnergyIsMassTimesHeight) {
  model::Model m(fd::box_and_ball("linear", 2));
  const auto e = gravity(m);
  std::vector<Vec3> q = m.rest.download();
  for (Index b = 0; b < m.blocks; ++b)
    if (b < m.bodies[0].block_end || b == m.bodies[1].block_begin) q[b] += Vec3(0, 0, 3);  // all of environment 0
  const std::vector<double> energy = fd::effect_energies(*e, fd::flatten(q), 2);
  EXPECT_NEAR(energy[0], (m.bodies[0].mass + m.bodies[1].mass) * 9.81 * 3, 1e-8);
  EXPECT_EQ(energy[1], 0);
}

TEST(Gravity, Derivatives) {
  model::Model m(fd::box_and_ball());
  const auto e = gravity(m);
  const fd::Errors errors = fd::effect_errors(*e, fd::shaken(m, 0.1), 1e-2);
  EXPECT_LT(errors.gradient, 1e-6);
  EXPECT_EQ(errors.hessian, 0);
}
