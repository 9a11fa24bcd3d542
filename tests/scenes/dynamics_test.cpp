// Free motion against what the integrators' own recurrences give.
#include <fstream>

#include "place.h"
#include "rig.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

const char* kFall = R"(
mortise: 1
name: fall
time: {step: 10 ms, steps: 50}
materials:
  gel: {model: neo_hookean, youngs_modulus: 0.1 MPa, poisson_ratio: 0.4, density: 1000}
bodies:
  soft: {type: soft, shape: {box: {size: [0.1, 0.1, 0.1], edge_length: 0.05}}, material: gel, velocity: [1, 0, 2]}
  stiff: {type: stiff, shape: {sphere: {radius: 0.05, edge_length: 0.02}}, material: gel, position: [1, 0, 0], velocity: [1, 0, 2]}
effects:
  inertia: {integrator: backward_euler}
  gravity: {acceleration: [0, 0, -10]}
  elasticity: {}
  affine_body: {stiffness: 10 MPa}
solver: {relative_tolerance: 1e-12, force_tolerance: 0 N}
)";

}  // namespace

// v_{n+1} = v_n - g dt,  z_{n+1} = z_n + dt v_{n+1}.
TEST(Dynamics, FreeFallIsExactlyTheBackwardEulerRecurrence) {
  Rig rig(kFall);
  double z = 0, v = 2;
  for (int n = 0; n < 50; ++n) {
    rig.step();
    v -= 10 * 0.01;
    z += 0.01 * v;
  }
  const auto u = rig.fields().point.at("displacement");
  for (std::size_t i = 0; i < u.size() / 3; ++i) {
    EXPECT_NEAR(u[3 * i], 0.5, 1e-9);
    EXPECT_NEAR(u[3 * i + 1], 0, 1e-9);
    EXPECT_NEAR(u[3 * i + 2], z, 1e-9);
  }
}

// BDF2 is exact for motion quadratic in time once started; it starts with backward Euler for an eighth of the step, whose error is known.
TEST(Dynamics, FreeFallIsExactlyTheBdf2Recurrence) {
  Rig rig(kFall, {"effects.inertia.integrator=bdf2"});
  const double dt = 0.01, g = 10;
  double z = 0, v = 2, z1 = 0, v1 = 0, before = 0;
  const auto advance = [&](double h) {
    const double w = before > 0 ? h / before : 0;  // 0: backward Euler
    const double a0 = (1 + 2 * w) / (1 + w), a1 = 1 + w, a2 = w * w / (1 + w);
    const double vn = (a1 * v - a2 * v1 - h * g) / a0, zn = (a1 * z - a2 * z1 + h * vn) / a0;
    z1 = z, v1 = v, z = zn, v = vn, before = h;
  };
  for (int n = 0; n < 50; ++n) {
    EXPECT_EQ(rig.step().substeps, n == 0 ? 4 : 1);
    if (n == 0)
      for (const double part : {0.125, 0.125, 0.25}) advance(part * dt);
    advance(n == 0 ? dt / 2 : dt);
  }
  const auto u = rig.fields().point.at("displacement");
  for (std::size_t i = 0; i < u.size() / 3; ++i) EXPECT_NEAR(u[3 * i + 2], z, 1e-9);
  const double t = 50 * dt;
  EXPECT_NEAR(z, 2 * t - g * t * t / 2, g * dt * dt / 50);  // g dt^2 / 2 with a start of first order
}

// A spinning stiff body keeps its linear momentum; without gravity nothing drifts.
TEST(Dynamics, MomentumOfFreeBodiesIsKept) {
  Rig rig(kFall, {"effects.gravity.acceleration=[0,0,0]", "bodies.stiff.angular_velocity=[3,1,20]"});
  rig.step();
  const Captured first = rig.fields();
  rig.steps(30);
  const Captured last = rig.fields();
  for (const char* name : {"inertia/momentum_x", "inertia/momentum_y", "inertia/momentum_z"})
    EXPECT_NEAR(last.at(name), first.at(name), 1e-9) << name;
}

// The same scene on one and on two threads, and restarted in the middle, gives the same bits.
TEST(Dynamics, BitsDoNotDependOnThreadsOrRestarts) {
  const auto final_state = [](int threads, int restart_after) {
    engine::chosen().api->set_threads(threads);
    Rig rig(kFall, {"bodies.stiff.angular_velocity=[3,1,20]", "effects.inertia.integrator=bdf2"});
    for (int n = 0; n < 12; ++n) {
      if (n == restart_after) rig.resume();
      rig.step();
    }
    return rig.engine->points();
  };
  const auto reference = final_state(1, -1);
  EXPECT_EQ(reference, final_state(2, -1));
  EXPECT_EQ(reference, final_state(2, 7));
  engine::chosen().api->set_threads(0);
}

// H04: one edge falls on another, parallel to it, and passes beside it within a step. Where contact is not convex backward Euler gains energy
// (5.7 % of all in one step here), and so would an automatic stiffness that grows under load: steps are cut, and growth is paid for.
TEST(Dynamics, ContactMakesNoEnergy) {
  const std::string path = test_place::kSourceFolder + "/scenes/hard/h04_edge_edge_parallel.yaml";
  std::ifstream file(path);
  const std::string yaml{std::istreambuf_iterator<char>(file), {}};
  const std::string barrier = "barrier_contact: {d_hat: 5 mm, stiffness: 0.1 MPa}",
                    mortar = "mortar_contact: {d_hat: 5 mm, pairs: [{slave: upper, master: lower}]}";
  for (const std::string& contact : {barrier, mortar}) {
    std::string text = yaml;
    text.replace(text.find(barrier), barrier.size(), contact);
    Rig rig(text, {}, path);
    const std::string effect = contact.substr(0, contact.find(':'));
    double last = NAN, scale = 0, most = -INFINITY;
    Index substeps = 0;
    for (int n = 0; n < 40; ++n) {
      substeps += rig.step().substeps;
      const Captured f = rig.fields();
      double now = f.at("inertia/kinetic_energy");
      scale = std::max(scale, now);
      for (const std::string& name : {std::string("elasticity"), std::string("gravity"), effect}) now += f.at(name + "/energy");
      most = std::fmax(most, now - last);
      last = now;
    }
    std::printf("%s: gain %.1e, %d substeps\n", effect.c_str(), most / scale, static_cast<int>(substeps));
    EXPECT_LT(most, 1e-8 * scale) << contact;
  }
}

// BDF2 alone gained 10 to 41 % of all energy where this block strikes the floor or leaves it, in a single step.
TEST(Dynamics, Bdf2MakesNoEnergyInImpacts) {
  for (const char* dt : {"8 ms", "4 ms", "2 ms"}) {
    Rig rig(R"(
mortise: 1
name: bounce
time: {step: 4 ms, steps: 40}
materials: {rubber: {youngs_modulus: 1 MPa, poisson_ratio: 0.3, density: 1000}}
bodies:
  block: {type: soft, shape: {box: {size: [20 mm, 20 mm, 20 mm], edge_length: 10 mm}}, material: rubber, position: [0, 0, 15 mm], velocity: [0, 0, -1]}
  floor: {type: half_space}
effects: {inertia: {integrator: bdf2}, gravity: {}, elasticity: {}, barrier_contact: {d_hat: 0.5 mm, stiffness: 0.1 MPa}}
)",
            {std::string("time.step=") + dt});
    double last = NAN, scale = 0, most = -INFINITY;
    Index left_to_euler = 0, second = 0;
    for (int n = 0; n < 40; ++n) {
      const solver::StepReport report = rig.step();
      left_to_euler += report.first_order, second += report.substeps - report.first_order;
      const Captured f = rig.fields();
      double now = f.at("inertia/kinetic_energy");
      scale = std::max(scale, now);
      for (const char* name : {"elasticity", "gravity", "barrier_contact"}) now += f.at(std::string(name) + "/energy");
      most = std::fmax(most, now - last);
      last = now;
    }
    EXPECT_LT(most, 1.1e-3 * scale) << dt;
    EXPECT_GT(left_to_euler, 0) << dt;
    EXPECT_GT(second, 30) << dt;  // the rest stays of second order
  }
}

// A cube of two cells across that a stiff plate takes along, and one that a pin turns: with masses on its nodes it had 1.5 times its moment of
// inertia.
TEST(Dynamics, WhatIsTurnedHasItsMomentOfInertia) {
  const double a = 0.04, cube = 1000 * a * a * a * a * a / 6, plate = cube * 0.002 / a;  // about the axis [kg m^2]
  const std::string yaml = R"(
mortise: 1
name: wheel
time: {step: 2 ms, steps: 50}
materials: {rubber: {youngs_modulus: 100 MPa, poisson_ratio: 0, density: 1000}}
bodies:
  plate: {type: stiff, shape: {box: {size: [2 mm, 40 mm, 40 mm], edge_length: 40 mm}}, material: rubber, position: [-1 mm, 0, 0]}
  cube: {type: soft, shape: {box: {size: [40 mm, 40 mm, 40 mm], edge_length: 20 mm}}, material: rubber, position: [20 mm, 0, 0]}
effects:
  inertia: {}
  elasticity: {}
)";
  Rig driven(yaml + R"(
  affine_body: {}
  joint: [{name: axle, type: revolute, body: plate, at: [0, 0, 0], axis: [1, 0, 0]}]
  drive: [{joint: axle, mode: effort, torque: 2e-4}]
  bond: [{body: cube, to: plate, where: {side: x_min}}]
)");
  driven.steps(50);
  EXPECT_NEAR(driven.fields().at("joint/axle_rate"), 2e-4 / (cube + plate) * 0.1, 2e-3 * 2e-4 / (cube + plate) * 0.1);

  Rig turned(yaml + R"(
  pin:
    - {body: plate, where: {side: all}}
    - {body: cube, where: {side: all}, motion: {time: [0, 1], rotation: {axis: [1, 0, 0], angle: [0, 0.2]}}}
)");
  turned.steps(2);
  EXPECT_NEAR(turned.fields().at("inertia/kinetic_energy"), 0.5 * cube * 0.2 * 0.2, 1e-4 * cube * 0.2 * 0.2);
}
