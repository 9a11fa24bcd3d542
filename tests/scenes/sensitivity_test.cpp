// Derivatives that are taken along with a run, against differences of whole runs.
#include <cmath>
#include <fstream>

#include "place.h"
#include "rig.h"
#include "slide.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

constexpr double kHair = 1e-5;

using Numbers = std::vector<double>;
using Measured = std::function<Numbers(const Captured&, const std::vector<double>&)>;

// dQ / d ln p by engines that go beside, to both sides; and by runs of their own.
struct Derivative {
  double value, below, above, whole;
  double followed() const { return (below + above) / 2; }
};

std::string with(const char* form, double v) {
  char text[200];
  std::snprintf(text, sizeof text, form, v);
  return text;
}

// form: path=%.17g of the parameter, whose value is p.
std::vector<Derivative> derivatives(const std::string& yaml, int steps, const char* form, double p, const Measured& of, double far = 1e-4,
                                    const std::vector<std::string>& sets = {}) {
  const auto rig = [&](double factor) {
    std::vector<std::string> all = sets;
    all.push_back(with(form, p * factor));
    return std::make_unique<Rig>(yaml, all);
  };
  const auto measure = [&](Rig& r) { return of(r.fields(), r.engine->points()); };
  std::vector<Derivative> out;
  {
    const auto base = rig(1), less = rig(1 - kHair), more = rig(1 + kHair);
    for (Rig* r : {less.get(), more.get(), base.get()}) Rig::check(r->engine->begin());
    Rig::check(base->engine->lead({less->engine.get(), more->engine.get()}));
    base->steps(steps);
    for (Rig* r : {less.get(), more.get()}) EXPECT_EQ(r->engine->lost(), "");
    const Numbers value = measure(*base), below = measure(*less), above = measure(*more);
    for (std::size_t k = 0; k < value.size(); ++k) out.push_back({value[k], (value[k] - below[k]) / kHair, (above[k] - value[k]) / kHair, NAN});
  }
  const auto less = rig(1 - far), more = rig(1 + far);
  less->steps(steps), more->steps(steps);
  const Numbers below = measure(*less), above = measure(*more);
  for (std::size_t k = 0; k < out.size(); ++k) out[k].whole = (above[k] - below[k]) / (2 * far);
  return out;
}

// Derivatives that are nearly zero as a share of the value.
void expect_equal(const Derivative& d, double tolerance) {
  EXPECT_NEAR(d.followed(), d.whole, tolerance * std::max(std::abs(d.whole), 1e-3 * std::abs(d.value)))
      << "value " << d.value << ", " << d.below << " " << d.above;
}

constexpr const char* kBlock = R"(
mortise: 1
name: block
time: {mode: static, steps: 3}
materials:
  gel: {model: linear, youngs_modulus: 0.1 MPa, poisson_ratio: 0.4, density: 1050}
bodies:
  block: {type: soft, shape: {box: {size: [20 mm, 20 mm, 10 mm], edge_length: 5 mm}}, material: gel, position: [10 mm, 10 mm, 5 mm]}
effects:
  elasticity: {}
  pin:
    - {body: block, where: {side: x_min}, axes: x}
    - {body: block, where: {side: y_min}, axes: y}
    - {body: block, where: {side: z_min}, axes: z}
  pressure_load:
    - {body: block, where: {side: z_max}, pressure: {time: [0, 1], value: [0, 5 kPa]}}
solver: {relative_tolerance: 1e-11}
)";

Numbers sinks(const Captured&, const std::vector<double>& points) {
  double top = 0;
  for (std::size_t i = 2; i < points.size(); i += 3) top = std::max(top, points[i]);
  return {0.01 - top};
}

// A ball is pressed into a pad and dragged over it, in motion, with friction: history in velocities and in what stuck.
constexpr const char* kDrag = R"(
mortise: 1
name: drag
time: {step: 4 ms, steps: 8}
materials:
  gel: {model: neo_hookean, youngs_modulus: 0.4 MPa, poisson_ratio: 0.38, density: 1050}
  shell: {model: neo_hookean, youngs_modulus: 2 MPa, poisson_ratio: 0.3, density: 1800}
bodies:
  pad: {type: soft, shape: {box: {size: [16 mm, 16 mm, 5 mm], edge_length: 2.5 mm}}, material: gel, position: [0, 0, -2.5 mm]}
  ball: {type: soft, shape: {sphere: {radius: 5 mm, edge_length: 2.5 mm}}, material: shell, position: [0.3 mm, 0.2 mm, 5.05 mm]}
effects:
  inertia: {integrator: backward_euler}
  gravity: {acceleration: [0, 0, -9.81]}
  elasticity: {}
  pin:
    - {body: pad, where: {side: z_min}}
    - {body: ball, where: {box: {min: [-10 mm, -10 mm, 8 mm], max: [10 mm, 10 mm, 20 mm]}}, motion: {time: [0, 16 ms, 32 ms], translation: [[0, 0, 0], [0, 0, -0.6 mm], [0.8 mm, 0, -0.6 mm]]}}
  CONTACT
  friction: {follows: NAME, mu: 0.3, creep_speed: 1e-2, lag_tolerance: 1e-10}
solver: {relative_tolerance: 1e-11}
)";

std::string drag(const std::string& name, const std::string& contact) {
  std::string out = kDrag;
  out.replace(out.find("CONTACT"), 7, name + ": " + contact);
  out.replace(out.find("NAME"), 4, name);
  return out;
}

Numbers forces(const Captured& f, const std::vector<double>&) {
  return {f.at("supports/ball_z"), f.at("supports/ball_x"), f.at("friction/dissipation")};
}

struct Case {
  const char* form;
  double p;
};

void follows(const std::string& yaml, const std::vector<Case>& cases, double tolerance) {
  for (const Case& c : cases) {
    SCOPED_TRACE(c.form);
    for (const Derivative& d : derivatives(yaml, 8, c.form, c.p, forces)) expect_equal(d, tolerance);
  }
}

}  // namespace

// Sinks by p h / E: as much less for more E as more for more p, exactly.
TEST(Sensitivity, OfALinearBlockIsExact) {
  const Derivative E = derivatives(kBlock, 3, "materials.gel.youngs_modulus=%.17g", 1e5, sinks)[0];
  EXPECT_NEAR(E.value, 5e-4, 1e-12);
  EXPECT_NEAR(E.followed(), -5e-4, 5e-4 * 1e-6);
  EXPECT_NEAR(E.above, -5e-4 / (1 + kHair), 5e-4 * 1e-8) << "of 1 / E to either side, but for the third power of the difference";
  const Derivative p = derivatives(kBlock, 3, "effects.pressure_load.0.pressure.value=[0, %.17g]", 5e3, sinks)[0];
  EXPECT_NEAR(p.followed(), 5e-4, 5e-4 * 1e-6);
}

TEST(Sensitivity, OfAPressAndDragWithBarrierAndFriction) {
  follows(drag("barrier_contact", "{d_hat: 0.1 mm, stiffness: 1 MPa}"),
          {{"materials.gel.youngs_modulus=%.17g", 4e5},
           {"materials.gel.poisson_ratio=%.17g", 0.38},
           {"materials.shell.density=%.17g", 1800},
           {"effects.barrier_contact.d_hat=%.17g", 1e-4},
           {"effects.barrier_contact.stiffness=%.17g", 1e6},
           {"effects.friction.mu=%.17g", 0.3},
           {"effects.friction.creep_speed=%.17g", 1e-2},
           {"effects.pin.1.motion.translation=[[0, 0, 0], [0, 0, -0.6e-3], [%.17g, 0, -0.6e-3]]", 0.8e-3},
           {"effects.gravity.acceleration=[0, 0, %.17g]", -9.81}},
          3e-4);
}

// What a block slides until friction stops it goes as 1 / mu; it stays where it has come to rest, however thin the way is that friction holds to.
TEST(Sensitivity, OfASlideThatFrictionHasStopped) {
  for (const char* integrator : {"backward_euler", "bdf2"}) {
    const Measured way = [](const Captured&, const std::vector<double>& points) { return Numbers{points[0] + 0.03}; };
    const Derivative d =
        derivatives(kSlide, 50, "effects.friction.mu=%.17g", 0.3, way, 1e-3, {std::string("effects.inertia.integrator=") + integrator})[0];
    expect_equal(d, 0.02);  // across the step in which it stops whole runs differ by more than a hair
    EXPECT_NEAR(d.followed(), -d.value, 0.01 * d.value) << integrator;
  }
}

// Above 0.4 the change of volume is averaged: no derivative there, and the two sides say so.
TEST(Sensitivity, ToTheTwoSidesOfAJumpDiffers) {
  const Derivative d =
      derivatives(drag("barrier_contact", "{d_hat: 0.1 mm, stiffness: 1 MPa}"), 4, "materials.gel.poisson_ratio=%.17g", 0.4, forces)[0];
  EXPECT_LT(std::abs(d.below), 10);
  EXPECT_GT(std::abs(d.above), 100);
}

// Samples that slide and turn: products of the Jacobian are differences.
TEST(Sensitivity, OfAPressAndDragWithMortarContact) {
  follows(drag("mortar_contact", "{d_hat: 0.1 mm, stiffness: 1 MPa, pairs: [{slave: pad, master: ball}]}"),
          {{"materials.gel.youngs_modulus=%.17g", 4e5}, {"effects.mortar_contact.d_hat=%.17g", 1e-4}, {"effects.friction.mu=%.17g", 0.3}}, 3e-4);
}

// Motors, an angle that is given exactly (so what is tied to it moves too), a bond.
TEST(Sensitivity, OfADrivenLeg) {
  std::ifstream file(test_place::kSourceFolder + "/scenes/first/09_driven_leg.yaml");
  const std::string yaml{std::istreambuf_iterator<char>(file), {}};
  const Measured torques = [](const Captured& f, const std::vector<double>&) { return Numbers{f.at("drive/hip_torque"), f.at("drive/knee_torque")}; };
  for (const Case& c :
       {Case{"effects.drive.1.sine.frequency=%.17g", 5}, {"effects.drive.0.kp=%.17g", 6}, {"materials.aluminium.density=%.17g", 1500}}) {
    SCOPED_TRACE(c.form);
    for (const Derivative& d : derivatives(yaml, 10, c.form, c.p, torques, 1e-4, {"solver.relative_tolerance=1e-11"})) expect_equal(d, 3e-4);
  }
}

TEST(Sensitivity, ChangesNothingOfTheRunThatItGoesBeside) {
  const std::string yaml = drag("barrier_contact", "{d_hat: 0.1 mm, stiffness: 1 MPa}");
  Rig alone(yaml), base(yaml), other(yaml, {"effects.friction.mu=0.30001"});
  Rig::check(other.engine->begin());
  Rig::check(base.engine->lead({other.engine.get()}));
  alone.steps(4), base.steps(4);
  EXPECT_EQ(alone.engine->points(), base.engine->points());
  EXPECT_NE(other.engine->points(), base.engine->points());
}

// One that follows with the same parameters stays where it is led but for a Newton step that rounding leaves.
TEST(Sensitivity, OfNothingIsNothing) {
  const std::string yaml = drag("barrier_contact", "{d_hat: 0.1 mm, stiffness: 1 MPa}");
  Rig base(yaml), same(yaml);
  Rig::check(base.engine->lead({same.engine.get()}));
  base.steps(6);
  const std::vector<double> a = base.engine->points(), b = same.engine->points();
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-15);
  EXPECT_NEAR(base.fields().at("friction/dissipation"), same.fields().at("friction/dissipation"), 1e-12 * base.fields().at("friction/dissipation"));
  EXPECT_NEAR(base.fields().at("supports/work"), same.fields().at("supports/work"), 1e-9 * std::abs(base.fields().at("supports/work")));
}

TEST(Sensitivity, RefusesWhatHasNone) {
  Rig base(kBlock), finer(kBlock, {"bodies.block.shape.box.edge_length=4 mm"}), freer(kBlock, {"effects.pin.2.axes=xyz"});
  const engine::Outcome mesh = base.engine->lead({finer.engine.get()}), held = base.engine->lead({freer.engine.get()});
  EXPECT_NE(mesh.code, 0);
  EXPECT_NE(held.code, 0);
  EXPECT_NE(mesh.message.find("it changes meshes, or what is held"), std::string::npos) << mesh.message;
}
