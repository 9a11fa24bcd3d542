// What goes beside a run and does a hair of what it leaves undone: its differences, over the hair, against better runs.
#include <cmath>

#include "geometry/refine.h"
#include "rig.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

constexpr double kHair = 1e-5;

// A block, 20 x 20 x 10 mm, between a plate and its supports: F = E A (travel + gap) / L.
constexpr const char* kPatch = R"(
mortise: 1
name: patch
time: {mode: static, steps: 1}
materials:
  gel: {model: linear, youngs_modulus: 0.1 MPa, poisson_ratio: 0.3, density: 1000}
bodies:
  block: {type: soft, shape: {box: {size: [20 mm, 20 mm, 10 mm], edge_length: 5 mm}}, material: gel, position: [10 mm, 10 mm, 5 mm]}
  plate: {type: stiff, shape: {box: {size: [30 mm, 30 mm, 4 mm], edge_length: 6 mm}}, material: gel, position: [10 mm, 10 mm, 12.2 mm]}
effects:
  elasticity: {}
  pin:
    - {body: block, where: {side: x_min}, axes: x}
    - {body: block, where: {side: y_min}, axes: y}
    - {body: block, where: {side: z_min}, axes: z}
    - {body: plate, where: {side: all}, motion: {time: [0, 1], translation: [[0, 0, 0], [0, 0, -0.7 mm]]}}
  CONTACT
solver: {relative_tolerance: 1e-10}
)";

std::string patch(const std::string& contact) {
  std::string out = kPatch;
  return out.replace(out.find("CONTACT"), 7, contact);
}

// A cantilever of soft rubber that bends under its weight, more than a little where it is neo-Hookean.
constexpr const char* kBeam = R"(
mortise: 1
name: beam
time: {mode: static, steps: 2}
materials:
  gel: {model: MODEL, youngs_modulus: 0.1 MPa, poisson_ratio: 0.3, density: 1000}
bodies:
  beam: {type: soft, shape: {box: {size: [40 mm, 10 mm, 10 mm], edge_length: 5 mm}}, material: gel, position: [20 mm, 0, 0]}
effects:
  elasticity: {}
  gravity: {acceleration: [0, 0, -9.81]}
  pin: [{body: beam, where: {side: x_min}}]
solver: {relative_tolerance: 1e-10}
)";

std::string beam(const std::string& model) {
  std::string out = kBeam;
  return out.replace(out.find("MODEL"), 5, model);
}

solver::Departure fitting(solver::Departure by) {
  by.fits = true;
  return by;
}

// Number of the lowest point.
std::size_t lowest(const std::vector<double>& points) {
  std::size_t best = 0;
  for (std::size_t i = 0; i < points.size(); i += 3)
    if (points[i + 2] < points[best + 2]) best = i;
  return best;
}

}  // namespace

TEST(Beside, AThinnerLayerTellsWhatItsGapAddsToAForce) {
  for (const auto& [contact, of] : {std::pair{"mortar_contact: {d_hat: %g mm, stiffness: 0.1 MPa, pairs: [{slave: block, master: plate}]}", 0.1},
                                    std::pair{"mortar_contact: {d_hat: %g mm, stiffness: 0.1 MPa, pairs: [{slave: block, master: plate}]}", 0.02},
                                    std::pair{"barrier_contact: {d_hat: %g mm, stiffness: 1 MPa}", 0.1}}) {
    SCOPED_TRACE(contact);
    const auto rig = [&](double d_hat) {
      char text[200];
      std::snprintf(text, sizeof text, contact, d_hat);
      return Rig(patch(text));
    };
    Rig base = rig(of), thinner = rig(of * (1 - kHair));
    Rig::check(base.engine->lead({{thinner.engine.get(), fitting({})}}));
    base.step();
    const double force = base.fields().at("supports/plate_z"), error = (thinner.fields().at("supports/plate_z") - force) / kHair;
    ASSERT_GT(std::abs(force), 2.04);
    EXPECT_NEAR(force + error, -2, 0.1 * (std::abs(force) - 2));
  }
}

TEST(Beside, OneMoreStepOfNewtonTellsWhatItLeft) {
  const auto run = [&](const std::string& tolerance) {
    return std::make_unique<Rig>(beam("neo_hookean"), std::vector<std::string>{"time.steps=1", "solver.relative_tolerance=" + tolerance});
  };
  const auto exact = run("1e-11"), rough = run("0.01"), beside = run("0.01");
  exact->step();
  Rig::check(rough->engine->lead({{beside->engine.get(), fitting({.residual = kHair})}}));
  rough->step();
  const std::vector<double> best = exact->engine->points(), points = rough->engine->points(), there = beside->engine->points();
  const std::size_t tip = lowest(best) + 2;
  const double missing = best[tip] - points[tip];
  ASSERT_GT(std::abs(missing), 1e-11);
  EXPECT_NEAR((there[tip] - points[tip]) / kHair, missing, 0.1 * std::abs(missing));
}

// All that linear elements leave of the equations of quadratic ones, taken away at once: in linear elasticity that is their solution.
TEST(Beside, WhatQuadraticElementsMissIsTheirSolution) {
  const std::vector<std::string> richer{"bodies.beam.order=2"};
  Rig base(beam("linear")), shadow(beam("linear"), richer), all(beam("linear"), richer), hair(beam("linear"), richer), quadratic(beam("linear"), richer);
  Rig::check(base.engine->cast(*shadow.engine));
  Rig::check(shadow.engine->lead({{all.engine.get(), fitting({.residual = 1})}, {hair.engine.get(), fitting({.residual = kHair})}}));
  base.steps(2), quadratic.steps(2);
  for (Rig* r : {&shadow, &all, &hair}) ASSERT_EQ(r->engine->lost(), "");

  const std::vector<double> linear = base.engine->points(), lifted = shadow.engine->points(), found = all.engine->points(), near = hair.engine->points(),
                            solved = quadratic.engine->points();
  for (std::size_t i = 0; i < linear.size(); ++i) EXPECT_NEAR(lifted[i], linear[i], 1e-16) << "corners come first";
  const model::BodyInput& body = shadow.input.bodies[0];
  for (int k = 0; k < 3; ++k)  // the first middle lies between the first two corners
    EXPECT_NEAR(lifted[3 * body.midsides[0].v[0] + k], 0.5 * (linear[3 * body.tets[0].v[0] + k] + linear[3 * body.tets[0].v[1] + k]), 1e-16);
  const std::size_t tip = lowest(solved) + 2;
  const double missing = solved[tip] - lifted[tip];
  ASSERT_GT(std::abs(missing), 0.1 * std::abs(solved[tip] + 5e-3)) << "linear elements of this size are far too stiff";
  EXPECT_NEAR(found[tip] - lifted[tip], missing, 0.02 * std::abs(missing));
  EXPECT_NEAR((near[tip] - lifted[tip]) / kHair, missing, 0.02 * std::abs(missing));
}

// The same of quadratic elements that are cut into eight.
TEST(Beside, WhatQuadraticElementsMissIsTheSolutionOfSmallerOnes) {
  Rig base(beam("linear"), {"bodies.beam.order=2", "bodies.beam.shape.box.edge_length=10 mm"});
  model::ModelInput finer = base.input;
  model::BodyInput& body = finer.bodies[0];
  model::set_mesh(body, geometry::refined({body.nodes, body.tets, body.midsides}));
  Rig shadow(finer), beside(finer), solved(finer);
  Rig::check(base.engine->cast(*shadow.engine));
  Rig::check(shadow.engine->lead({{beside.engine.get(), fitting({.residual = kHair})}}));
  base.steps(2), solved.steps(2);
  ASSERT_EQ(beside.engine->lost(), "");
  const std::vector<double> there = shadow.engine->points(), near = beside.engine->points(), best = solved.engine->points();
  const std::size_t tip = lowest(best) + 2;
  const double missing = best[tip] - there[tip];
  EXPECT_NEAR((near[tip] - there[tip]) / kHair, missing, 0.02 * std::abs(missing));
}

// A scene that remembers nothing may be joined at any of its steps.
TEST(Beside, JoinsWhereTheLeaderStands) {
  const std::vector<std::string> richer{"bodies.beam.order=2"};
  const auto found = [&](int late) {
    Rig base(beam("neo_hookean")), own(beam("neo_hookean")), shadow(beam("neo_hookean"), richer), beside(beam("neo_hookean"), richer);
    base.steps(late);
    Rig::check(base.engine->cast(*shadow.engine));
    Rig::check(shadow.engine->lead({{beside.engine.get(), fitting({.residual = kHair})}}));
    Rig::check(base.engine->lead({{own.engine.get(), fitting({.residual = 1})}}));
    base.steps(2 - late);
    EXPECT_EQ(own.engine->time(), base.engine->time());
    EXPECT_EQ(beside.engine->steps_done(), 2);
    const std::vector<double> a = base.engine->points(), b = own.engine->points();
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-9);
    return beside.engine->points();
  };
  const std::vector<double> early = found(0), late = found(1);
  for (std::size_t i = 0; i < early.size(); ++i) EXPECT_NEAR(early[i], late[i], 1e-10);
}

namespace {

// A bar that hangs and is let go rings.
constexpr const char* kRings = R"(
mortise: 1
name: rings
time: {step: 1 ms, steps: 20}
materials:
  gel: {model: linear, youngs_modulus: 0.1 MPa, poisson_ratio: 0.3, density: 1000}
bodies:
  bar: {type: soft, shape: {box: {size: [40 mm, 10 mm, 10 mm], edge_length: 5 mm}}, material: gel, position: [20 mm, 0, 0]}
effects:
  elasticity: {}
  gravity: {acceleration: [9.81, 0, 0]}
  inertia: {integrator: INTEGRATOR}
  pin: [{body: bar, where: {side: x_min}}]
solver: {relative_tolerance: 1e-10}
)";

// Estimated and true error of the elastic energy after 13 ms, with steps of `step` ms.
std::pair<double, double> of_steps(const std::string& integrator, double step) {
  std::string scene = kRings;
  scene.replace(scene.find("INTEGRATOR"), 10, integrator);
  const auto rig = [&](double ms) { return std::make_unique<Rig>(scene, std::vector<std::string>{"time.step=" + std::to_string(ms) + " ms"}); };
  const auto base = rig(step), beside = rig(step), fine = rig(step / 16);
  Rig::check(base->engine->lead({{beside->engine.get(), fitting({.integrator = kHair})}}));
  const int steps = static_cast<int>(std::lround(13 / step));
  base->steps(steps), fine->steps(16 * steps);
  EXPECT_EQ(beside->engine->lost(), "");
  const double energy = base->fields().at("elasticity/energy");
  return {(beside->fields().at("elasticity/energy") - energy) / kHair, fine->fields().at("elasticity/energy") - energy};
}

}  // namespace

TEST(Beside, AnIntegratorOfTheNextOrderTellsTheErrorOfTheSteps) {
  const auto [euler, true_euler] = of_steps("backward_euler", 0.25);
  EXPECT_NEAR(euler, true_euler, 0.35 * std::abs(true_euler));
  const auto [bdf2, true_bdf2] = of_steps("bdf2", 0.25);
  EXPECT_NEAR(bdf2, true_bdf2, 0.35 * std::abs(true_bdf2));
  EXPECT_LT(std::abs(bdf2), 0.2 * std::abs(euler));
}
