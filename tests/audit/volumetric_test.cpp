// Which bodies are not averaged, and what is told of that.
#include "audit/volumetric.h"

#include <gtest/gtest.h>

#include "geometry/midsides.h"
#include "geometry/primitives.h"

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

TEST(Volumetric, OneQuadraticElementAcrossIsNotAveragedAndDoubted) {
  EXPECT_EQ(volumetric(pad(1, 0.45).bodies[0]), "full");
  EXPECT_EQ(volumetric(pad(2, 0.45).bodies[0]), "averaged over every element");
  EXPECT_EQ(volumetric(pad(1, 0.45, "averaged").bodies[0]), "averaged over every element");
  EXPECT_EQ(single_elements(pad(1, 0.45)).size(), 1u);
  EXPECT_TRUE(single_elements(pad(1, 0.3)).empty());
  EXPECT_TRUE(single_elements(pad(2, 0.45)).empty());
  EXPECT_TRUE(single_elements(pad(1, 0.45, nullptr, false)).empty()) << "linear elements are averaged over stars";
  EXPECT_EQ(locking_risks(pad(1, 0.45)).size(), 1u);
}

TEST(Volumetric, WhoSwitchesAveragesOffIsToldAndNotGraded) {
  EXPECT_TRUE(single_elements(pad(1, 0.499, "full")).empty());
  EXPECT_EQ(locking_risks(pad(1, 0.499, "full")).size(), 1u);
  EXPECT_TRUE(locking_risks(pad(1, 0.45, "full")).empty()) << "quadratic elements hardly lock there";
  EXPECT_EQ(locking_risks(pad(2, 0.45, "full", false)).size(), 1u);
}

}  // namespace mortise::audit
