// Of a stiff body that hardly goes its own strain is a part of what is seen at its ends.
#include "audit/stiff_strain.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/memory_archive.h"
#include "tables.h"

using namespace mortise;
using namespace mortise::testing;

TEST(StiffStrain, IsAShareOfTheFarthestWay) {
  model::ModelInput input{table({{"effects", Params::make_table()}}), {}};
  model::BodyInput post;
  post.name = "post", post.type = model::BodyType::stiff;
  for (double x : {-0.1, 0.1})
    for (double y : {-0.1, 0.1})
      for (double z : {-1.0, 1.0}) post.nodes.push_back({x, y, z});
  input.bodies = {post};
  // Goes up, turns, and is longer by 1e-4: its ends are 1e-4 m from where they would be.
  const auto share = [&](double up, double angle) {
    const Mat3 R = Eigen::AngleAxisd(angle, Vec3::UnitX()).toRotationMatrix();
    std::vector<double> u;
    for (const Vec3& x : post.nodes) {
      const Vec3 moved = R * Vec3(x[0], x[1], (1 + 1e-4) * x[2]) + Vec3(0, 0, up) - x;
      u.insert(u.end(), {moved[0], moved[1], moved[2]});
    }
    Snapshot said;
    said.points("displacement", "m", 3, u);
    audit::StiffStrain strain(input);
    strain.state(said);
    MemoryArchive saved;
    strain.checkpoint(saved);
    saved.rewind();
    audit::StiffStrain resumed(input);
    resumed.checkpoint(saved);
    EXPECT_EQ(resumed.share(), strain.share());
    return strain.share();
  };
  EXPECT_NEAR(share(4e-3, 0), 1e-4 / 4.1e-3, 1e-6);
  EXPECT_NEAR(share(0, 0), 1e-4 / (1e-3 * std::sqrt(1.02)), 1e-4) << "it hardly goes";
  EXPECT_LT(share(0, 0.1), 1.1e-3) << "its ends go 0.1 m";
  input.bodies.clear();
  EXPECT_TRUE(std::isnan(audit::StiffStrain(input).share()));
}
