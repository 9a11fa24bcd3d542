// Shear of what came to touch within a step (audit/touch_lag.h).
#include "audit/touch_lag.h"

#include <fmt/format.h>

#include <cmath>

#include "base/memory_archive.h"
#include "rig.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

struct Pressed {
  double shear = 0, lag = 0;
};

// A stiff ball on its way into a pad, by the motion `ways`, or the pad on its way into the ball. kept: the watch goes through an archive in the
// middle.
Pressed press(int steps, double mu, const std::string& contact, const std::string& ways, bool kept = false, bool pad_moves = false) {
  Rig rig(fmt::format(R"(
mortise: 1
name: aslant
time: {{mode: static, steps: {}}}
materials: {{gel: {{youngs_modulus: 0.2 MPa, poisson_ratio: 0.3, density: 1050}}, steel: {{density: 7800}}}}
bodies:
  pad: {{type: soft, shape: {{box: {{size: [14 mm, 14 mm, 6 mm], edge_length: 1.2 mm}}}}, material: gel, position: [0, 0, -3 mm]}}
  ball: {{type: stiff, shape: {{sphere: {{radius: 12 mm, edge_length: 1 mm}}}}, material: steel, position: [0, 0, 12.02 mm]}}
effects:
  elasticity: {{}}
  pin: [{{body: pad, where: {{side: z_min}}{}}}, {{body: ball, where: {{side: all}}{}}}]
  {}: {}
  friction: {{follows: {}, mu: {}}}
)",
                      steps, pad_moves ? ", motion: " + ways : "", pad_moves ? "" : ", motion: " + ways, contact,
                      contact == "mortar_contact" ? "{pairs: [{slave: pad, master: ball}]}" : "{}", contact, mu));
  auto watch = std::make_unique<audit::TouchLag>(rig.input);
  watch->state(rig.fields());
  Pressed out;
  for (int i = 0; i < steps; ++i) {
    const solver::StepReport report = rig.step();
    const Snapshot fields = rig.fields();
    watch->state(fields);
    watch->step(report.substeps);
    out.shear = fields.at("supports/ball_x");
    if (!kept || i != steps / 2) continue;
    MemoryArchive archive;
    watch->checkpoint(archive);
    archive.rewind();
    watch = std::make_unique<audit::TouchLag>(rig.input);
    watch->checkpoint(archive);
  }
  out.lag = watch->share();
  return out;
}

const std::string kAslant = "{time: [0, 1], translation: [[0, 0, 0], [0.3 mm, 0, -0.62 mm]]}";

}  // namespace

// Half of it with twice as many steps, and what the force is too large by.
TEST(TouchLag, IsWhatShearIsTooLargeBy) {
  for (const char* contact : {"barrier_contact", "mortar_contact"}) {
    const double right = 1.5 * press(24, 2, contact, kAslant).shear - 0.5 * press(8, 2, contact, kAslant).shear;  // first order
    double before = INFINITY;
    for (const int steps : {1, 4}) {
      const Pressed at = press(steps, 2, contact, kAslant);
      const double error = at.shear / right - 1;
      EXPECT_GT(at.lag, error / 3.5) << contact << ' ' << steps;
      EXPECT_LT(at.lag, 3.5 * error) << contact << ' ' << steps;
      EXPECT_LT(at.lag, 0.7 * before) << contact << ' ' << steps;
      before = at.lag;
    }
  }
}

TEST(TouchLag, APressAndAShoveHaveNone) {
  EXPECT_LT(press(4, 2, "barrier_contact", "{time: [0, 0.5, 1], translation: [[0, 0, 0], [0, 0, -0.62 mm], [0.3 mm, 0, -0.62 mm]]}").lag, 0.01);
}

// Supports that bear nothing yet have gone their way all the same.
TEST(TouchLag, NeitherHasAWayBeforeTheTouch) {
  EXPECT_LT(press(4, 2, "barrier_contact", "{time: [0, 0.5, 1], translation: [[0, 0, 0], [3 mm, 0, 0], [3 mm, 0, 0.62 mm]]}", false, true).lag, 0.04);
  EXPECT_GT(press(4, 2, "barrier_contact", "{time: [0, 1], translation: [[0, 0, 0], [0.3 mm, 0, 0.62 mm]]}", false, true).lag, 0.05);
}

TEST(TouchLag, AStraightPressHasNone) {
  EXPECT_LT(press(1, 0.5, "barrier_contact", "{time: [0, 1], translation: [[0, 0, 0], [0, 0, -0.62 mm]]}").lag, 1e-3);
}

TEST(TouchLag, GoesOnFromACheckpoint) { EXPECT_EQ(press(4, 2, "barrier_contact", kAslant).lag, press(4, 2, "barrier_contact", kAslant, true).lag); }
