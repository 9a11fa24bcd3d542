// The scene's criteria: what is measured on known states, and what the verdict is.
#include "audit/checks.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <nlohmann/json.hpp>

#include "engine/effect_tables.h"
#include "engine/input.h"
#include "scene/scene.h"

namespace {

using namespace mortise;
using audit::Checks;

model::ModelInput input_of(const std::string& yaml) {
  return engine::make_input(scene::read_scene_text(yaml, "test.yaml", {}, engine::effect_tables()).root);
}

// One cube of 1 m^3 and 1000 kg with its centre at the origin, pinned to nothing.
model::ModelInput scene(const std::string& checks) {
  const std::string text = R"(
mortise: 1
time: {step: 0.1 s, steps: 2}
materials: {gel: {youngs_modulus: 0.1 MPa, poisson_ratio: 0.4, density: 1000}}
bodies: {cube: {type: soft, shape: {box: {size: [1, 1, 1], edge_length: 1}}, material: gel}}
effects: {inertia: {}, elasticity: {}, barrier_contact: {}, pin: [{body: cube, where: {side: z_max}}]}
checks:
)" + checks;
  return input_of(text);
}

using Map = std::function<Vec3(const Vec3&)>;
const Map kStay = [](const Vec3& x) { return x; };

std::vector<double> points(const model::ModelInput& input, const Map& map) {
  std::vector<double> out;
  for (const Vec3& x : input.bodies[0].nodes) {
    const Vec3 y = map(x);
    out.insert(out.end(), y.data(), y.data() + 3);
  }
  return out;
}

// Verdict of one criterion after a state at rest and a state moved by `map`, whose points have these velocities.
Checks::Verdict verdict(
    const std::string& criterion, const Map& map = kStay, const Map& velocity = [](const Vec3&) { return Vec3::Zero(); },
    const std::function<void(FieldSink&, int)>& more = {}, Exit status = Exit::done, const std::string& message = "") {
  const model::ModelInput input = scene("  - " + criterion + "\n");
  Checks checks(input);
  for (int k = 0; k < 2; ++k) {
    Snapshot sink;
    sink.points("velocity", "m/s", 3, points(input, k ? velocity : Map([](const Vec3&) { return Vec3::Zero(); })));
    if (more) more(sink, k);
    checks.state(sink, points(input, k ? map : kStay));
  }
  solver::StepReport step;
  step.newton = 7, step.substeps = 2, step.alpha = 0.5, step.residual = 1, step.tolerance = 4;
  checks.step(step);
  return checks.verdicts(status, message).at(0);
}

TEST(Checks, MeasuresTheBody) {
  const Map moved = [](const Vec3& x) { return Vec3(2 * x[0] + 3, x[1], x[2]); };
  const Map turning = [](const Vec3& x) { return Vec3(Vec3(0, 0, 2).cross(x) + Vec3(1, 0, 0)); };
  const std::string end = ", when: end, near: 0, tolerance: 0}";
  const auto value = [&](const std::string& q, const std::string& axis) {
    return verdict("{quantity: " + q + ", body: cube" + axis + end, moved, turning).value;
  };
  EXPECT_NEAR(value("position", ", axis: x"), 3, 1e-12);
  EXPECT_NEAR(value("displacement", ", axis: size"), 3, 1e-12);
  EXPECT_NEAR(value("lowest", ", axis: x"), 2, 1e-12);
  EXPECT_NEAR(value("highest", ", axis: x"), 4, 1e-12);
  EXPECT_NEAR(value("movement", ""), 3.5, 1e-12);
  EXPECT_NEAR(value("volume_change", ""), 1, 1e-12);
  EXPECT_NEAR(value("velocity", ", axis: x"), 1, 1e-12);
  EXPECT_NEAR(verdict("{quantity: spin, body: cube, axis: z" + end, kStay, turning).value, 2, 1e-12);
  // A turn by 2 rad about an axis of any direction, with a shift and a stretch that is none.
  const Vec3 axis = Vec3(1, -2, 2) / 3;
  const Map turned = [&](const Vec3& x) { return Vec3(1.5 * (Eigen::AngleAxisd(2, axis) * x) + Vec3(4, 5, 6)); };
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(verdict("{quantity: rotation, body: cube, axis: " + std::string(1, "xyz"[c]) + end, turned).value, 2 * axis[c], 1e-12);
  EXPECT_NEAR(verdict("{quantity: rotation, body: cube, axis: size" + end, turned).value, 2, 1e-12);
}

TEST(Checks, TakesForcesAndStepsFromReports) {
  const auto forces = [](FieldSink& sink, int k) {
    for (int c = 0; c < 3; ++c) {
      sink.scalar("barrier_contact", std::string("force_cube_") + "xyz"[c], "N", c == 2 ? 10 * k : 0);
      sink.scalar("supports", std::string("cube_") + "xyz"[c], "N", -1);
    }
  };
  const auto with = [&](const std::string& criterion) { return verdict(criterion, kStay, kStay, forces); };
  EXPECT_TRUE(with("{quantity: contact_force, body: cube, axis: z, when: end, near: 10 N, share: 1e-9}").pass);
  EXPECT_DOUBLE_EQ(with("{quantity: contact_force, body: cube, axis: z, when: mean, above: 6 N}").value, 5);
  EXPECT_FALSE(with("{quantity: contact_force, body: cube, axis: z, when: mean, above: 6 N}").pass);
  EXPECT_NEAR(with("{quantity: support_force, body: cube, axis: size, below: 1.7 N}").value, std::sqrt(3), 1e-12);
  EXPECT_FALSE(with("{quantity: support_force, body: cube, axis: size, below: 1.7 N}").pass);
  const Checks::Verdict scalar = with("{quantity: scalar, value: barrier_contact/force_cube_z, when: end, above: 9 N}");
  EXPECT_DOUBLE_EQ(scalar.value, 10);
  EXPECT_TRUE(scalar.pass);
  EXPECT_EQ(scalar.text, "barrier_contact/force_cube_z, end above 9");
  EXPECT_FALSE(verdict("{quantity: newton_iterations, below: 7}").pass);
  EXPECT_TRUE(verdict("{quantity: newton_iterations, below: 8}").pass);
  EXPECT_DOUBLE_EQ(verdict("{quantity: residual, below: 1}").value, 0.25);
}

// The worst state decides, whichever side of the bound it is on.
TEST(Checks, AlwaysMeansTheWorstState) {
  const Map up = [](const Vec3& x) { return Vec3(x + Vec3(0, 0, 5)); };
  EXPECT_DOUBLE_EQ(verdict("{quantity: position, body: cube, axis: z, above: -1 m}", up).value + 1, 1);
  EXPECT_DOUBLE_EQ(verdict("{quantity: position, body: cube, axis: z, below: 9 m}", up).value, 5);
  EXPECT_DOUBLE_EQ(verdict("{quantity: position, body: cube, axis: z, above: -1 m, below: 2 m}", up).value, 5);
  EXPECT_DOUBLE_EQ(verdict("{quantity: position, body: cube, axis: z, near: 1 m, tolerance: 1 m}", up).value, 5);
}

// Half a joule of work by the support is no gain; what is beyond it is, as a share of the largest energy.
TEST(Checks, EnergyGainCountsTheWorkOfSupports) {
  const auto report = [](double energy) {
    return [energy](FieldSink& sink, int k) {
      sink.scalar("inertia", "kinetic_energy", "J", k ? energy : 1);
      const std::vector<double> force{0.25, 0, 0, 0.25, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
      sink.points("support_force", "N", 3, force);
    };
  };
  const Map moved = [](const Vec3& x) { return Vec3(x + Vec3(1, 0, 0)); };
  EXPECT_NEAR(verdict("{quantity: energy_gain, below: 1e-9}", moved, kStay, report(1.5)).value, 0, 1e-12);
  EXPECT_NEAR(verdict("{quantity: energy_gain, below: 1e-9}", moved, kStay, report(2)).value, 0.25, 1e-12);
}

// A step that was halved: forces at its end do not tell the work, the solver's sum does.
TEST(Checks, EnergyGainTakesTheWorkThatTheSolverSummed) {
  const auto report = [](FieldSink& sink, int k) {
    sink.scalar("inertia", "kinetic_energy", "J", k ? 3 : 1);
    sink.scalar("supports", "work", "J", 2);
    const std::vector<double> force{0.25, 0, 0, 0.25, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    sink.points("support_force", "N", 3, force);
  };
  const Map moved = [](const Vec3& x) { return Vec3(x + Vec3(1, 0, 0)); };
  EXPECT_NEAR(verdict("{quantity: energy_gain, below: 1e-9}", moved, kStay, report).value, 0, 1e-12);
}

// A mean over whole cycles of the force that several feet bear together.
TEST(Checks, ForcesOfSeveralBodiesAddUpOverAWindowOfTime) {
  const model::ModelInput input = input_of(R"(
mortise: 1
time: {step: 0.1 s, steps: 6}
materials: {gel: {youngs_modulus: 0.1 MPa, poisson_ratio: 0.4, density: 1000}}
bodies:
  a: {type: soft, shape: {box: {size: [1, 1, 1], edge_length: 1}}, material: gel}
  b: {type: soft, shape: {box: {size: [1, 1, 1], edge_length: 1}}, material: gel, position: [2, 0, 0]}
effects: {inertia: {}, elasticity: {}, barrier_contact: {}}
checks:
  - {quantity: contact_force, bodies: [a, b], axis: z, when: mean, from: 0.2 s, until: 0.4 s, near: 0 N, tolerance: 0 N}
  - {quantity: contact_force, body: a, axis: z, when: mean, near: 0 N, tolerance: 0 N}
  - {quantity: newton_iterations, from: 0.4 s, below: 5}
)");
  Checks checks(input);
  for (int k = 0; k <= 6; ++k) {  // forces k and 10 k
    Snapshot said;
    said.scalar("barrier_contact", "force_a_z", "N", k);
    said.scalar("barrier_contact", "force_b_z", "N", 10 * k);
    std::vector<double> at;
    for (const model::BodyInput& b : input.bodies)
      for (const Vec3& x : b.nodes) at.insert(at.end(), x.data(), x.data() + 3);
    checks.state(said, at, 0.1 * k);
    solver::StepReport step;
    step.time = 0.1 * k, step.newton = 10 - k;
    checks.step(step);
  }
  const auto verdicts = checks.verdicts(Exit::done, "");
  EXPECT_DOUBLE_EQ(verdicts[0].value, 11 * 3.5) << "steps 3 and 4";
  EXPECT_EQ(verdicts[0].text, "contact_force of a + b (z), mean, from 0.2 s, until 0.4 s near 0 +- 0");
  EXPECT_DOUBLE_EQ(verdicts[1].value, 3);
  EXPECT_EQ(verdicts[2].value, 5) << "steps 5 and 6";
}

// The energies of a frame are known without any criterion; dead loads do work that nobody counts.
TEST(Checks, EnergiesAreKnownWithoutCriteria) {
  const auto after_two_states = [](const std::string& more) {
    const model::ModelInput input = input_of(R"(
mortise: 1
time: {step: 0.1 s, steps: 2}
materials: {gel: {youngs_modulus: 0.1 MPa, poisson_ratio: 0.4, density: 1000}}
bodies: {cube: {type: soft, shape: {box: {size: [1, 1, 1], edge_length: 1}}, material: gel}}
effects: {inertia: {}, elasticity: {}, pin: [{body: cube, where: {side: z_max}}])" +
                                             more + "}\n");
    Checks checks(input);
    for (int k = 0; k < 2; ++k) {
      Snapshot sink;
      std::vector<double> force(3 * input.bodies[0].nodes.size(), 0.0);
      force[0] = 3;
      sink.points("support_force", "N", 3, force);
      sink.scalar("elasticity", "energy", "J", k ? 5 : 0);
      checks.state(sink, points(input, [&](const Vec3& x) { return Vec3(x + k * Vec3(0.5, 0, 0)); }));
    }
    return checks.energy();
  };
  const audit::EnergyAudit::Result plain = after_two_states("");
  EXPECT_DOUBLE_EQ(plain.total, 5);
  EXPECT_DOUBLE_EQ(plain.support_work, 1.5);
  EXPECT_DOUBLE_EQ(plain.largest_gain, 3.5);
  EXPECT_DOUBLE_EQ(plain.scale, 5);
  const audit::EnergyAudit::Result loaded =
      after_two_states(", pressure_load: [{body: cube, where: {side: z_min}, pressure: {time: [0, 1], value: [0, 1]}}]");
  EXPECT_DOUBLE_EQ(loaded.total, 5);
  EXPECT_TRUE(std::isnan(loaded.largest_gain));
}

// Bodies that begin within each other's layer are driven apart by its energy; what lies on another keeps it.
TEST(Checks, EnergyOfContactAtTheStartCountsAsFarAsItIsGivenAway) {
  const auto at_start = [](double first, double then) {
    const model::ModelInput input = input_of(R"(
mortise: 1
time: {step: 0.1 s, steps: 2}
materials: {gel: {youngs_modulus: 0.1 MPa, poisson_ratio: 0.4, density: 1000}}
bodies: {cube: {type: soft, shape: {box: {size: [1, 1, 1], edge_length: 1}}, material: gel}, floor: {type: half_space, point: [0, 0, -1]}}
effects: {inertia: {}, elasticity: {}, barrier_contact: {d_hat: 1 mm, stiffness: 1 MPa}}
)");
    Checks checks(input);
    for (double energy : {first, then, 0.5 * (first + then)}) {
      Snapshot sink;
      sink.scalar("barrier_contact", "energy", "J", energy);
      checks.state(sink, points(input, [](const Vec3& x) { return x; }));
    }
    return checks.energy().at_start;
  };
  EXPECT_DOUBLE_EQ(at_start(2, 0), 2);
  EXPECT_DOUBLE_EQ(at_start(2, 1.5), 0.5);
  EXPECT_DOUBLE_EQ(at_start(0, 3), 0);
}

// Energy that is lost where nothing touches and nothing is driven is the time step's doing; contact and work explain losses.
TEST(Checks, FreeMotionShouldLoseNoEnergy) {
  const auto lost = [](int touches_at, double work) {
    const model::ModelInput input = input_of(R"(
mortise: 1
time: {step: 0.1 s, steps: 2}
materials: {gel: {youngs_modulus: 0.1 MPa, poisson_ratio: 0.4, density: 1000}}
bodies: {cube: {type: soft, shape: {box: {size: [1, 1, 1], edge_length: 1}}, material: gel}}
effects: {inertia: {}, elasticity: {}}
)");
    Checks checks(input);
    for (int k = 0; k < 3; ++k) {
      Snapshot sink;
      sink.scalar("inertia", "kinetic_energy", "J", 4 - k);
      sink.scalar("supports", "work", "J", work);
      sink.scalar("barrier_contact", "active_pairs", "1", k == touches_at);
      checks.state(sink, points(input, [&](const Vec3& x) { return x; }));
    }
    return checks.energy().free_loss;
  };
  EXPECT_DOUBLE_EQ(lost(-1, 0), 2);
  EXPECT_DOUBLE_EQ(lost(-1, 1e-7), 2 + 2e-7);
  EXPECT_DOUBLE_EQ(lost(1, 0), 0) << "both steps have an end in contact";
  EXPECT_DOUBLE_EQ(lost(2, 0), 1);
  EXPECT_DOUBLE_EQ(lost(-1, -1), 0) << "a brake did it";
  EXPECT_DOUBLE_EQ(lost(-1, -0.5), 1) << "and half of it did not";
}

namespace {

// motion_lag of a cube of 1 m that is seen three times, `way` apart, as it gets faster: by `faster` in the second step.
double lag_of(const std::string& material, const std::string& type, const std::string& effects, double way, bool supported, double faster = 0.3) {
  const model::ModelInput input = input_of(R"(
mortise: 1
time: {step: 0.1 s, steps: 2}
materials: {stuff: )" + material + R"(}
bodies: {cube: {type: )" + type + R"(, shape: {box: {size: [1, 1, 1], edge_length: 1}}, material: stuff}}
effects: )" + effects);
  Checks checks(input);
  for (int k = 0; k < 3; ++k) {
    Snapshot sink;
    std::vector<double> v;
    for (std::size_t i = 0; i < input.bodies[0].nodes.size(); ++i)
      v.insert(v.end(), {0.5 + 0.3 * std::min(k, 1) + faster * std::max(k - 1, 0), 0, 0});
    sink.points("velocity", "m/s", 3, v);
    if (supported) sink.scalar("supports", "cube_x", "N", 1);
    checks.state(sink, points(input, [&](const Vec3& x) { return Vec3(x + Vec3(0.5 * k * way, 0, 0)); }));
  }
  return checks.energy().motion_lag;
}

}  // namespace

// Backward Euler is ahead by h/2 (v - v_0); bdf2 is not, what is held goes where it is told, and what hardly moves is not judged by its way.
TEST(Checks, BackwardEulerIsAhead) {
  const auto lag = [](const std::string& inertia, double way, bool held, double faster = 0.3) {
    return lag_of("{youngs_modulus: 0.1 MPa, poisson_ratio: 0.4, density: 1000}", "soft", "{inertia: " + inertia + ", elasticity: {}}", way, held,
                  faster);
  };
  EXPECT_NEAR(lag("{}", 2, false), 0.03 / (2 - 0.03), 1e-12);
  EXPECT_NEAR(lag("{}", 0, false), 0.03 / (0.01 * std::sqrt(3.0)), 1e-12);
  EXPECT_NEAR(lag("{}", 2, false, 0.5), 0.05 / (2 - 0.05), 1e-12) << "as the force grows: 0.05 (0.8 + 0.2) m";
  EXPECT_NEAR(lag("{}", 2, false, 0), 0.015 / (2 - 0.015), 1e-12) << "as it ends";
  EXPECT_EQ(lag("{}", 2, true), 0);
  EXPECT_TRUE(std::isnan(lag("{integrator: bdf2}", 2, false)));
}

// So are angles, and what gets slower is behind: of the angle that it should have turned by.
TEST(Checks, BackwardEulerIsAheadInTurning) {
  const model::ModelInput input = input_of(R"(
mortise: 1
time: {step: 0.1 s, steps: 2}
materials: {stuff: {density: 1000}}
bodies: {cube: {type: stiff, shape: {box: {size: [1, 1, 1], edge_length: 1}}, material: stuff}}
effects: {inertia: {}, affine_body: {}}
)");
  const auto lag = [&](const std::vector<double>& rates) {
    Checks checks(input);
    for (double rate : rates) {
      Snapshot sink;
      std::vector<double> v;
      for (const Vec3& x : input.bodies[0].nodes) {
        const Vec3 u = Vec3(0, 0, rate).cross(x);
        v.insert(v.end(), {u[0], u[1], u[2]});
      }
      sink.points("velocity", "m/s", 3, v);
      checks.state(sink, points(input, [](const Vec3& x) { return x; }));
    }
    return checks.energy().motion_lag;
  };
  EXPECT_NEAR(lag({0.5, 0.8, 1.1}), 0.03 / (0.19 - 0.03), 1e-12);
  EXPECT_NEAR(lag({1.1, 0.8, 0.5}), 0.03 / (0.13 + 0.03), 1e-12);
  EXPECT_EQ(lag({1, 1, 1}), 0);
  // What multiplies by 1.1 in every step: by the last of four rates, 0.1 s / 2 (0.1 / 1.1) in each of the steps whose acceleration is known to have
  // grown.
  const double way = 0.1 * (1.1 + 1.21 + 1.331), multiplied = 2 * 0.05 * 0.1 / 1.1 * 1.331, gained = 0.05 * (0.331 + 0.031);
  EXPECT_NEAR(lag({1, 1.1, 1.21, 1.331}), (gained + multiplied) / (way - gained - multiplied), 1e-12);
}

// A slide on the world is supported across its axis, and free along it; what a kinematic drive gives is where it should be.
TEST(Checks, BackwardEulerIsAheadOnASlideToo) {
  const auto lag = [](const std::string& effects, bool supported) {
    return lag_of("{density: 1000}", "stiff", "{inertia: {}, affine_body: {}, " + effects + "}", 2, supported);
  };
  const std::string slide = "joint: {name: rail, type: prismatic, body: cube, axis: [1, 0, 0]}", ahead = ", drive: {joint: rail, mode: ";
  EXPECT_NEAR(lag(slide, true), 0.03 / (2 - 0.03), 1e-12);
  EXPECT_NEAR(lag(slide + ahead + "effort, force: 1 N}", true), 0.03 / (2 - 0.03), 1e-12);
  EXPECT_EQ(lag(slide + ahead + "kinematic, travel: 0}", false), 0);
  EXPECT_EQ(lag("pin: {body: cube, where: {side: all}}", true), 0);
  EXPECT_EQ(lag("pin: {body: cube, where: {side: all}, release: 1 s}", true), 0);
}

// Inside of one body forces have no resultant; what its points are held with is what a defect is measured against.
TEST(Checks, BalanceIsAShareOfTheForcesThatSupportsBear) {
  const auto share = [](double held) {
    return verdict("{quantity: force_balance, below: 1e-6}", kStay, kStay,
                   [&](FieldSink& sink, int) {
                     sink.points("support_force", "N", 3, std::vector<double>{held, 0, 0, -held, 0, 0});
                     sink.scalar("balance", "largest", "N", 1e-3);
                     for (const char* name : {"defect_x", "defect_y", "defect_z"}) sink.scalar("balance", name, "N", name[7] == 'x' ? 1e-3 : 0);
                   })
        .value;
  };
  EXPECT_DOUBLE_EQ(share(0), 1);
  EXPECT_DOUBLE_EQ(share(5000), 1e-7);
}

TEST(Checks, WhatIsNotANumberFails) {
  const auto nan = [](FieldSink& sink, int k) { sink.scalar("elasticity", "det_F_min", "1", k ? 1 : NAN); };
  EXPECT_FALSE(verdict("{quantity: min_det_f, above: 0}", kStay, kStay, nan).pass);
  EXPECT_FALSE(verdict("{quantity: min_det_f, above: 0}").pass) << "nothing was measured";
}

TEST(Checks, OutcomeIsAboutTheError) {
  const std::string wants = "{quantity: outcome, is: step_failed, says: [Newton, residual]}";
  EXPECT_TRUE(verdict(wants, kStay, kStay, {}, Exit::solve, "Newton stopped with a residual").pass);
  EXPECT_FALSE(verdict(wants, kStay, kStay, {}, Exit::solve, "Newton stopped").pass);
  EXPECT_FALSE(verdict(wants, kStay, kStay, {}, Exit::done).pass);
  const auto json = nlohmann::json::parse(Checks::add_to("{}", {verdict(wants)}));
  EXPECT_EQ(json["criteria"][0]["value"], "done");
  EXPECT_EQ(json["criteria"][0]["pass"], false);
}

}  // namespace
