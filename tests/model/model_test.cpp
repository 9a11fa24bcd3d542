#include "model/model.h"

#include <gtest/gtest.h>

#include "scene_builder.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

model::ModelInput two_bodies() {
  model::ModelInput in;
  in.scene = Params::make_table();
  in.bodies.push_back(soft_body("pad", geometry::box({2, 1, 1}, 0.5), material("neo_hookean", 1e5, 0.3, 1000)));
  in.bodies.push_back(
      stiff_body("ball", geometry::sphere(0.5, 0.1), material("linear", 1e9, 0.3, 2000), {0, 0, 2}, body_params({1, 2, 3}, {0, 0, 4})));
  in.bodies.push_back(half_space("floor", {0, 0, -1}, {0, 0, 5}));
  return in;
}

}  // namespace

TEST(Model, SoftNodesAreBlocksAndStiffBodiesAreFour) {
  const model::Model m(two_bodies());
  ASSERT_EQ(m.bodies.size(), 2u);
  EXPECT_EQ(m.bodies[0].block_end, m.bodies[0].point_end);
  EXPECT_EQ(m.bodies[1].block_end - m.bodies[1].block_begin, 4);
  EXPECT_EQ(m.blocks, m.bodies[1].block_end);
  ASSERT_EQ(m.half_spaces.size(), 1u);
  EXPECT_DOUBLE_EQ(m.half_spaces[0].normal.norm(), 1);
}

TEST(Model, PointsAtRestAreTheMeshes) {
  const model::Model m(two_bodies());
  device::Buffer<Vec3> y;
  m.points_of(m.q.view(), y);
  const auto now = y.download(), rest = m.rest_points.download();
  ASSERT_EQ(now.size(), rest.size());
  for (std::size_t i = 0; i < now.size(); ++i) EXPECT_LT((now[i] - rest[i]).norm(), 1e-15);
}

TEST(Model, MassesAddUpAndTheStiffMassMatrixGivesTheRightKineticEnergy) {
  const model::Model m(two_bodies());
  const auto row = m.mass.row_offset.download();
  const auto col = m.mass.column.download();
  const auto value = m.mass.value.download();
  double pad = 0;
  for (Index b = m.bodies[0].block_begin; b < m.bodies[0].block_end; ++b)
    for (Index k = row[b]; k < row[b + 1]; ++k) pad += value[k];
  EXPECT_NEAR(pad, 2 * 1000, 1e-9);
  EXPECT_NEAR(m.bodies[0].mass, 2 * 1000, 1e-9);

  // T = 1/2 m v^2 + 1/2 w.I w of the polyhedron.
  const auto v = m.initial_velocity.download();
  double twice = 0;
  for (Index b = m.bodies[1].block_begin; b < m.bodies[1].block_end; ++b)
    for (Index k = row[b]; k < row[b + 1]; ++k) twice += value[k] * v[b].dot(v[col[k]]);
  const auto surface = geometry::surface_of(geometry::sphere(0.5, 0.1));
  const auto properties = geometry::mass_properties(surface);
  const Vec3 w(0, 0, 4);
  const double exact = 2000 * properties.volume * Vec3(1, 2, 3).squaredNorm() + w.dot(properties.inertia(2000) * w);
  EXPECT_NEAR(twice, exact, 1e-9 * exact);
}

TEST(Model, SurfaceAreasPartitionTheSurface) {
  const model::Model m(two_bodies());
  double vertices = 0, edges = 0;
  for (double a : m.surface.vertex_area.download()) vertices += a;
  for (double a : m.surface.edge_area.download()) edges += a;
  const double area = 10 + geometry::area(geometry::surface_of(geometry::sphere(0.5, 0.1)));
  EXPECT_NEAR(vertices, area, 1e-12 * area);
  EXPECT_NEAR(edges, area, 1e-12 * area);
}

TEST(Model, SelectsPointsBySideBoxAndSphere) {
  const model::Model m(two_bodies());
  EXPECT_EQ(select_points(m, m.bodies[0], where_side("z_min")).size(), 5u * 3u);
  EXPECT_EQ(select_points(m, m.bodies[0], where_side("all")).size(), 5u * 3u * 3u);
  Params box = Params::make_table(), where_box = Params::make_table();
  box.set("min", vec({-1.1, -0.6, -0.6}));
  box.set("max", vec({-0.9, 0.6, 0.6}));
  where_box.set("box", box);
  EXPECT_EQ(select_points(m, m.bodies[0], where_box).size(), 9u);
  Params sphere = Params::make_table(), where_sphere = Params::make_table();
  sphere.set("centre", vec({0, 0, 0}));
  sphere.set("radius", Params::make_number(0.51));
  where_sphere.set("sphere", sphere);
  EXPECT_EQ(select_points(m, m.bodies[0], where_sphere).size(), 7u);
}

TEST(Model, RefusesAnInvertedTetrahedron) {
  model::ModelInput in = two_bodies();
  std::swap(in.bodies[0].tets[3].v[0], in.bodies[0].tets[3].v[1]);
  try {
    const model::Model m(std::move(in));
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), Exit::scene);
    EXPECT_NE(std::string(e.what()).find("tetrahedron 3"), std::string::npos) << e.what();
  }
}
