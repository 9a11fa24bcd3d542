#include "effects/inertia/inertia.h"

#include <gtest/gtest.h>

#include "base/memory_archive.h"
#include "problem.h"

using namespace mortise;
using namespace mortise::effects;

namespace {

Params integrator(const std::string& name) { return fd::table({{"integrator", Params::make_text(name)}}); }

StepInfo step_info(double dt, Index step = 0) {
  StepInfo s;
  s.dt = dt, s.step = step;
  return s;
}

// Error at t = 2 of q'' = -q, q(0) = 1, v(0) = 0, with steps whose length changes by a factor 1.5 back and forth.
double oscillator_error(bool bdf2, int steps) {
  const double end = 2;
  Vec3 q(1, 0, 0), v(0, 0, 0), q1 = q, v1 = v;
  double dt_prev = 0, t = 0;
  for (int k = 0; k < steps; ++k) {
    const double dt = (k % 2 ? 1.2 : 0.8) * end / steps;
    const Integrator in = bdf2 && k > 0 ? effects::bdf2(dt, dt_prev) : backward_euler(dt);
    // minimum of c/2 (q - q_hat)^2 + q^2/2
    const Vec3 next = inertia::c_of(in) * inertia::q_hat(in, q, q1, v, v1) / (inertia::c_of(in) + 1);
    const Vec3 velocity = in.rate(next, q, q1);
    q1 = q, v1 = v, q = next, v = velocity, dt_prev = dt, t += dt;
  }
  return std::abs(q[0] - std::cos(t)) + std::abs(v[0] + std::sin(t));
}

// The minimum of an effect that is quadratic in q: one exact Newton step.
fd::Vector minimum(fd::Subject& e, const fd::Vector& x) {
  const fd::Dense d = fd::effect_assemble(e, x, true);
  return x - d.hessian.ldlt().solve(d.gradient);
}

// Moves the model to `x`, as an accepted step does.
void accept(fd::Subject& e, model::Model& m, const fd::Vector& x) {
  m.q.upload(fd::blocks_of(x));
  e.end_step(std::as_const(m.q).view());
}

}  // namespace

TEST(Inertia, OrderOfTheIntegrators) {
  const double euler = oscillator_error(false, 200) / oscillator_error(false, 400);
  const double bdf2 = oscillator_error(true, 200) / oscillator_error(true, 400);
  EXPECT_NEAR(euler, 2, 0.1);
  EXPECT_NEAR(bdf2, 4, 0.2);
  EXPECT_LT(oscillator_error(true, 400), 1e-4);
}

TEST(Inertia, VelocityAndAccelerationAreExactForParabolas) {
  // BDF2 differentiates polynomials of degree two exactly, for any ratio of steps.
  const double dt1 = 0.1, dt2 = 0.17;
  const Integrator in = effects::bdf2(dt2, dt1);
  const auto q = [](double t) { return Vec3(1 + 2 * t - 3 * t * t, t, t * t); };
  const auto v = [](double t) { return Vec3(2 - 6 * t, 1, 2 * t); };
  const double t = 0.4;
  EXPECT_LT((in.rate(q(t + dt2), q(t), q(t - dt1)) - v(t + dt2)).norm(), 1e-14);
  const Vec3 a = inertia::c_of(in) * (q(t + dt2) - inertia::q_hat(in, q(t), q(t - dt1), v(t), v(t - dt1)));
  EXPECT_LT((a - Vec3(-6, 0, 2)).norm(), 1e-12);
}

TEST(Inertia, Derivatives) {
  model::Model m(fd::box_and_ball());
  for (const char* name : {"backward_euler", "bdf2"}) {
    const auto e = fd::make_effect("inertia", integrator(name), m);
    e->begin_step(step_info(0.01));
    const fd::Errors errors = fd::effect_errors(*e, fd::shaken(m, 0.1), 1e-2);
    EXPECT_LT(errors.gradient, 1e-6);
    EXPECT_LT(errors.hessian, 1e-5);
    EXPECT_GT(fd::lowest_eigenvalue(fd::effect_assemble(*e, fd::shaken(m, 0.1), true).hessian), 0);
  }
}

TEST(Inertia, WithoutForcesEveryBlockKeepsItsVelocity) {
  for (const char* name : {"backward_euler", "bdf2"}) {
    model::Model m(fd::box_and_ball());
    const auto e = fd::make_effect("inertia", integrator(name), m);
    const fd::Vector v = fd::flatten(m.initial_velocity.download());
    fd::Vector expected = fd::flatten(m.q.download());
    for (int k = 0; k < 4; ++k) {
      const double dt = k % 2 ? 0.01 : 0.02;
      e->begin_step(step_info(dt, k));
      expected += dt * v;
      const fd::Vector x = minimum(*e, fd::shaken(m, 0.1));
      EXPECT_LT((x - expected).norm(), 1e-11) << name;
      accept(*e, m, x);
    }
  }
}

TEST(Inertia, SecondStepOfBdf2WeighsHistory) {
  // Steps 0.02 and 0.03, w = 3/2: the Hessian is (a0/dt)^2 M with a0 = (1 + 2w)/(1 + w); backward Euler has a0 = 1.
  for (const auto& [name, a0] : {std::pair{"backward_euler", 1.0}, std::pair{"bdf2", 1.6}}) {
    model::Model m(fd::box_and_ball());
    const auto e = fd::make_effect("inertia", integrator(name), m);
    const fd::Vector x = fd::shaken(m, 0.1);
    e->begin_step(step_info(1));
    const fd::Matrix M = fd::effect_assemble(*e, x, true).hessian;  // the first step is backward Euler
    e->begin_step(step_info(0.02));
    e->end_step(std::as_const(m.q).view());
    e->begin_step(step_info(0.03, 1));
    const fd::Matrix H = fd::effect_assemble(*e, x, true).hessian;
    EXPECT_LT((H - a0 * a0 / (0.03 * 0.03) * M).norm(), 1e-12 * H.norm()) << name;
  }
}

TEST(Inertia, RetriedStepsStartFromTheSameState) {
  model::Model m(fd::box_and_ball());
  const auto a = fd::make_effect("inertia", integrator("bdf2"), m), b = fd::make_effect("inertia", integrator("bdf2"), m);
  for (fd::Subject* e : {a.get(), b.get()}) {
    e->begin_step(step_info(0.03));
    e->end_step(std::as_const(m.q).view());
  }
  a->begin_step(step_info(0.02, 1));  // fails, is tried again
  a->begin_step(step_info(0.01, 1));
  b->begin_step(step_info(0.01, 1));
  const fd::Vector x = fd::shaken(m, 0.1);
  EXPECT_EQ(fd::effect_energy(*a, x), fd::effect_energy(*b, x));
  EXPECT_EQ(fd::effect_assemble(*a, x, false).gradient, fd::effect_assemble(*b, x, false).gradient);
}

TEST(Inertia, RestartIsBitwise) {
  model::Model m(fd::box_and_ball());
  const auto a = fd::make_effect("inertia", integrator("bdf2"), m), b = fd::make_effect("inertia", integrator("bdf2"), m);
  for (Index k = 0; k < 3; ++k) {
    a->begin_step(step_info(0.01 * (k + 1), k));
    accept(*a, m, fd::shaken(m, 0.01, k));
  }
  MemoryArchive archive;
  a->checkpoint(archive);
  archive.rewind();
  b->checkpoint(archive);
  a->begin_step(step_info(0.02, 3));
  b->begin_step(step_info(0.02, 3));
  const fd::Vector x = fd::shaken(m, 0.1);
  EXPECT_EQ(fd::effect_energy(*a, x), fd::effect_energy(*b, x));
  EXPECT_EQ(fd::effect_assemble(*a, x, false).gradient, fd::effect_assemble(*b, x, false).gradient);
}

TEST(Inertia, ReportsMomentumEnergyAndPointVelocities) {
  model::Model m(fd::box_and_ball());
  const auto e = fd::make_effect("inertia", integrator("backward_euler"), m);
  fd::Recorder sink;
  e->report(sink);
  // linear: m v of both bodies (their rotation is about the centre of mass)
  const Vec3 P = m.bodies[0].mass * Vec3(1, -2, 0.5) + m.bodies[1].mass * Vec3(1, 2, 3);
  EXPECT_NEAR(sink.scalars["inertia.momentum_x"], P[0], 1e-9);
  EXPECT_NEAR(sink.scalars["inertia.momentum_y"], P[1], 1e-9);
  EXPECT_NEAR(sink.scalars["inertia.momentum_z"], P[2], 1e-9);
  // the ball alone: L = c x m v + I w, T = 1/2 m v^2 + 1/2 w.I w
  const geometry::TriMesh surface{m.input.bodies[1].nodes, m.input.bodies[1].triangles};
  const auto properties = geometry::mass_properties(surface);
  const Vec3 w(0.5, -1, 4), v(1, 2, 3);
  Vec3 L = m.bodies[1].centre.cross(m.bodies[1].mass * v) + properties.inertia(2000) * w;
  double T = 0.5 * m.bodies[1].mass * v.squaredNorm() + 0.5 * w.dot(properties.inertia(2000) * w);
  // the box: as if it were stiff
  const model::BodyInput& box = m.input.bodies[0];
  const auto of_box = geometry::mass_properties({box.nodes, box.triangles});
  const Vec3 vb = box.params.vec3("velocity"), wb = box.params.vec3("angular_velocity");
  const Mat3 inertia = of_box.inertia(m.bodies[0].density);
  L += m.bodies[0].centre.cross(m.bodies[0].mass * vb) + inertia * wb;
  T += 0.5 * m.bodies[0].mass * vb.squaredNorm() + 0.5 * wb.dot(inertia * wb);
  EXPECT_NEAR(sink.scalars["inertia.kinetic_energy"], T, 1e-9 * T);
  EXPECT_NEAR(sink.scalars["inertia.angular_momentum_x"], L[0], 1e-9 * L.norm());
  EXPECT_NEAR(sink.scalars["inertia.angular_momentum_y"], L[1], 1e-9 * L.norm());
  EXPECT_NEAR(sink.scalars["inertia.angular_momentum_z"], L[2], 1e-9 * L.norm());
  // a vertex of the ball moves with v + w x r
  const Index p = m.bodies[1].point_begin;
  const Vec3 expected = v + w.cross(m.input.bodies[1].nodes[0] - m.bodies[1].centre);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(sink.point["velocity"][3 * p + k], expected[k], 1e-12);
}

// Masses that stand on nodes, and what spreading them adds: (M_spread - M) a.
TEST(Inertia, MassesOnNodesAreSpreadWhereThatIsMended) {
  model::Model m(fd::box_and_ball());
  m.bodies[0].stays = true;
  const auto e = fd::make_effect("inertia", integrator("backward_euler"), m), leader = fd::make_effect("inertia", integrator("backward_euler"), m);
  for (const auto& each : {e.get(), leader.get()}) each->begin_step(step_info(0.01));
  const fd::Vector x = fd::shaken(m, 0.01);
  const std::vector<Vec3> before = fd::blocks_of(fd::effect_assemble(*e, x, false).gradient);
  e->effect->mend(Fault::mesh, 1);
  const device::Buffer<Vec3> q(fd::blocks_of(x));
  e->effect->keep_pace(*leader->effect, q.view());
  const std::vector<Vec3> after = fd::blocks_of(fd::effect_assemble(*e, x, false).gradient);
  const std::vector<Index> row = m.mass.row_offset.download(), column = m.mass.column.download();
  const std::vector<double> mass = m.mass.value.download();
  double largest = 0;
  for (Index i = 0; i < m.bodies[0].block_end; ++i) {
    Vec3 spread = Vec3::Zero();
    for (Index k = row[i]; k < row[i + 1]; ++k) {
      double on_node = 0;
      for (Index l = row[column[k]]; l < row[column[k] + 1]; ++l) on_node += mass[l];
      spread += mass[k] / on_node * before[column[k]];
    }
    EXPECT_LT((after[i] - spread).norm(), 1e-9 * before[i].norm());
    largest = std::max(largest, (after[i] - before[i]).norm() / before[i].norm());
  }
  EXPECT_GT(largest, 0.1);
  for (Index i = m.bodies[1].block_begin; i < m.bodies[1].block_end; ++i) EXPECT_EQ(after[i], before[i]) << "of a stiff body";
}
