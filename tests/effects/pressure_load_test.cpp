#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "geometry/midsides.h"
#include "problem.h"

using namespace mortise;
using namespace mortise::effects;
using mortise::testing::vec;
using mortise::testing::where_side;

namespace {

Params load(const std::string& body, const std::string& side) {
  return fd::table({{"body", Params::make_text(body)}, {"where", where_side(side)}, {"traction_factor", Params::make_number(1)}});
}
Params pressed(const std::string& body, const std::string& side) {
  Params p = load(body, side);
  p.set("pressure", fd::table({{"time", fd::numbers({0, 1})}, {"value", fd::numbers({0, 2000})}}));
  return p;
}
std::unique_ptr<fd::Subject> make(model::Model& m, std::vector<Params> loads) {
  return fd::make_effect("pressure_load", Params::make_list(std::move(loads)), m);
}

void until(fd::Subject& e, double t) {
  StepInfo s;
  s.t0 = t - 0.1, s.dt = 0.1;
  e.begin_step(s);
}

Vec3 force_on(fd::Subject& e, const model::Model& m, const model::Body& body) {
  const auto g = fd::blocks_of(fd::effect_assemble(e, fd::shaken(m, 0.1), true).gradient);
  Vec3 force = Vec3::Zero();
  const Index end = body.type == model::BodyType::stiff ? body.block_begin + 1 : body.block_end;
  for (Index b = body.block_begin; b < end; ++b) force -= g[b];
  return force;
}

}  // namespace

TEST(PressureLoad, PushesInwardWithPressureTimesArea) {
  model::Model m(fd::box_and_ball());
  const auto e = make(m, {pressed("box", "z_max"), pressed("box", "x_min")});
  EXPECT_EQ(force_on(*e, m, m.bodies[0]).norm(), 0);  // nothing at t = 0
  until(*e, 0.5);
  EXPECT_LT((force_on(*e, m, m.bodies[0]) - Vec3(2 * 1000, 0, -1 * 1000)).norm(), 1e-9);  // faces of 2 and 1 m^2
  EXPECT_EQ(force_on(*e, m, m.bodies[1]).norm(), 0);
  fd::Recorder sink;
  e->report(sink);
  EXPECT_NEAR(sink.scalars["pressure_load.force_x"], 2000, 1e-9);
  EXPECT_NEAR(sink.scalars["pressure_load.force_z"], -1000, 1e-9);
}

TEST(PressureLoad, ClosedSurfaceFeelsNoResultant) {
  model::Model m(fd::box_and_ball());
  const auto e = make(m, {pressed("box", "all"), pressed("ball", "all")});
  until(*e, 1);
  EXPECT_LT(force_on(*e, m, m.bodies[0]).norm(), 1e-9);
  EXPECT_LT(force_on(*e, m, m.bodies[1]).norm(), 1e-9);
  // but squeezes: the work of pressure p on a volume change dV is -p dV
  std::vector<Vec3> q = m.rest.download();
  for (Index b = m.bodies[0].block_begin; b < m.bodies[0].block_end; ++b) q[b] *= 1 + 1e-3;
  EXPECT_NEAR(fd::effect_energy(*e, fd::flatten(q)), 2000 * 3 * 1e-3 * m.bodies[0].volume, 1e-8);
  q = m.rest.download();
  for (int k = 0; k < 3; ++k) q[m.bodies[1].block_begin + 1 + k] *= 1 + 1e-3;
  EXPECT_NEAR(fd::effect_energy(*e, fd::flatten(q)), 2000 * 3 * 1e-3 * m.bodies[1].volume, 1e-8);
}

TEST(PressureLoad, TractionIsForcePerArea) {
  model::Model m(fd::box_and_ball());
  Params p = load("box", "z_max");
  p.set("traction", vec({30, 0, 5}));
  p.set("traction_factor", fd::table({{"time", fd::numbers({0, 2})}, {"value", fd::numbers({0, 1})}}));
  const auto e = make(m, {p});
  until(*e, 1);
  EXPECT_LT((force_on(*e, m, m.bodies[0]) - Vec3(15, 0, 2.5)).norm(), 1e-10);
}

// A box and a ball cut triangles: the resultant and its place are those of what they cut out of the face, on linear and quadratic elements, however
// fine. The walls below the face, of which they hold a rim, carry nothing.
TEST(PressureLoad, LoadsTheAreaOfABlockThatCutsTriangles) {
  Params box = Params::make_table(), ball = Params::make_table();
  box.set("box", fd::table({{"min", vec({-0.13, -0.9, 0.1})}, {"max", vec({0.31, 0.77, 0.3})}}));
  ball.set("sphere", fd::table({{"centre", vec({0.05, 0.3, 0.5})}, {"radius", Params::make_number(0.5)}}));
  Params lines = Params::make_table();
  lines.set("box", fd::table({{"min", vec({-0.25 - 1e-3, -0.5 + 1e-9, 0.2 - 1e-6})}, {"max", vec({0.25 + 1e-3, 0.75 - 1e-9, 0.2 + 1e-6})}}));
  // Smaller than a triangle; and one that holds a rim of the walls beside it as well.
  Params spot = Params::make_table(), corner = Params::make_table();
  spot.set("box", fd::table({{"min", vec({0.05, 0.09, 0.19})}, {"max", vec({0.07, 0.13, 0.21})}}));
  corner.set("sphere", fd::table({{"centre", vec({0.5, 1, 0.26})}, {"radius", Params::make_number(0.1)}}));
  for (const double edge : {0.25, 0.17})
    for (const bool quadratic : {false, true}) {
      model::ModelInput in;
      in.scene = Params::make_table();
      geometry::TetMesh mesh = geometry::box({1, 2, 0.4}, edge);
      if (quadratic) mesh = geometry::with_midsides(mesh);
      in.bodies.push_back(mortise::testing::soft_body("box", mesh, mortise::testing::material("linear", 1e5, 0.3, 1000)));
      model::Model m(std::move(in));
      const auto loaded = [&](const Params& where, double area, const Vec3& at, double within) {
        const auto e = make(m, {fd::table({{"body", Params::make_text("box")},
                                           {"where", where},
                                           {"traction_factor", Params::make_number(1)},
                                           {"pressure", Params::make_number(2000)}})});
        until(*e, 1);
        const auto g = fd::blocks_of(fd::effect_assemble(*e, fd::shaken(m, 0), true).gradient);
        const auto rest = m.rest.download();
        Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
        for (Index b = 0; b < m.blocks; ++b) force -= g[b], moment -= rest[b].cross(g[b]);
        EXPECT_LT((force - Vec3(0, 0, -2000 * area)).norm(), within * 2000 * area) << edge << quadratic;
        EXPECT_LT((moment - at.cross(Vec3(0, 0, -2000 * area))).norm(), within * 2000 * area) << edge << quadratic;
      };
      loaded(box, 0.44 * 1.67, {0.09, -0.065, 0.2}, 1e-12);
      if (edge == 0.25) loaded(lines, 0.5 * 1.25, {0, 0.125, 0.2}, 1e-12);  // a little wider than lines of the mesh, or less wide
      loaded(ball, std::numbers::pi * (0.25 - 0.09), {0.05, 0.3, 0.2}, 1e-5);
      loaded(spot, 0.02 * 0.04, {0.06, 0.11, 0.2}, 1e-12);
      loaded(corner, std::numbers::pi * (0.01 - 0.0036) / 4, {0.5 - 4 * 0.08 / (3 * std::numbers::pi), 1 - 4 * 0.08 / (3 * std::numbers::pi), 0.2},
             1e-4);
    }
}

TEST(PressureLoad, Derivatives) {
  model::Model m(fd::box_and_ball("linear", 2));
  const auto e = make(m, {pressed("box", "z_max"), pressed("ball", "all"), pressed("box", "all")});
  until(*e, 0.7);
  const fd::Errors errors = fd::effect_errors(*e, fd::shaken(m, 0.1), 1e-2, 2);
  EXPECT_LT(errors.gradient, 1e-6);
  EXPECT_EQ(errors.hessian, 0);
  // both environments carry the same load on the same geometry
  const std::vector<Vec3> rest = m.rest.download();
  std::vector<Vec3> q = rest;
  for (Vec3& x : q) x += Vec3(0, 0, 0.1);
  const std::vector<double> energy = fd::effect_energies(*e, fd::flatten(q), 2);
  EXPECT_NEAR(energy[0], energy[1], 1e-9);
  EXPECT_GT(energy[0], 1);
}

TEST(PressureLoad, ErrorsNameTheScenePlace) {
  model::Model m(fd::box_and_ball());
  const auto message = [&](const Params& p) -> std::string {
    try {
      make(m, {p});
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), Exit::scene);
      return e.what();
    }
    return "no error";
  };
  EXPECT_THAT(message(pressed("cube", "all")), ::testing::HasSubstr("no soft or stiff body is named 'cube'"));
  EXPECT_THAT(message(pressed("ball", "z_max")), ::testing::HasSubstr("selects no whole surface triangle of body 'ball'"));
  const auto nowhere = [&](const Vec3& min, const Vec3& max) {
    Params where = Params::make_table(), p = pressed("box", "z_max");
    where.set("box", fd::table({{"min", vec(min)}, {"max", vec(max)}}));
    p.set("where", where);
    return message(p);
  };
  EXPECT_THAT(nowhere({0, 0, 3}, {1, 1, 2}),
              ::testing::HasSubstr("no part of the surface of body 'box': 'min' of its box lies above 'max' along z (3 > 2)"));
  EXPECT_THAT(nowhere({0, 0, 30}, {1, 1, 40}),
              ::testing::AllOf(::testing::HasSubstr("at rest the body lies in x = "), ::testing::HasSubstr("m beside what is asked for")));
  EXPECT_THAT(message(load("box", "z_max")), ::testing::HasSubstr("needs 'pressure' or 'traction'"));
}
