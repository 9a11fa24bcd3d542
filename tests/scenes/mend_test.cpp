// What numbers of a run are wrong by, from scenes that go beside it and mend a share of that (solver/follow.cpp), against motions that are known.
#include <fmt/format.h>

#include <cmath>

#include "link.h"
#include "patch.h"
#include "rig.h"
#include "slide.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

constexpr double kShare = 1e-4;

using Measured = std::function<double(const Captured&)>;

struct Lack {
  double value, below, above;  // what is to be added, mended by less than nothing and by more
  double found() const { return (below + above) / 2; }
};

Lack error_of(const std::string& yaml, int steps, effects::Fault fault, const Measured& of, const std::vector<std::string>& sets = {}) {
  Rig base(yaml, sets), less(yaml, sets), more(yaml, sets);
  Rig::check(less.engine->mend(fault, -kShare));
  Rig::check(more.engine->mend(fault, kShare));
  for (Rig* r : {&less, &more, &base}) Rig::check(r->engine->begin());
  Rig::check(base.engine->lead({less.engine.get(), more.engine.get()}));
  base.steps(steps);
  for (Rig* r : {&less, &more}) EXPECT_EQ(r->engine->lost(), "");
  const double value = of(base.fields());
  return {value, (value - of(less.fields())) / kShare, (of(more.fields()) - value) / kShare};
}

Measured scalar(const std::string& name) {
  return [name](const Captured& f) { return f.at(name); };
}

void expect_found(const Lack& e, double truth, double within) {
  EXPECT_NEAR(e.found(), truth - e.value, within * std::abs(truth - e.value)) << e.value << " where " << truth << " is true";
  EXPECT_NEAR(e.below, e.above, 0.02 * std::abs(e.found()));
}

}  // namespace

// z = z0 + v t - g t^2 / 2: differences are exact but for what is mended, from the first step on.
TEST(Mend, WhatFallsIsExactThen) {
  const std::string fall = R"(
mortise: 1
name: fall
time: {step: 5 ms, steps: 20}
materials: {steel: {density: 1000}}
bodies:
  cube: {type: stiff, shape: {box: {size: [20 mm, 20 mm, 20 mm], edge_length: 20 mm}}, material: steel, position: [0, 0, 0], velocity: [0, 0, 1]}
effects:
  inertia: {}
  gravity: {}
  affine_body: {}
)";
  const double t = 0.1, g = 9.81, v = 1 - g * t, m = 8e-3;
  const auto height = [](const Captured& f) { return (*f.of_points("displacement", 3))[2]; };
  for (const char* integrator : {"backward_euler", "bdf2"}) {
    SCOPED_TRACE(integrator);
    const std::string with = std::string("effects.inertia.integrator=") + integrator;
    const Lack z = error_of(fall, 20, effects::Fault::steps, height, {with});
    EXPECT_NEAR(z.value + z.found(), t - g * t * t / 2, 1e-8);
    EXPECT_EQ(std::abs(z.found()) > 1e-4, integrator == std::string("backward_euler"));
    const Lack kinetic = error_of(fall, 20, effects::Fault::steps, scalar("inertia/kinetic_energy"), {with});
    EXPECT_NEAR(kinetic.value + kinetic.found(), m * v * v / 2, 1e-8);
  }
}

// v^2 / (2 mu g), less what friction lets it creep: what steps leave out is known after it has come to rest as well.
TEST(Mend, WhatFrictionStopsHasGoneAsFar) {
  const Lack way = error_of(kSlide, 50, effects::Fault::steps, [](const Captured& f) { return (*f.of_points("displacement", 3))[0]; });
  EXPECT_GT(1 / (2 * 0.3 * 9.81) - way.value, 0.004);
  expect_found(way, 1 / (2 * 0.3 * 9.81), 0.1);
}

TEST(Mend, APendulumIsAsFarAheadAsItIs) {
  const auto [angle, rate] = motion([](double, double a, double) { return kWeight * std::cos(a); }, 0.1);
  for (double dt : {4.0, 1.0, 0.125}) {  // of the last 800: what is mended must not feed on itself
    SCOPED_TRACE(dt);
    const int n = static_cast<int>(std::lround(100 / dt));
    expect_found(error_of(link("", "", dt, "backward_euler"), n, effects::Fault::steps, scalar("joint/hip_angle")), angle, 0.03);
    expect_found(error_of(link("", "", dt, "backward_euler"), n, effects::Fault::steps, scalar("inertia/kinetic_energy")), kInertia * rate * rate / 2,
                 0.15);
    if (dt < 1) continue;
    expect_found(error_of(link("", "", dt, "bdf2"), n, effects::Fault::steps, scalar("joint/hip_angle")), angle, 0.05);
  }
}

// Motors, bearings and rotors know rates at the ends of steps too.
TEST(Mend, DrivesAreMended) {
  const double T = 0.12, S = 0.2, rest = -0.5, D = 5e-4, J = 3e-4, kp = 0.3, kd = 4e-3, aim = 0.4;
  const auto of = [&](const char* drive, const auto& torque) {
    SCOPED_TRACE(drive);
    expect_found(error_of(link("", drive, 0.5, "backward_euler"), 240, effects::Fault::steps, scalar("joint/hip_angle")), motion(torque, T).first,
                 0.06);
  };
  of("mode: passive, stiffness: 0.2, rest: -0.5, armature: 3e-4",
     [&](double, double a, double) { return (kWeight * std::cos(a) - S * (a - rest)) * kInertia / (kInertia + J); });
  of("mode: passive, damping: 5e-4", [&](double, double a, double w) { return kWeight * std::cos(a) - D * w; });
  of("mode: pd, kp: 0.3, kd: 4e-3, angle: 0.4", [&](double, double a, double w) { return kWeight * std::cos(a) + kp * (aim - a) - kd * w; });
}

// Of a static force: what the adjoint says of the gap.
TEST(Mend, GapsAreThoseOfTheAdjoint) {
  for (const char* contact : {"mortar_contact: {pairs: [{slave: block, master: plate}], d_hat: 0.1 mm, stiffness: 0.1 MPa}",
                              "mortar_contact: {pairs: [{slave: block, master: plate}]}", "barrier_contact: {d_hat: 0.1 mm, stiffness: 0.1 MPa}",
                              "barrier_contact: {form: classic, d_hat: 0.1 mm, stiffness: 0.1 MPa}"}) {
    SCOPED_TRACE(contact);
    const std::string yaml = patch(contact);
    const Lack e = error_of(yaml, 1, effects::Fault::gap, scalar("supports/plate_z"));
    Rig rig(yaml);
    rig.step();
    solver::Adjoint adjoint;
    Rig::check(rig.engine->adjoint({{}, 1, 2}, adjoint));
    EXPECT_GT(adjoint.layer, 1e-4);
    EXPECT_NEAR(e.found(), adjoint.layer, 0.01 * adjoint.layer);
  }
}

TEST(Mend, MeshesAreThoseOfTheAdjoint) {
  for (const char* nu : {"0.3", "0.45"}) {
    const std::vector<std::string> sets{std::string("materials.gel.poisson_ratio=") + nu};
    std::string yaml = patch("mortar_contact: {pairs: [{slave: block, master: plate}]}");
    const std::string slides = "{side: z_min}, axes: z";
    yaml.replace(yaml.find(slides), slides.size(), "{side: z_min}");  // its foot does not spread, so that stresses vary
    const Lack e = error_of(yaml, 1, effects::Fault::mesh, scalar("supports/plate_z"), sets);
    Rig rig(yaml, sets);
    rig.step();
    solver::Adjoint adjoint;
    Rig::check(rig.engine->adjoint({{}, 1, 2}, adjoint));
    EXPECT_NE(adjoint.mesh, 0);
    EXPECT_NEAR(e.found(), adjoint.mesh, 0.01 * std::abs(adjoint.mesh));
  }
}

// A run that is solved badly, and what it lacks to one that is solved well.
TEST(Mend, SolutionsAreFinished) {
  const std::string yaml = link("", "mode: passive, stiffness: 0.2, rest: -0.5, armature: 3e-4", 4, "backward_euler");
  const auto at = [&](const char* tolerance) { return std::vector<std::string>{std::string("solver.relative_tolerance=") + tolerance}; };
  const Lack rough = error_of(yaml, 25, effects::Fault::solution, scalar("joint/hip_angle"), at("1e-2"));
  Rig well(yaml, at("1e-12"));
  well.steps(25);
  const double truth = well.fields().at("joint/hip_angle");
  ASSERT_GT(std::abs(truth - rough.value), 1e-9);
  EXPECT_NEAR(rough.found(), truth - rough.value, 0.2 * std::abs(truth - rough.value));
}

namespace {

// A soft beam that is let go, and swings.
std::string beam(const char* order, const char* edge) {
  return fmt::format(R"(
mortise: 1
name: beam
time: {{step: 2 ms, steps: 25}}
materials: {{gel: {{model: neo_hookean, youngs_modulus: 0.1 MPa, poisson_ratio: 0.3, density: 1000}}}}
bodies:
  beam: {{type: soft, order: {}, shape: {{box: {{size: [40 mm, 10 mm, 10 mm], edge_length: {}}}}}, material: gel}}
effects:
  inertia: {{}}
  gravity: {{}}
  elasticity: {{}}
  pin: [{{body: beam, where: {{side: x_min}}}}]
)",
                     order, edge);
}

// Of all points of the free end, down [m].
double sinks(const Captured& f) {
  const auto& u = *f.of_points("displacement", 3);
  double most = 0;
  for (std::size_t i = 2; i < u.size(); i += 3) most = std::min(most, u[i]);
  return -most;
}

}  // namespace

// What the mesh leaves out adds up over all steps: linear elements are too stiff, quadratic ones less so.
TEST(Mend, TheMeshOfWhatSwings) {
  const auto truth = [](const char* edge) {
    Rig fine(beam("2", edge));
    Rig::check(fine.engine->begin());
    fine.steps(25);
    return sinks(fine.fields());
  };
  const double exact = truth("2.5 mm");
  const Lack linear = error_of(beam("1", "2 mm"), 25, effects::Fault::mesh, sinks);
  EXPECT_GT(exact - linear.value, 0.05 * exact);
  expect_found(linear, exact, 0.25);
  const Lack quadratic = error_of(beam("2", "10 mm"), 25, effects::Fault::mesh, sinks);
  EXPECT_GT(exact - quadratic.value, 0.02 * exact);
  expect_found(quadratic, exact, 0.4);
}
