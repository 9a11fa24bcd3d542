// Friction that is sampled at the corners of a face takes away what corners do.
#include "audit/slip_sampling.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/memory_archive.h"
#include "tables.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

// A square of two triangles, 2 m wide, that bears on an obstacle.
model::ModelInput square() {
  model::ModelInput input{
      table({{"effects", table({{"friction", table({{"creep_speed", number(1e-5)}, {"follows", Params::make_text("barrier_contact")}})}})}}), {}};
  model::BodyInput plate, floor;
  plate.name = "plate", plate.type = model::BodyType::stiff;
  plate.nodes = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  plate.triangles = {{{0, 2, 1}}, {{0, 3, 2}}};
  floor.name = "floor", floor.type = model::BodyType::half_space;
  input.bodies = {plate, floor};
  return input;
}

// It goes at v and turns at w about z, pressed at every corner with 1 N; friction at the corners, in a step of 0.1 s.
void slips(audit::SlipSampling& sampling, const model::ModelInput& input, const Vec3& v, double w, double mu) {
  Snapshot said;
  std::vector<double> velocity, pressed, force, slip;
  double power = 0;
  for (const Vec3& x : input.bodies[0].nodes) {
    const Vec3 u = v + w * Vec3::UnitZ().cross(x), F = -mu * u.normalized(), s = 0.1 * u;
    velocity.insert(velocity.end(), {u[0], u[1], u[2]}), pressed.insert(pressed.end(), {0, 0, 1});
    force.insert(force.end(), {F[0], F[1], F[2]}), slip.insert(slip.end(), {s[0], s[1], s[2]});
    power -= F.dot(u);
  }
  said.points("displacement", "m", 3, std::vector<double>(12, 0.0));
  said.points("velocity", "m/s", 3, velocity);
  said.points("contact_force", "N", 3, pressed);
  said.rows("barrier_contact", "bodies", "1", 2, std::vector<double>{0, 1, 0, 1, 0, 1, 0, 1});
  said.rows("friction", "force", "N", 3, force);
  said.rows("friction", "slip", "m", 3, slip);
  said.rows("friction", "normal_force", "N", 1, std::vector<double>(4, 1.0));
  said.scalar("friction", "power", "W", power);
  sampling.state(said, audit::rubbing(audit::friction_laws(input), said));
  sampling.step(0.1);
}

}  // namespace

TEST(SlipSampling, IsWhatCornersSlipMoreThanTheFaceBetweenThem) {
  const model::ModelInput input = square();
  // The mean distance from the middle of a square of 2 m, (sqrt 2 + asinh 1) / 3, against that of its corners, sqrt 2.
  const double spin = std::sqrt(2.0) / ((std::sqrt(2.0) + std::asinh(1.0)) / 3) - 1;
  audit::SlipSampling slides(input), spins(input), both(input);
  slips(slides, input, {0.3, 0.1, 0}, 0, 0.5);
  EXPECT_NEAR(slides.share(), 0, 1e-12);
  slips(spins, input, {0, 0, 0}, 2, 0.5);
  EXPECT_NEAR(spins.share(), spin, 0.01);
  // By the energy that friction took away: 2 W of sliding at 1 m/s, 2 sqrt 2 W of spinning at 1/s.
  slips(both, input, {1, 0, 0}, 0, 0.5);
  slips(both, input, {0, 0, 0}, 1, 0.5);
  EXPECT_NEAR(both.share(), spins.share() * std::sqrt(2.0) / (1 + std::sqrt(2.0)), 1e-9);
  MemoryArchive saved;
  both.checkpoint(saved);
  saved.rewind();
  audit::SlipSampling resumed(input);
  resumed.checkpoint(saved);
  EXPECT_EQ(resumed.share(), both.share());
}
