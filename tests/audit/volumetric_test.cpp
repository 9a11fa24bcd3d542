// Which bodies are averaged, how, and what is told of that.
#include "audit/volumetric.h"

#include <gtest/gtest.h>

#include "geometry/midsides.h"
#include "geometry/primitives.h"
#include "model/volumetric.h"

namespace mortise::audit {
namespace {

model::ModelInput pad(int across, double nu, const char* volumetric = nullptr, bool quadratic = true) {
  Params material = Params::make_table();
  material.set("youngs_modulus", Params::make_number(1e5)), material.set("poisson_ratio", Params::make_number(nu));
  if (volumetric) material.set("volumetric", Params::make_text(volumetric));
  model::BodyInput body;
  body.name = "pad", body.material = material;
  const geometry::TetMesh mesh = geometry::box(Vec3(4, 4, 2), {4, 4, across});
  model::set_mesh(body, quadratic ? geometry::with_midsides(mesh) : mesh);
  return {Params::make_table(), {body}};
}

}  // namespace

TEST(Volumetric, IsAveragedAboveTwoFifths) {
  EXPECT_EQ(volumetric(pad(1, 0.4).bodies[0]), "full");
  EXPECT_EQ(volumetric(pad(1, 0.45).bodies[0]), "averaged over every element");
  EXPECT_EQ(volumetric(pad(1, 0.3, "averaged").bodies[0]), "averaged over every element");
  EXPECT_TRUE(locking_risks(pad(1, 0.45)).empty());
}

// All of it at any time, and nothing on means that points of nu 0.25 bear.
TEST(Volumetric, ActsAtPointsAndOnMeansOfQuadraticElements) {
  for (const double nu : {0.2, 0.3, 0.45, 0.4999}) {
    const model::Lambda full = model::lambda_of(1e6, nu, false, true), split = model::lambda_of(1e6, nu, true, true),
                        linear = model::lambda_of(1e6, nu, true, false);
    EXPECT_DOUBLE_EQ(split.at_points + split.of_mean, full.at_points);
    EXPECT_NEAR(split.of_mean / full.at_points, std::max(0.0, 1 - (1 - 2 * nu) / (2 * nu)), 1e-12);
    EXPECT_EQ(linear.at_points, 0);
    EXPECT_EQ(full.of_mean, 0);
  }
}

TEST(Volumetric, WhoSwitchesAveragesOffIsToldAndNotGraded) {
  EXPECT_EQ(locking_risks(pad(1, 0.499, "full")).size(), 1u);
  EXPECT_TRUE(locking_risks(pad(1, 0.45, "full")).empty()) << "quadratic elements hardly lock there";
  EXPECT_EQ(locking_risks(pad(2, 0.45, "full", false)).size(), 1u);
}

}  // namespace mortise::audit
