#include "run/output_mesh.h"

#include <gtest/gtest.h>

#include "../scene_builder.h"
#include "geometry/midsides.h"

using namespace mortise;
using namespace mortise::testing;

// A linear, a quadratic and a stiff body: types, and the nodes of quadratic cells in the order of VTK, corners and then the middles of
// (0,1) (1,2) (2,0) (0,3) (1,3) (2,3).
TEST(OutputMesh, CellsOfAllKinds) {
  const geometry::TetMesh box = geometry::box({1, 1, 1}, 1.0);
  model::ModelInput in;
  in.bodies.push_back(soft_body("one", box, material("linear", 1, 0, 1)));
  in.bodies.push_back(soft_body("two", geometry::with_midsides(box), material("linear", 1, 0, 1)));
  in.bodies.push_back(stiff_body("tool", box, material("linear", 1, 0, 1)));
  in.bodies.push_back(half_space("floor", {0, 0, 0}, {0, 0, 1}));
  const output::OutputMesh mesh = run::output_mesh(in);
  ASSERT_EQ(mesh.cells(), 6u + 6u + 12u);
  EXPECT_EQ(mesh.points.size(), 8u + 27u + 8u);
  constexpr int edges[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
  for (std::size_t c = 0; c < mesh.cells(); ++c) {
    const auto nodes = mesh.offsets[c + 1] - mesh.offsets[c];
    EXPECT_EQ(mesh.types[c], c < 6 ? output::tetrahedron : c < 12 ? output::quadratic_tetrahedron : output::triangle);
    EXPECT_EQ(nodes, c < 6 ? 4 : c < 12 ? 10 : 3);
    EXPECT_EQ(mesh.body_of_cell[c], c < 6 ? 0 : c < 12 ? 1 : 2);
    if (c < 6 || c >= 12) continue;
    const auto x = [&](int k) { return mesh.points[mesh.connectivity[mesh.offsets[c] + k]]; };
    for (int e = 0; e < 6; ++e) EXPECT_EQ(x(4 + e), Vec3(0.5 * (x(edges[e][0]) + x(edges[e][1]))));
  }
}
