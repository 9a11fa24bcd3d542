// What certificates judge where: the most loaded state and the last one, every group of bodies by itself; loads that turned, round bodies, creep.
#include "audit/field_errors.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <memory>
#include <numbers>
#include <sstream>

#include "audit/bearing_creep.h"
#include "audit/crept.h"
#include "audit/shape_defect.h"
#include "audit/stress_error.h"
#include "base/memory_archive.h"
#include "geometry/primitives.h"
#include "geometry/shapes.h"
#include "tables.h"

using namespace mortise;
using mortise::testing::number;
using mortise::testing::table;

namespace {

// Two soft bodies of two tetrahedra each, 5 m apart, and nothing that holds them.
model::ModelInput two() {
  model::ModelInput input{table({{"effects", Params::make_table()}}), {}};
  for (double x : {0., 5.}) {
    model::BodyInput body;
    body.name = x == 0 ? "one" : "other";
    body.material = table({{"youngs_modulus", number(1e5)}, {"poisson_ratio", number(0.3)}, {"density", number(1e3)}});
    body.nodes = {{x, 0, 0}, {x + 1, 0, 0}, {x, 1, 0}, {x, 0, 1}, {x + 1, 1, 1}};
    body.tets = {{{0, 1, 2, 3}}, {{1, 2, 3, 4}}};
    input.bodies.push_back(body);
  }
  return input;
}

// Stresses zz of the four tetrahedra [Pa]; force of contact between the bodies, and the guard's part of it [N].
Snapshot state(double energy, const std::array<double, 4>& zz, double force = 0, double guard = 0) {
  Snapshot said;
  std::vector<double> stress(24, 0.0);
  for (std::size_t t = 0; t < 4; ++t) stress[6 * t + 2] = zz[t];
  said.scalar("elasticity", "energy", "J", energy);
  said.cells("cauchy_stress", "Pa", 6, stress);
  said.points("displacement", "m", 3, std::vector<double>(30, 0.0));
  said.points("contact_pressure", "Pa", 1, std::vector<double>(10, force));
  said.rows("mortar_contact", "bodies", "1", 2, std::vector<double>{0, 1});
  said.rows("mortar_contact", "gap", "m", 1, std::vector<double>{1e-3});
  said.rows("mortar_contact", "force", "N", 1, std::vector<double>{force - guard});
  said.rows("mortar_contact", "guard_bodies", "1", 2, std::vector<double>{0, 1});
  said.rows("mortar_contact", "guard_force", "N", 1, std::vector<double>{guard});
  return said;
}

audit::FieldErrors::Result after(const std::vector<Snapshot>& states) {
  audit::FieldErrors errors(two());
  for (const Snapshot& s : states) errors.state(s);
  return errors.result();
}

}  // namespace

TEST(FieldErrors, TheLastLoadedStateCountsToo) {
  const std::array<double, 4> even{1e3, 1e3, 1e3, 1e3}, jumps{1e2, -1e2, 1e2, -1e2};
  EXPECT_NEAR(after({state(1, even)}).stress, 0, 1e-9);
  EXPECT_GT(after({state(1, even), state(0.01, jumps)}).stress, 0.3) << "a tenth of the load";
  EXPECT_NEAR(after({state(1, even), state(1e-5, jumps)}).stress, 0, 1e-9) << "what unloading leaves";
  EXPECT_NEAR(after({state(1, even), state(0.01, jumps), state(1, even)}).stress, 0, 1e-9) << "nobody looks at that one";
}

// Phases are told from each other by what a scene asks of anything: here of a pin, at 1, 2 and 3 s.
TEST(FieldErrors, WhatAPhaseChangesIsJudgedByItself) {
  const auto numbers = [](std::initializer_list<double> values) {
    Params out = Params::make_list();
    for (double v : values) out.push(number(v));
    return out;
  };
  model::ModelInput input = two();
  const Params turn = table({{"axis", numbers({0, 0, 1})}, {"centre", numbers({0, 0, 0})}, {"angle", numbers({0, 1, 2, 3})}});
  const Params motion =
      table({{"time", numbers({0, 1, 2, 3})}, {"interpolation", Params::make_text("linear")}, {"rotation", Params::make_list({turn})}});
  const Params pin = table({{"body", Params::make_text("one")},
                            {"axes", Params::make_text("z")},
                            {"where", table({{"side", Params::make_text("z_min")}})},
                            {"motion", motion}});
  input.scene = table({{"effects", table({{"pin", Params::make_list({pin})}})}});
  const auto after = [&](const std::vector<std::pair<double, std::array<double, 4>>>& states, std::size_t break_after = 0) {
    auto errors = std::make_unique<audit::FieldErrors>(input);
    for (std::size_t i = 0; i < states.size(); ++i) {
      errors->state(state(2e4, states[i].second), states[i].first);  // roughly s^2 V / 2E
      if (i + 1 != break_after) continue;
      MemoryArchive archive;
      errors->checkpoint(archive);
      archive.rewind();
      errors = std::make_unique<audit::FieldErrors>(input);
      errors->checkpoint(archive);
    }
    return errors->result().stress;
  };
  const std::array<double, 4> pressed{1e5, 1e5, 1e5, 1e5}, bent{1.1e5, 0.9e5, 1.1e5, 0.9e5}, more{2e5, 2e5, 2e5, 2e5};
  EXPECT_NEAR(after({{1, pressed}, {2, more}}), 0, 1e-9);
  EXPECT_GT(after({{1, pressed}, {2, bent}}), 0.3) << "a hundredth of the energy, all of it bent badly";
  EXPECT_GT(after({{1, pressed}, {2, bent}}, 1), 0.3) << "resumed in between";
  EXPECT_LT(after({{1, pressed}, {1.9, bent}, {2, more}}), 0.02) << "within a phase nobody looks";
  EXPECT_GT(after({{1, {1e4, -1e4, 1e4, -1e4}}, {2, pressed}, {3, more}}), 0.3) << "what comes later hides nothing";
  EXPECT_LT(after({{1, pressed}, {2, {1.0001e5, 0.9999e5, 1.0001e5, 0.9999e5}}}), 1e-3) << "no phase: what steps leave unsolved";
}

TEST(FieldErrors, ABodyThatStandsByItselfHidesNothing) {
  const std::array<double, 4> mixed{1e2, -1e2, 1e3, 1e3};
  const double apart = after({state(1, mixed)}).stress, together = after({state(1, mixed, 1.0)}).stress;
  EXPECT_GT(apart, 0.3);
  EXPECT_LT(together, 0.02) << "pressed on each other they are one thing, of which most of the energy is right";
}

// A pad of one element between two plates: its stress is even, and says nothing.
TEST(FieldErrors, ElementsWithoutAFreeNodeTellNothing) {
  for (const Index layers : {1, 2}) {
    model::BodyInput body;
    body.name = "pad", body.material = two().bodies[0].material;
    model::set_mesh(body, geometry::box(Vec3(4, 4, 1), {4, 4, layers}));
    const auto pin = [](const char* side, const char* axes) {
      return table({{"body", Params::make_text("pad")}, {"axes", Params::make_text(axes)}, {"where", table({{"side", Params::make_text(side)}})}});
    };
    const auto error = [&](const Params& pins) {
      const model::ModelInput input{table({{"effects", table({{"pin", pins}})}}), {body}};
      std::vector<double> stress(6 * body.tets.size(), 0.0);
      for (std::size_t t = 0; t < body.tets.size(); ++t) stress[6 * t + 2] = 1e3;
      return ([&] {
        const audit::StressError estimate(input);
        return estimate.of(estimate.stresses(stress, std::vector<double>(3 * body.nodes.size(), 0.0)), {0}).error();
      })();
    };
    EXPECT_NEAR(error(Params::make_list({pin("z_min", "xyz"), pin("z_max", "xyz")})), layers == 1 ? 0.5 : 0, 1e-9);
    EXPECT_NEAR(error(Params::make_list({pin("z_min", "xyz"), pin("z_max", "z")})), 0, 1e-9);
    EXPECT_NEAR(error(Params::make_list({pin("z_min", "xyz"), pin("z_max", "xy"), pin("z_max", "z")})), layers == 1 ? 0.5 : 0, 1e-9);
  }
}

TEST(FieldErrors, TheGuardIsJudgedByPairs) {
  const std::array<double, 4> even{1e3, 1e3, 1e3, 1e3};
  EXPECT_DOUBLE_EQ(after({state(1, even, 2.0, 0.5)}).guard, 0.25);
  Snapshot said = state(1, even, 2.0, 0.5);
  said.row["mortar_contact/bodies"] = {}, said.row["mortar_contact/force"] = {};
  said.rows("mortar_contact", "bodies", "1", 2, std::vector<double>{0, 1, 1, 2});
  said.rows("mortar_contact", "force", "N", 1, std::vector<double>{0.1, 8});
  EXPECT_DOUBLE_EQ(after({said}).guard, 0.5 / 0.6) << "of 0.6 N, beside a pair of 8 N";
  said.row["mortar_contact/force"][1] = 80;
  EXPECT_DOUBLE_EQ(after({said}).guard, 0) << "less than a hundredth of that";
}

// Faces that grow by l in both directions: l^2 - 1; that turn by t: 2 sin(t/2).
TEST(LoadTurned, IsHowFarAreasAreFromThoseAtRest) {
  model::BodyInput body;
  body.name = "pad";
  model::set_mesh(body, geometry::box(Vec3(1, 1, 1), {2, 2, 2}));
  const Params list = Params::make_list(
      {table({{"body", Params::make_text("pad")}, {"pressure", number(1)}, {"where", table({{"side", Params::make_text("z_max")}})}})});
  const model::ModelInput input{table({{"effects", table({{"pressure_load", list}})}}), {body}};
  const audit::LoadTurned turned(input);
  const auto of = [&](const Mat3& F) {
    std::vector<double> u;
    for (const Vec3& x : body.nodes)
      for (int c = 0; c < 3; ++c) u.push_back((F * x - x)[c]);
    return turned.of(u);
  };
  EXPECT_NEAR(of(Vec3(1.1, 1.1, 0.5).asDiagonal()), 0.21, 1e-12);
  EXPECT_NEAR(of(Eigen::AngleAxisd(0.3, Vec3(1, 2, 0).normalized()).toRotationMatrix()), 2 * std::sin(0.15), 1e-12);
  EXPECT_TRUE(std::isnan(audit::LoadTurned({table({{"effects", Params::make_table()}}), {body}}).of(std::vector<double>(3 * body.nodes.size()))));
}

// A cylinder whose section is a polygon of n corners lacks 1 - sin(2 pi/n) n/(2 pi) of its volume.
TEST(ShapeDefect, IsTheVolumeThatFacetsLeaveOut) {
  const auto defect = [](const char* kind, double edge, bool soft, const std::vector<std::pair<std::string, Params>>& more = {},
                         const Params& effects = Params::make_table()) {
    Params shape = table({{kind, table({{"radius", number(1)}, {"height", number(2)}, {"edge_length", number(edge)}})}});
    std::vector<std::pair<std::string, Params>> entries{{"shape", shape}};
    entries.insert(entries.end(), more.begin(), more.end());
    model::BodyInput body;
    body.name = "round", body.params = table(entries);
    body.material = table({{"density", number(1e3)}});
    body.type = soft ? model::BodyType::soft : model::BodyType::stiff;
    if (soft) {
      model::set_mesh(body, geometry::tet_shape(shape));
    } else {
      const geometry::TriMesh mesh = geometry::surface_shape(shape);
      body.nodes = mesh.points, body.triangles = mesh.triangles;
    }
    return audit::shape_defect({table({{"effects", effects}}), {body}});
  };
  const auto polygon = [](double n) { return 1 - std::sin(2 * std::numbers::pi / n) * n / (2 * std::numbers::pi); };
  EXPECT_NEAR(defect("cylinder", 0.8, true), polygon(8), 1e-9);
  EXPECT_GT(defect("sphere", 1, false), 0.15);
  EXPECT_LT(defect("sphere", 0.2, false), 0.015);
  EXPECT_LT(defect("capsule", 0.2, false), 0.015);
  EXPECT_EQ(defect("sphere", 1, false, {{"mass", number(1)}}), 0) << "the scene states its mass";
  const auto vector = [](const Vec3& v) { return Params::make_list({number(v[0]), number(v[1]), number(v[2])}); };
  const auto hinge = [&](const Vec3& at, const Vec3& axis) {
    return table({{"joint", Params::make_list({table({{"type", Params::make_text("revolute")},
                                                      {"name", Params::make_text("axle")},
                                                      {"body", Params::make_text("round")},
                                                      {"at", vector(at)},
                                                      {"axis", vector(axis)}})})}});
  };
  const std::vector<std::pair<std::string, Params>> placed{{"mass", number(1)}, {"position", vector({1, 0, 0})}};
  EXPECT_GT(defect("cylinder", 0.8, false, placed, hinge({1, 0, 3}, {0, 0, 2})), 0.05) << "it turns about its axis";
  EXPECT_EQ(defect("cylinder", 0.8, false, placed, hinge({0, 0, 0}, {0, 0, 1})), 0) << "beside it";
  EXPECT_EQ(defect("cylinder", 0.8, false, placed, hinge({1, 0, 0}, {1, 0, 0})), 0) << "across it";
}

// A tube in a file, as fine as it may be, and filled with coarse tetrahedra: chords inside and outside, so that its volume is nearly right.
TEST(ShapeDefect, OfAFileIsWhatRemeshingCutsInsideAndOut) {
  const Index around = 160;
  std::ostringstream obj;
  obj.precision(12);
  for (const double z : {0.0, 8.0})
    for (const double r : {6.0, 8.0})
      for (Index k = 0; k < around; ++k)
        obj << "v " << r * std::cos(2 * M_PI * k / around) << ' ' << r * std::sin(2 * M_PI * k / around) << ' ' << z << '\n';
  const auto wall = [&](Index from, Index to) {  // between two rings
    for (Index k = 0; k < around; ++k) {
      const Index a = from * around + k, b = from * around + (k + 1) % around, c = to * around + (k + 1) % around, d = to * around + k;
      obj << "f " << a + 1 << ' ' << b + 1 << ' ' << c + 1 << "\nf " << a + 1 << ' ' << c + 1 << ' ' << d + 1 << '\n';
    }
  };
  wall(1, 3), wall(3, 2), wall(2, 0), wall(0, 1);
  const std::string file = ::testing::TempDir() + "tube_of_shape_defect.obj";
  std::ofstream(file) << obj.str();
  const auto defect = [&](double edge) {
    const Params shape =
        table({{"mesh", table({{"file", Params::make_text(file)}, {"scale", number(1e-3)}, {"weld", number(0)}, {"edge_length", number(edge)}})}});
    model::BodyInput body;
    body.name = "tube", body.type = model::BodyType::soft, body.material = table({{"density", number(1e3)}});
    body.params = table({{"shape", shape}, {"position", Params::make_list({number(0.1), number(0), number(0)})}});
    model::set_mesh(body, geometry::tet_shape(shape));
    for (Vec3& x : body.nodes) x += Vec3(0.1, 0, 0);
    return audit::shape_defect({table({{"effects", Params::make_table()}}), {body}});
  };
  const double coarse = defect(2.8e-3), fine = defect(1.6e-3);
  EXPECT_GT(coarse, 0.04);
  EXPECT_LT(coarse, 0.08);
  EXPECT_LT(fine, 0.6 * coarse);
  EXPECT_GT(fine, 0.2 * coarse);
}

// Two bodies of a point each, at which both stick to an obstacle and to each other.
TEST(Crept, IsTheSlipOfWhatSticks) {
  model::ModelInput input = two();
  input.scene = table({{"effects", table({{"friction", table({{"creep_speed", number(1e-5)}, {"follows", Params::make_text("mortar_contact")}})}})}});
  audit::Crept crept(input);
  const std::size_t points = input.bodies[0].nodes.size() + input.bodies[1].nodes.size();
  // The first body against the obstacle at `speed`, with all the rest at rest; the second one goes that far.
  const auto slips = [&](double speed, double first_goes, double second_goes, double sticks = 1) {
    Snapshot said;
    std::vector<double> u(3 * points, 0.0);
    for (std::size_t i = 0; i < points; ++i) u[3 * i + 1] = i < input.bodies[0].nodes.size() ? first_goes : second_goes;
    said.points("displacement", "m", 3, u);
    said.rows("mortar_contact", "bodies", "1", 2, std::vector<double>{0, 2});
    said.rows("mortar_contact", "guard_bodies", "1", 2, std::vector<double>{2, 0});
    said.rows("friction", "force", "N", 3, std::vector<double>{3, 0, 0, 0, 4, 0});
    said.rows("friction", "slip", "m", 3, std::vector<double>{-0.5 * speed, 0, 0, 0, -0.5 * speed, 0});
    said.rows("friction", "sticks", "1", 1, std::vector<double>{sticks, sticks});
    said.scalar("friction", "power", "W", 7 * speed);
    crept.state(said, audit::rubbing(audit::friction_laws(input), said));
    crept.step(100);
  };
  const double least = 0.01 * std::sqrt(3.0);  // a hundredth of a body
  slips(4e-6, 1e-3, 0);
  EXPECT_NEAR(crept.share(), 4e-4 / least, 1e-12);
  slips(4e-6, 1e-3, 0, 0);
  EXPECT_NEAR(crept.share(), 4e-4 / least, 1e-12) << "it slips, slowly";
  slips(1e-6, 1e-3, 9);
  EXPECT_NEAR(crept.share(), 5e-4 / least, 1e-12) << "another one goes far";
  MemoryArchive saved;
  crept.checkpoint(saved);
  saved.rewind();
  audit::Crept resumed(input);
  resumed.checkpoint(saved);
  EXPECT_EQ(resumed.share(), crept.share());
  slips(1e-6, 2, 0);
  EXPECT_NEAR(crept.share(), 6e-4 / (2 - 1e-3), 1e-12) << "since they touch";
  // Apart, on its way to somewhere else, and there again.
  Snapshot away;
  std::vector<double> u(3 * points, 0.0);
  for (std::size_t i = 0; i < input.bodies[0].nodes.size(); ++i) u[3 * i + 1] = 4;
  away.points("displacement", "m", 3, u);
  crept.state(away, audit::rubbing(audit::friction_laws(input), away));
  crept.step(100);
  slips(1e-6, 7, 0);
  EXPECT_NEAR(crept.share(), 7e-4 / (2 - 1e-3), 1e-12);
  slips(1e-6, 8, 0);
  EXPECT_NEAR(crept.share(), 8e-4 / (3 - 1e-3), 1e-12);
  input.scene = table({{"effects", Params::make_table()}});
  EXPECT_TRUE(std::isnan(audit::Crept(input).share()));
}

// An arm that its bearing holds; what turns faster slips.
TEST(BearingCreep, IsTheWayOfWhatABearingHolds) {
  const auto text = [](const char* v) { return Params::make_text(v); };
  const auto input = [&](const char* mode) {
    const Params joint = table({{"name", text("hip")}, {"type", text("revolute")}, {"body", text("arm")}});
    const Params drive = table({{"joint", text("hip")}, {"mode", text(mode)}, {"friction", number(1)}});
    const Params effects = table({{"inertia", table({})}, {"joint", Params::make_list({joint})}, {"drive", Params::make_list({drive})}});
    return model::ModelInput{table({{"time", table({{"step", number(0.1)}})}, {"effects", effects}}), {}};
  };
  audit::BearingCreep creep(input("passive"));
  const auto go = [&](double angle, double rate, double dt) {
    Snapshot said;
    said.scalar("joint", "hip_angle", "rad", angle);
    said.scalar("joint", "hip_rate", "rad/s", rate);
    creep.state(said);
    creep.step(dt);
  };
  go(0, 0, 0);
  go(0.001, 5e-4, 2);
  EXPECT_NEAR(creep.share(), 0.02, 1e-9) << "of a twentieth of a radian";
  go(0.2, 0.1, 2);
  EXPECT_NEAR(creep.share(), 0.005, 1e-9) << "of the way that it went";
  EXPECT_TRUE(std::isnan(audit::BearingCreep(input("pd")).share())) << "a motor holds it";
}
