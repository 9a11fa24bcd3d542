// Of what walks on motors: velocities that jump.
#include "audit/walking_lag.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "../scene_builder.h"
#include "audit/tuning.h"
#include "base/memory_archive.h"
#include "geometry/primitives.h"
#include "tables.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

constexpr double kStep = 0.01;

model::ModelInput walker(const char* integrator) {
  const Params g = table({{"acceleration", [] {
                             Params list = Params::make_list();
                             for (const double a : {0.0, 0.0, -9.81}) list.push(Params::make_number(a));
                             return list;
                           }()}});
  model::ModelInput input;
  input.scene = table({{"time", table({{"step", number(kStep)}})},
                       {"effects", table({{"inertia", table({{"integrator", Params::make_text(integrator)}})}, {"gravity", g}})}});
  input.bodies.push_back(stiff_body("trunk", geometry::box({0.2, 0.1, 0.1}, 0.1), material("linear", 1e9, 0.3, 1000)));
  return input;
}

// Of so many steps with these velocities; half of the way before a restart.
double lag(const std::function<Vec3(double)>& velocity, const char* integrator = "bdf2", bool walks = true) {
  const model::ModelInput input = walker(integrator);
  const audit::MeasuredBody body(input.bodies[0], 0);
  std::vector<double> points;
  for (const Vec3& x : input.bodies[0].nodes) points.insert(points.end(), {x[0], x[1], x[2]});
  audit::HowHeld how{};
  how.swings = !walks;
  audit::WalkingLag out(input);
  Vec3 x = Vec3::Zero();
  for (int n = 0; n <= 100; ++n) {
    const Vec3 v = velocity(n * kStep);
    if (n > 0) x += kStep * v;
    out.state(points, {audit::MovingBody{
                          how, body, x, v, Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), false, false, Vec3::Zero(), Vec3::Zero(), {}, false, 0.0}});
    if (n != 50) continue;
    MemoryArchive saved;
    out.checkpoint(saved);
    saved.rewind();
    out = audit::WalkingLag(input);
    out.checkpoint(saved);
  }
  return out.value();
}

}  // namespace

TEST(WalkingLag, CountsVelocitiesThatJump) {
  // A jump by 0.3 m/s is in two second differences; the way is 0.5 m and 0.15 m.
  const auto jumps = [](double t) { return Vec3(t > 0.495 ? 0.8 : 0.5, 0, 0); };
  EXPECT_NEAR(lag(jumps), audit::tuning::kWalks * kStep / 4 * 0.6 / (0.5 + 51 * kStep * 0.3), 1e-9);
  EXPECT_EQ(lag([](double) { return Vec3(0.5, 0, 0); }), 0);
  EXPECT_LT(lag([](double t) { return Vec3(0.5 * std::sin(M_PI * t), 0, 0); }), 0.01) << "smooth";
  EXPECT_NEAR(lag([](double t) { return Vec3(0.5, 0, t > 0.495 ? 1 : 0); }), 0, 1e-12) << "as it comes down";
}

TEST(WalkingLag, CountsAllChangesOfVelocityWithBackwardEuler) {
  const auto cycles = [](double t) { return Vec3(0.5 + 0.2 * std::sin(2 * M_PI * t), 0, 0); };
  const double changes = 4 * 0.2, way = 0.5;
  EXPECT_NEAR(lag(cycles, "backward_euler"), audit::tuning::kWalksDamped * kStep / 2 * changes / way, 1e-3);
  EXPECT_EQ(lag([](double) { return Vec3(0.5, 0, 0); }, "backward_euler"), 0);
}

TEST(WalkingLag, IsOfWhatWalks) {
  const auto jumps = [](double t) { return Vec3(t > 0.495 ? 0.8 : 0.5, 0, 0); };
  for (const char* integrator : {"backward_euler", "bdf2"}) EXPECT_TRUE(std::isnan(lag(jumps, integrator, false)));
}
