// Which facets around a node are pressed (audit/contact_patch.h), seen through the misfit of forces and pressure.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "audit/pressure_error.h"
#include "geometry/primitives.h"

using namespace mortise;

namespace {

// A block whose top, under a uniform pressure, meets leaning sides: thirds of the facets' areas.
// covered: of the areas of nodes in the middle, less than whose lies over what presses; pressures are over that, and forces as before.
double misfit_of_block(double lean, double covered = 1, bool told = true) {
  model::BodyInput body;
  body.name = "block", body.material = Params::make_table();
  geometry::TetMesh mesh = geometry::box(Vec3(4, 4, 1), {4, 4, 1});
  for (Vec3& x : mesh.points) x[0] += x[2] * std::tan(lean * std::numbers::pi / 180);
  model::set_mesh(body, mesh);
  const model::ModelInput input{Params::make_table(), {body}};
  const auto on_top = [&](Index v) { return body.nodes[v][2] > 0.49; };
  std::vector<double> pressure(body.nodes.size(), 0.0), force(3 * body.nodes.size(), 0.0);
  for (std::size_t i = 0; i < body.nodes.size(); ++i)
    if (on_top(static_cast<Index>(i))) pressure[i] = 1;
  for (const Triangle& t : body.triangles) {
    if (!on_top(t.v[0]) || !on_top(t.v[1]) || !on_top(t.v[2])) continue;
    const double third = (body.nodes[t.v[1]] - body.nodes[t.v[0]]).cross(body.nodes[t.v[2]] - body.nodes[t.v[0]]).norm() / 6;
    for (Index v : t.v) force[3 * v + 2] -= third;
  }
  std::vector<double> area(body.nodes.size(), 0.0);
  for (std::size_t i = 0; i < area.size(); ++i) {
    area[i] = -force[3 * i + 2];
    if (std::abs(body.nodes[i][0]) < 0.1) area[i] *= covered, pressure[i] /= covered;
  }
  return audit::PressureError(input).of({pressure, force, {}, told ? std::span<const double>(area) : std::span<const double>()}).misfit;
}

}  // namespace

// Sides at 45 degrees and less to the force are not pressed: an edge of the body lies between them and what is.
TEST(ContactPatch, SidesOfABodyAreNotPressed) {
  for (const double lean : {0.0, 15.0, 30.0, 45.0, 48.0, -45.0}) EXPECT_LT(misfit_of_block(lean), 1e-12) << lean;
}

// A surface that reaches beyond what presses on it: the pressure of its last nodes is none of their whole areas.
TEST(ContactPatch, NodesThatAreCoveredInPartSayNothing) {
  EXPECT_GT(misfit_of_block(0, 0.6, false), 0.1);
  EXPECT_LT(misfit_of_block(0, 0.6), 1e-12);
  EXPECT_LT(misfit_of_block(30, 0.6), 1e-12);
}
