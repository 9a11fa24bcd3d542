// Mass and inertia that a scene states, and bodies of several parts: against what mechanics says of them.
#include <cmath>

#include "audit/measured_body.h"
#include "rig.h"

namespace mortise::testing {
namespace {

const std::string kHead = R"(
mortise: 1
time: {step: 1 ms, steps: 1}
materials: {steel: {density: 8000 kg/m^3}}
)";
const std::string kFree = "effects: {inertia: {}, affine_body: {}}\n";

Mat3 turn() { return Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix(); }

// I of the scenes below.
Mat3 tensor() {
  Mat3 I;
  I << 0.02, 0.001, -0.002, 0.001, 0.03, 0.0015, -0.002, 0.0015, 0.025;
  return I;
}
const std::string kStated = R"(
bodies:
  link:
    type: stiff
    shape: {box: {size: [0.2, 0.1, 0.1], edge_length: 0.2}}
    mass: 2.5 kg
    inertia: {centre: [0.03, -0.02, 0.01], moments: [0.02, 0.03, 0.025], products: [0.001, -0.002, 0.0015]}
    position: [0.5, 0.1, -0.2]
    rotation: {axis: [1, 2, 3], angle: 0.7}
    velocity: [0.3, 0, -0.1]
    angular_velocity: [0.01, -0.02, 0.03]
)";

TEST(StatedMass, KineticEnergyIsThatOfTheTensor) {
  Rig rig(kHead + kStated + kFree);
  rig.step();
  const Vec3 v(0.3, 0, -0.1), w(0.01, -0.02, 0.03);
  const Mat3 I = turn() * tensor() * turn().transpose();
  const double exact = 0.5 * 2.5 * v.squaredNorm() + 0.5 * w.dot(I * w);
  EXPECT_NEAR(rig.fields().at("inertia/kinetic_energy"), exact, 1e-8 * exact);
}

TEST(StatedMass, IsWhatCertificatesMeasure) {
  Rig rig(kHead + kStated + kFree);
  const audit::MeasuredBody body(rig.input.bodies[0], 0);
  const Vec3 centre = turn() * Vec3(0.03, -0.02, 0.01) + Vec3(0.5, 0.1, -0.2), w(0.4, -0.5, 0.6);
  std::vector<double> points, velocity;
  for (const Vec3& x : rig.input.bodies[0].nodes) {
    const Vec3 v = Vec3(1, 2, 3) + w.cross(x - centre);
    points.insert(points.end(), {x[0], x[1], x[2]}), velocity.insert(velocity.end(), {v[0], v[1], v[2]});
  }
  EXPECT_NEAR(body.mass(), 2.5, 1e-13);
  EXPECT_LT((body.mean(points, points) - centre).norm(), 1e-13);
  EXPECT_LT((body.mean(velocity, points) - Vec3(1, 2, 3)).norm(), 1e-12);
  EXPECT_NEAR(body.turning_energy(velocity, points), 0.5 * w.dot(turn() * tensor() * turn().transpose() * w), 1e-13);
}

// A hinge through the world: the first step of backward Euler turns the body by m g l h^2 / (Ic + m l^2); stiff enough that it does not shear as far.
TEST(StatedMass, APendulumStartsWithItsMomentOverItsInertia) {
  Rig rig(kHead + R"(
bodies:
  link:
    type: stiff
    shape: {box: {size: [0.02, 0.02, 0.3], edge_length: 0.3}}
    mass: 1.2 kg
    inertia: {centre: [0.1, 0, 0], moments: [0.012, 0.013, 0.004]}
effects:
  inertia: {}
  affine_body: {stiffness: 10000 GPa}
  gravity: {}
  joint: [{name: hinge, type: revolute, body: link, at: [0, 0, 0], axis: [0, 1, 0]}]
)");
  rig.step();
  const double m = 1.2, g = 9.81, l = 0.1, h = 1e-3, exact = m * g * l * h * h / (0.013 + m * l * l);
  EXPECT_NEAR(rig.fields().at("joint/hinge_angle"), exact, 1e-6 * exact);
}

TEST(StatedMass, OfTheShapeItselfChangesNothing) {
  const std::string body = R"(
bodies:
  link:
    type: stiff
    shape: {box: {size: [0.3, 0.2, 0.1], edge_length: 0.3}}
    rotation: {axis: [0, 1, 0], angle: 0.4}
    angular_velocity: [3, 5, -2]
    )";
  const double m = 8000 * 0.3 * 0.2 * 0.1;
  char stated[200];
  std::snprintf(stated, sizeof stated, "mass: %.17g\n    inertia: {moments: [%.17g, %.17g, %.17g]}\n", m, m / 12 * (0.04 + 0.01),
                m / 12 * (0.09 + 0.01), m / 12 * (0.09 + 0.04));
  Rig one(kHead + body + "material: steel\n" + kFree), other(kHead + body + stated + kFree);
  one.steps(20), other.steps(20);
  const std::vector<double> a = one.engine->points(), b = other.engine->points();
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-11);
}

TEST(StatedMass, MomentsOfNoBodyAreRefused) {
  for (const char* moments : {"[1, 1, 2.01]", "[1, 2, 3]", "[5, 1, 1]"}) {
    try {
      Rig rig(kHead + kStated + kFree, {std::string("bodies.link.inertia.moments=") + moments});
      ADD_FAILURE() << moments << " was taken";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), Exit::scene);
      EXPECT_NE(std::string(e.what()).find("no body has the principal moments"), std::string::npos) << e.what();
    }
  }
}

TEST(Parts, AreOneBodyWithTheMassOfAll) {
  Rig rig(kHead + R"(
bodies:
  hammer:
    type: stiff
    material: steel
    position: [1, 0, 0]
    shape:
      parts:
        - {shape: {box: {size: [0.1, 0.1, 0.1], edge_length: 0.1}}, position: [0, 0, 0.3]}
        - {shape: {box: {size: [0.4, 0.02, 0.02], edge_length: 0.4}}, rotation: {axis: [0, 1, 0], angle: 90 deg}}
    angular_velocity: [0, 0.02, 0]
)" + kFree);
  const audit::MeasuredBody body(rig.input.bodies[0], 0);
  const double head = 8000 * 1e-3, handle = 8000 * 0.4 * 4e-4, all = head + handle, z = head * 0.3 / all;
  EXPECT_NEAR(body.mass(), all, 1e-12 * all);
  const std::vector<double> points = rig.engine->points();
  EXPECT_LT((body.mean(points, points) - Vec3(1, 0, z)).norm(), 1e-12);
  rig.step();
  const double I = head / 6 * 0.01 + head * (0.3 - z) * (0.3 - z) + handle / 12 * (0.16 + 0.0004) + handle * z * z;
  EXPECT_NEAR(rig.fields().at("inertia/kinetic_energy"), 0.5 * I * 0.02 * 0.02, 1e-8 * 0.5 * I * 0.0004);
}

}  // namespace
}  // namespace mortise::testing

// Soft, stiff, soft, one upon the other and bonded: the stiff plate in the middle gives way by nothing, whatever the others are made of.
TEST(AffineBody, IsStiffBesideWhatItIsJoinedTo) {
  for (const char* modulus : {"1 MPa", "200 GPa"}) {
    mortise::testing::Rig rig(std::string(R"(
mortise: 1
name: sandwich
time: {mode: static, steps: 1}
materials:
  m: {model: linear, youngs_modulus: )") +
                              modulus + R"(, poisson_ratio: 0, density: 1000}
bodies:
  lower: {type: soft, shape: {box: {size: [20 mm, 20 mm, 10 mm], edge_length: 5 mm}}, material: m}
  plate: {type: stiff, shape: {box: {size: [20 mm, 20 mm, 20 mm], edge_length: 10 mm}}, mass: 0.1, position: [0, 0, 15 mm]}
  upper: {type: soft, shape: {box: {size: [20 mm, 20 mm, 10 mm], edge_length: 5 mm}}, material: m, position: [0, 0, 30 mm]}
effects:
  elasticity: {}
  affine_body: {}
  bond:
    - {body: lower, to: plate, where: {side: z_max}}
    - {body: upper, to: plate, where: {side: z_min}}
  pin:
    - {body: lower, where: {side: z_min}}
    - {body: upper, where: {side: z_max}, motion: {time: [0, 1], translation: [[0, 0, 0], [0, 0, -20 um]]}}
)");
    rig.step();
    const double E = modulus[0] == '1' ? 1e6 : 2e11, force = E * 4e-4 * 20e-6 / 0.02;
    EXPECT_NEAR(rig.fields().at("supports/lower_z"), force, 0.005 * force) << modulus;
  }
}
