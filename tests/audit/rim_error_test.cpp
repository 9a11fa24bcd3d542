// Contact that ends along a sharp edge inside a soft surface.
#include "audit/rim_error.h"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/primitives.h"
#include "model/input.h"

namespace mortise::audit {
namespace {

model::BodyInput body(const char* name, model::BodyType type, const geometry::TetMesh& mesh, const Vec3& at) {
  model::BodyInput out;
  out.name = name, out.type = type, out.material = Params::make_table();
  model::set_mesh(out, mesh);
  for (Vec3& x : out.nodes) x += at;
  return out;
}

// A pad of 40 x 40 x 10 mm in cells of a millimetre, or its half beyond x = 0, whose top is pressed by what lies less than `reach` from its axis in x
// and in y.
struct Pressed {
  explicit Pressed(const model::BodyInput& by, double reach, bool loaded = false, double share = 1) {
    input.scene = Params::make_table();
    Params effects = Params::make_table(), loads = Params::make_list(), load = Params::make_table();
    load.set("body", Params::make_text("pad"));
    if (loaded) loads.push(load);
    effects.set("pressure_load", loads);
    input.scene.set("effects", effects);
    input.bodies = {body("pad", model::BodyType::soft, geometry::box(Vec3(share * 0.04, 0.04, 0.01), {static_cast<Index>(share * 40), 40, 10}),
                         {(1 - share) * 0.02, 0, -0.005}),
                    by};
    const std::size_t points = input.bodies[0].nodes.size() + by.nodes.size();
    pressure.assign(points, 0.0), force.assign(3 * points, 0.0), displacement.assign(3 * points, 0.0);
    for (std::size_t i = 0; i < input.bodies[0].nodes.size(); ++i) {
      const Vec3& x = input.bodies[0].nodes[i];
      if (std::abs(x[2]) > 1e-9 || std::abs(x[0]) > reach || std::abs(x[1]) > reach) continue;
      pressure[i] = 1e5, force[3 * i + 2] = -0.1;
    }
  }
  double error() const {
    const auto of = RimError(input).of(ContactPatch(input), {pressure, force, displacement}, {0, 0});
    return of.empty() ? NAN : of.at(0);
  }
  model::ModelInput input;
  std::vector<double> pressure, force, displacement;
};

model::BodyInput punch(double side) { return body("punch", model::BodyType::stiff, geometry::box(Vec3(side, side, 0.02), {1, 1, 1}), {0, 0, 0.01}); }

}  // namespace

// 0.8 h L / (2 A): of ten and of twenty cells, those beside the edge for a half
TEST(RimError, IsTheShareOfAPatchThatAWidenedEdgeAdds) {
  EXPECT_NEAR(Pressed(punch(0.011), 5.1e-3).error(), 0.8 * 44 / (2 * 101.), 0.005);
  EXPECT_NEAR(Pressed(punch(0.021), 10.1e-3).error(), 0.8 * 84 / (2 * 401.), 0.005);
}

TEST(RimError, WhatEndsSoftlyHasNone) {
  const auto ball = body("ball", model::BodyType::stiff, geometry::sphere(0.02, 2e-3), {0, 0, 0.0199});
  EXPECT_EQ(Pressed(ball, 3.1e-3).error(), 0);
}

TEST(RimError, NeitherHasASurfaceThatEndsWithTheContact) {
  EXPECT_EQ(Pressed(punch(0.04), 0.021).error(), 0);
  EXPECT_EQ(Pressed(punch(0.06), 0.021).error(), 0);
}

// A plane of symmetry cuts punch and pad: its edges lead across the end of the patch, not along it.
TEST(RimError, EdgesAcrossTheRimDoNotCount) {
  Pressed half(body("punch", model::BodyType::stiff, geometry::box(Vec3(0.0055, 0.011, 0.02), {1, 1, 1}), {0.00275, 0, 0.01}), 5.1e-3, false, 0.5);
  EXPECT_NEAR(half.error(), Pressed(punch(0.011), 5.1e-3).error(), 0.02);
}

TEST(RimError, WherePressureActsBeyondTheEdgeNothingIsSingular) { EXPECT_EQ(Pressed(punch(0.011), 5.1e-3, true).error(), 0); }

}  // namespace mortise::audit
