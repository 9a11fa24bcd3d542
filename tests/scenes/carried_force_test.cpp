// What steps make of the swings of what is carried (audit/carried_force.h), against runs of short steps: a block on a soft pad whose table starts at
// once, or is shaken; a block in the pads of a hand that lifts it.
#include <fmt/format.h>

#include "audited.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

struct Jolt {
  double told = 0, force = 0;  // the largest on the block [N]
};

Jolt jolt(double step, const std::string& keys, const std::vector<std::string>& more = {}) {
  std::vector<std::string> overrides = {fmt::format("time.step={}", step)};
  overrides.insert(overrides.end(), more.begin(), more.end());
  Rig rig(fmt::format(R"(
mortise: 1
name: jolt
time: {{step: 5 ms, steps: 1}}
materials: {{gel: {{youngs_modulus: 0.3 MPa, poisson_ratio: 0.4, density: 1000}}, al: {{density: 2700}}}}
bodies:
  table: {{type: stiff, shape: {{box: {{size: [60 mm, 40 mm, 4 mm], edge_length: 40 mm}}}}, material: al, position: [0, 0, -7 mm]}}
  pad: {{type: soft, shape: {{box: {{size: [20 mm, 20 mm, 10 mm], edge_length: 5 mm}}}}, material: gel}}
  block: {{type: stiff, shape: {{box: {{size: [20 mm, 20 mm, 20 mm], edge_length: 20 mm}}}}, material: al, position: [0, 0, 15 mm]}}
effects:
  inertia: {{}}
  elasticity: {{}}
  affine_body: {{}}
  pin: [{{body: table, where: {{side: all}}, motion: {{{}}}}}]
  bond:
    - {{name: below, body: pad, to: table, where: {{side: z_min}}}}
    - {{name: above, body: pad, to: block, where: {{side: z_max}}}}
)",
                      keys),
          overrides);
  Jolt out;
  const auto look = [&](const solver::StepReport&, const Captured& said) {
    out.force = std::fmax(out.force, std::abs(said.at("bond/above_force_x")));
  };
  out.told = audited(rig, std::lround(0.12 / step), look).carried_force;
  return out;
}

}  // namespace

TEST(CarriedForce, IsWhatTheLargestForceIsShortOf) {
  const std::string starts = "time: [0, 0.04, 0.24], translation: [[0, 0, 0], [0, 0, 0], [30 mm, 0, 0]], interpolation: smooth";
  const double exact = jolt(0.1e-3, starts).force;
  for (const double step : {5e-3, 2.5e-3, 1e-3}) {
    const Jolt run = jolt(step, starts);
    const double missing = 1 - run.force / exact;
    EXPECT_GT(missing, 0.1);
    EXPECT_NEAR(run.told, missing, 0.4 * missing) << step;
  }
  const Jolt run = jolt(5e-3, starts, {"effects.inertia.integrator=bdf2"});
  EXPECT_NEAR(run.told, std::abs(1 - run.force / exact), 0.05) << "bdf2: " << run.force << " of " << exact;
}

TEST(CarriedForce, IsNothingWhereNothingStartsAtOnce) {
  EXPECT_EQ(jolt(5e-3, "time: [0, 1], translation: [[0, 0, 0], [0.1, 0, 0]]").told, 0) << "an even pace from the start";
  std::string times, ways;
  for (int k = 0; k <= 96; ++k) {
    const double t = 2 * M_PI * k / 96;
    times += fmt::format("{}{}", k ? ", " : "", 2.5e-3 * k), ways += fmt::format("{}[{}, 0, 0]", k ? ", " : "", 5e-3 * (t - std::sin(t)));
  }
  EXPECT_LT(jolt(2.5e-3, "time: [" + times + "], translation: [" + ways + "], interpolation: smooth").told, 0.05) << "a cycloid";
}

// Beside what presses it from two sides a block swings in the pads of a hand that starts at once to lift it.
TEST(CarriedForce, IsThatOfABlockInAHand) {
  const auto lift = [](double step, const char* integrator) {
    Rig rig(R"(
mortise: 1
name: hand
time: {step: 5 ms, steps: 1}
materials: {gel: {youngs_modulus: 0.3 MPa, poisson_ratio: 0.3, density: 1000}}
bodies:
  left: {type: stiff, shape: {box: {size: [6 mm, 20 mm, 20 mm], edge_length: 20 mm}}, mass: 0.1, position: [-32 mm, 0, 0]}
  right: {type: stiff, shape: {box: {size: [6 mm, 20 mm, 20 mm], edge_length: 20 mm}}, mass: 0.1, position: [32 mm, 0, 0]}
  one: {type: soft, shape: {box: {size: [8 mm, 20 mm, 20 mm], edge_length: 8 mm}}, order: 2, material: gel, position: [-25 mm, 0, 0]}
  other: {type: soft, shape: {box: {size: [8 mm, 20 mm, 20 mm], edge_length: 8 mm}}, order: 2, material: gel, position: [25 mm, 0, 0]}
  block: {type: stiff, shape: {box: {size: [41.9 mm, 30 mm, 30 mm], edge_length: 50 mm}}, mass: 0.6}
effects:
  inertia: {}
  elasticity: {}
  affine_body: {}
  mortar_contact: {pairs: [{slave: one, master: block}, {slave: other, master: block}]}
  friction: {mu: 0.9, follows: mortar_contact}
  pin:
    - {body: left, where: {side: all}, motion: {time: [0, 0.06, 0.15, 0.3], translation: [[0, 0, 0], [1 mm, 0, 0], [1 mm, 0, 0], [1 mm, 0, 5 mm]]}}
    - {body: right, where: {side: all}, motion: {time: [0, 0.06, 0.15, 0.3], translation: [[0, 0, 0], [-1 mm, 0, 0], [-1 mm, 0, 0], [-1 mm, 0, 5 mm]]}}
  bond:
    - {body: one, to: left, where: {side: x_min}}
    - {body: other, to: right, where: {side: x_max}}
)",
            {fmt::format("time.step={}", step), fmt::format("effects.inertia.integrator={}", integrator)});
    Jolt out;
    out.told = audited(rig, std::lround(0.28 / step), [&](const solver::StepReport&, const Captured& said) {
                 out.force = std::fmax(out.force, std::abs(said.at("friction/force_block_z")));
               }).carried_force;
    return out;
  };
  const double exact = lift(2e-3, "bdf2").force;
  const Jolt run = lift(5e-3, "backward_euler");
  const double missing = 1 - run.force / exact;
  EXPECT_GT(missing, 0.1);
  EXPECT_NEAR(run.told, missing, 0.5 * missing);
}
