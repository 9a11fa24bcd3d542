// What a time step makes of forces on what stays in touch, and of slip that turns round, against closed forms (audit/late_inertia.h,
// slip_reversal.h).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "audited.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

struct Seen {
  audit::EnergyAudit::Result energy;
  std::vector<double> values;  // of what was asked for, after every step
};

Seen seen(const std::string& scene, int steps, const std::string& scalar) {
  Rig rig(scene);
  Seen out;
  out.energy = audited(rig, steps, [&](const solver::StepReport&, const Captured& said) { out.values.push_back(said.at(scalar)); });
  return out;
}

// A block of 0.5 kg that a spring of 500 N/m draws over a floor with 50 mm/s: from stick to stick its force goes from mu m g + v sqrt(k m) to as much
// less.
Seen stick_slip(const char* integrator, double step) {
  return seen(fmt::format(R"(
mortise: 1
name: drawn
time: {{step: {}, steps: 1}}
bodies:
  block: {{type: stiff, shape: {{box: {{size: [40 mm, 40 mm, 20 mm], edge_length: 40 mm}}}}, mass: 0.5, position: [0, 0, 10.1 mm]}}
  hook: {{type: stiff, shape: {{box: {{size: [5 mm, 5 mm, 5 mm], edge_length: 5 mm}}}}, mass: 0.001, position: [0, 0, 50 mm]}}
  puller: {{type: stiff, shape: {{box: {{size: [10 mm, 10 mm, 10 mm], edge_length: 10 mm}}}}, mass: 0.1, position: [-100 mm, 0, 50 mm]}}
  floor: {{type: half_space}}
effects:
  inertia: {{integrator: {}}}
  gravity: {{}}
  affine_body: {{}}
  joint:
    - {{name: s, type: prismatic, body: hook, to: puller, axis: [1, 0, 0]}}
    - {{name: z, type: prismatic, body: block, to: hook, axis: [0, 0, 1]}}
  drive: [{{joint: s, mode: passive, stiffness: 500}}]
  pin: [{{body: puller, where: {{side: all}}, motion: {{time: [0, 1], translation: [[0, 0, 0], [50 mm, 0, 0]]}}}}]
  barrier_contact: {{}}
  friction: {{mu: 0.4}}
)",
                          step, integrator),
              static_cast<int>(std::lround(0.6 / step)), "joint/s_travel");
}

// A slide of 0.5 kg with a pad under it that a motor of 2000 N/m holds on a floor, and moves 2 mm down at once.
Seen stepped(const char* integrator, double step) {
  return seen(fmt::format(R"(
mortise: 1
name: stepped
time: {{step: {}, steps: 1}}
materials: {{rubber: {{youngs_modulus: 0.4 MPa, poisson_ratio: 0.3, density: 1100}}}}
bodies:
  slide: {{type: stiff, shape: {{box: {{size: [20 mm, 20 mm, 20 mm], edge_length: 20 mm}}}}, mass: 0.5, position: [0, 0, 30.06 mm]}}
  pad: {{type: soft, shape: {{box: {{size: [20 mm, 20 mm, 20 mm], edge_length: 7 mm}}}}, order: 2, material: rubber, position: [0, 0, 10.06 mm]}}
  floor: {{type: half_space}}
effects:
  inertia: {{integrator: {}}}
  elasticity: {{}}
  affine_body: {{}}
  joint: [{{name: s, type: prismatic, body: slide, axis: [0, 0, 1]}}]
  drive: [{{joint: s, mode: pd, kp: 2000, kd: 5, travel: {{time: [0, 150 ms, 250 ms, 255 ms], value: [0, -1 mm, -1 mm, -3 mm]}}}}]
  bond: [{{body: pad, to: slide, where: {{side: z_max}}}}]
  mortar_contact: {{pairs: [{{slave: pad, master: floor}}]}}
)",
                          step, integrator),
              static_cast<int>(std::lround(0.35 / step)), "mortar_contact/force_pad_z");
}

// A block on a tray that goes to and fro by 20 mm, 2.5 times a second; how far it slips.
Seen shaken(const char* integrator, double step) {
  Rig rig(fmt::format(R"(
mortise: 1
name: shaken
time: {{step: {}, steps: 1}}
bodies:
  tray: {{type: stiff, shape: {{box: {{size: [200 mm, 100 mm, 20 mm], edge_length: 200 mm}}}}, mass: 1, position: [0, 0, -10 mm]}}
  block: {{type: stiff, shape: {{box: {{size: [40 mm, 40 mm, 20 mm], edge_length: 40 mm}}}}, mass: 0.5, position: [0, 0, 10.05 mm]}}
effects:
  inertia: {{integrator: {}}}
  gravity: {{}}
  affine_body: {{}}
  barrier_contact: {{}}
  friction: {{mu: 0.2}}
  joint: [{{name: s, type: prismatic, body: tray, axis: [1, 0, 0]}}]
  drive: [{{joint: s, mode: kinematic, travel: 20 mm, sine: {{travel: -20 mm, frequency: 2.5, phase: 90 deg}}}}]
)",
                      step, integrator));
  Seen out;
  const std::size_t tray = rig.input.bodies[0].nodes.size();
  const std::vector<double> start = rig.engine->points();
  out.energy = audited(rig, static_cast<int>(std::lround(2 / step)), [&](const solver::StepReport&, const Captured&) {
    const std::vector<double> x = rig.engine->points();
    out.values.push_back(x[3 * tray] - start[3 * tray] - (x[0] - start[0]));
  });
  return out;
}
double range(const std::vector<double>& v) {
  const auto [low, high] = std::minmax_element(v.begin() + static_cast<long>(v.size() / 2), v.end());
  return *high - *low;
}

}  // namespace

// The less of the smallest force is missing, the shorter the step; what is told is within a half of it.
TEST(LateInertia, IsWhatStickSlipIsDampedBy) {
  const double slides = 0.4 * 0.5 * 9.81, swings = 0.05 * std::sqrt(500 * 0.5);
  for (const auto& [integrator, step] : {std::pair{"backward_euler", 0.01}, {"backward_euler", 0.005}, {"backward_euler", 0.0025}, {"bdf2", 0.02}}) {
    const Seen s = stick_slip(integrator, step);
    const auto first =
        std::max_element(s.values.begin(), s.values.begin() + static_cast<long>(0.15 / step), [](double a, double b) { return -a < -b; });
    double least = INFINITY;
    for (auto it = first; it != s.values.end(); ++it) least = std::min(least, -500 * *it);
    const double wrong = (least - (slides - swings)) / slides;
    EXPECT_GT(s.energy.late_inertia, 0.5 * wrong) << integrator << ' ' << step << ' ' << wrong;
    EXPECT_LT(s.energy.late_inertia, 1.5 * wrong) << integrator << ' ' << step << ' ' << wrong;
  }
}

// 7.65 N at most, as a mass on the springs of motor and pad has it.
TEST(LateInertia, IsWhatIsMissingOfAPeakWhereATargetSteps) {
  for (const auto& [integrator, step] : {std::pair{"backward_euler", 0.005}, {"backward_euler", 0.002}, {"bdf2", 0.005}}) {
    const Seen s = stepped(integrator, step);
    const double missing = 1 - *std::max_element(s.values.begin(), s.values.end()) / 7.65;
    EXPECT_GT(missing, 0.07) << integrator << ' ' << step;
    EXPECT_NEAR(s.energy.late_inertia, missing, 0.3 * missing) << integrator << ' ' << step;
  }
}

// Slips of 31.24 mm, by the law of Coulomb: backward Euler has them, BDF2 a quarter more at 5 ms and half more at 10.
TEST(SlipReversal, IsWhatBdf2SlipsTooFar) {
  const Seen euler = shaken("backward_euler", 0.005), five = shaken("bdf2", 0.005), ten = shaken("bdf2", 0.01);
  EXPECT_NEAR(range(euler.values), 0.03124, 0.0003);
  EXPECT_TRUE(std::isnan(euler.energy.slip_reversal));
  EXPECT_LT(euler.energy.own_loss, 0.05);
  for (const Seen& s : {five, ten}) {
    const double wrong = range(s.values) / 0.03124 - 1;
    EXPECT_GT(wrong, 0.15);
    EXPECT_GT(s.energy.slip_reversal, 0.4 * wrong);
    EXPECT_LT(s.energy.slip_reversal, 1.5 * wrong);
  }
}

// The same slip on dry friction of a slide that sits on what is shaken: 6.91 mm, of which BDF2 makes 9.8 at 5 ms. A mass that swings on a spring
// turns round as often, and its slips are right to 0.1 %.
TEST(SlipReversal, IsThatOfBearingsToo) {
  const auto shaken = [](double step, const char* base) {
    return seen(fmt::format(R"(
mortise: 1
name: bearing
time: {{step: {}, steps: 1}}
bodies:
  base: {{type: stiff, shape: {{box: {{size: [200 mm, 100 mm, 20 mm], edge_length: 200 mm}}}}, mass: 1, position: [0, 0, -10 mm]}}
  block: {{type: stiff, shape: {{box: {{size: [40 mm, 40 mm, 20 mm], edge_length: 40 mm}}}}, mass: 0.5, position: [0, 0, 30 mm]}}
effects:
  inertia: {{integrator: bdf2}}
  affine_body: {{}}
  joint:
    - {{name: s, type: prismatic, body: base, axis: [1, 0, 0]}}
    - {{name: b, type: prismatic, body: block, to: base, axis: [1, 0, 0], travel: 40 mm}}
  drive: [{}]
)",
                            step, base),
                static_cast<int>(std::lround(1.5 / step)), "joint/b_travel");
  };
  const char* shakes =
      "{joint: s, mode: kinematic, travel: 8 mm, sine: {travel: -8 mm, frequency: 4, phase: 90 deg}}, "
      "{joint: b, mode: passive, friction: 1.4715}";
  const double wrong = range(shaken(0.005, shakes).values) / 0.006906 - 1;
  EXPECT_GT(wrong, 0.3);
  EXPECT_GT(shaken(0.005, shakes).energy.slip_reversal, 0.1);
  EXPECT_FALSE(shaken(0.001, shakes).energy.slip_reversal > 0.05);
  EXPECT_FALSE(
      shaken(0.005, "{joint: s, mode: kinematic, travel: 0}, {joint: b, mode: passive, stiffness: 200, friction: 0.49}").energy.slip_reversal > 0);
}
