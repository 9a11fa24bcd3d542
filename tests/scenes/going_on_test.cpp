// What certificates say of the time step does not depend on how fast bodies go besides (audit/spin_loss.h, steady_motion.h), and of soft bodies that
// swing for long (audit/soft_phase.h).
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>

#include "audited.h"
#include "base/memory_archive.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

// It slides over a floor at v and spins at w about the vertical.
std::string stone(const std::string& type, double v, double w, const std::string& inertia = "backward_euler") {
  return fmt::format(R"(
mortise: 1
name: stone
time: {{step: 5 ms, steps: 40}}
materials: {{stone: {{youngs_modulus: 1 MPa, poisson_ratio: 0.3, density: 1000}}}}
bodies:
  stone:
    type: {}
    shape: {{cylinder: {{radius: 50 mm, height: 20 mm, edge_length: 20 mm}}}}
    material: stone
    position: [0, 0, 10.1 mm]
    velocity: [{}, 0, 0]
    angular_velocity: [0, 0, {}]
  floor: {{type: half_space}}
effects:
  inertia: {{integrator: {}}}
  gravity: {{}}
  {}: {{}}
  barrier_contact: {{d_hat: 0.2 mm}}
  friction: {{mu: 0.05}}
)",
                     type, v, w, inertia, type == "soft" ? "elasticity" : "affine_body");
}

// A bar that stands on a pin which lets it go along x, and sags under a weight that comes at once.
std::string standing(const std::string& inertia, double v) {
  return fmt::format(R"(
mortise: 1
name: bar
time: {{step: 1 ms, steps: 100}}
materials: {{gel: {{youngs_modulus: 0.1 MPa, poisson_ratio: 0, density: 1000}}}}
bodies:
  bar:
    type: soft
    shape: {{box: {{size: [20 mm, 20 mm, 100 mm], edge_length: 10 mm}}}}
    material: gel
    position: [0, 0, 50 mm]
    velocity: [{}, 0, 0]
effects:
  inertia: {{integrator: {}}}
  elasticity: {{}}
  gravity: {{acceleration: [0, 0, -2]}}
  pin: [{{body: bar, where: {{side: z_min}}, axes: z}}]
)",
                     v, inertia);
}

double share(const Turned& t) { return t.energy.free_loss / t.energy.loss_scale; }

}  // namespace

TEST(SpinLoss, IsThatOfAStoneHoweverFastItSlides) {
  // 2 phi^2 of the energy in a step of phi = 0.1: half of it in 40.
  for (const char* type : {"stiff", "soft"})
    for (const double v : {0.0, 2.0, 10.0}) EXPECT_NEAR(turn(stone(type, v, 20), 40).energy.own_turning, 0.42, 0.08) << type << v;
  EXPECT_LT(turn(stone("stiff", 2, 20, "bdf2"), 40).energy.own_turning, 0.06) << "most of it in the first step";
  EXPECT_LT(turn(stone("stiff", 2, 0.5), 40).energy.own_turning, 1e-3) << "a tenth of a radian";
}

TEST(SpinLoss, GoesOnFromACheckpoint) {
  Rig rig(stone("stiff", 2, 20));
  audit::EnergyAudit audit(rig.input);
  for (int i = 0; i < 20; ++i) {
    rig.step();
    audit.state({rig.fields(), rig.engine->points()}), audit.step(true);
  }
  MemoryArchive saved;
  audit.checkpoint(saved);
  saved.rewind();
  audit::EnergyAudit resumed(rig.input);
  resumed.checkpoint(saved);
  EXPECT_GT(audit.result().own_turning, 0.1);
  EXPECT_EQ(resumed.result().own_turning, audit.result().own_turning);
  EXPECT_EQ(resumed.result().loss_scale, audit.result().loss_scale);
  EXPECT_EQ(resumed.result().free_loss, audit.result().free_loss);
}

TEST(SteadyMotion, IsNoMeasureOfWhatVibratesInIt) {
  const double at_rest = share(turn(standing("backward_euler", 0), 100));
  EXPECT_GT(at_rest, 0.15);
  for (const double v : {1.0, 10.0}) EXPECT_NEAR(share(turn(standing("backward_euler", v), 100)), at_rest, 0.01 * at_rest) << v;
}

TEST(SoftPhase, IsHowFarABarIsOff) {
  // c = 10 m/s, a period of 40 ms; phi = (omega h)^3 / 3 in a step.
  for (const double h : {0.5e-3, 1e-3}) {
    const double omega_h = 2 * M_PI * h / 0.04, steps = std::round(0.4 / h);
    const Turned t = turn(standing("bdf2", 0), static_cast<int>(steps), {fmt::format("time.step={}", h)});
    const double phase = std::pow(omega_h, 3) / 3 * steps;
    EXPECT_GT(t.energy.motion_lag, 0.6 * phase) << h;
    EXPECT_LT(t.energy.motion_lag, 1.5 * phase) << h;
  }
  EXPECT_FALSE(turn(standing("backward_euler", 0), 100).energy.motion_lag > 0.05);
}
