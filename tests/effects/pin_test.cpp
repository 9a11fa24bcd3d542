#include "effects/pin/pin.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "effects/failure.h"
#include "problem.h"

using namespace mortise;
using namespace mortise::effects;
using mortise::testing::vec;
using mortise::testing::where_side;

namespace {

Params pinned(const std::string& body, const Params& where, const std::string& axes = "xyz") {
  Params p = Params::make_table(SourceLoc{"scene.yaml", 7, 5});
  p.set("body", Params::make_text(body, SourceLoc{"scene.yaml", 7, 12}));
  p.set("where", where);
  p.set("axes", Params::make_text(axes));
  return p;
}
// Moves sideways as well, which entries that hold only z must not pass on.
Params lifted(Params p, const std::vector<double>& time, const std::vector<double>& z) {
  Params keys = Params::make_list();
  for (double v : z) keys.push(vec({2 * v, -v, v}));
  p.set("motion", fd::table({{"time", fd::numbers(time)}, {"interpolation", Params::make_text("linear")}, {"translation", keys}}));
  return p;
}
std::unique_ptr<fd::Subject> make(model::Model& m, std::vector<Params> pins) { return fd::make_effect("pin", Params::make_list(std::move(pins)), m); }

void at(fd::Subject& e, double t0, double dt) {
  StepInfo s;
  s.t0 = t0, s.dt = dt;
  e.begin_step(s);
}

std::string message(const std::function<void()>& f) {
  try {
    f();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), Exit::scene);
    return e.what();
  }
  return "no error";
}

}  // namespace

TEST(Pin, HoldsTheChosenNodesAndNothingElse) {
  model::Model m(fd::box_and_ball());
  const auto e = make(m, {pinned("box", where_side("z_min"), "xz")});
  const auto projector = m.projector.download();
  const auto rest = m.rest.download(), target = m.target.download();
  int held = 0;
  for (Index b = 0; b < m.blocks; ++b) {
    const bool low = b < m.bodies[0].block_end && rest[b][2] < -0.999;
    held += low;
    EXPECT_EQ(projector[b], low ? Mat3(Vec3(0, 1, 0).asDiagonal()) : Mat3(Mat3::Identity()));
    EXPECT_EQ(m.held[b], low ? 1 : 0);
    EXPECT_EQ(target[b], rest[b]);
  }
  EXPECT_EQ(held, 4);
  EXPECT_EQ(fd::effect_energy(*e, fd::shaken(m, 0.1)), 0);
  EXPECT_EQ(fd::effect_assemble(*e, fd::shaken(m, 0.1), true).gradient.norm(), 0);
}

TEST(Pin, TargetsFollowTheKeysAtTheEndOfTheStep) {
  model::Model m(fd::box_and_ball());
  const auto e = make(m, {lifted(pinned("box", where_side("z_max"), "z"), {0, 1, 3}, {0, 0.2, -0.2})});
  const auto rest = m.rest.download();
  Index top = 0;
  while (rest[top][2] < 0.999) ++top;
  at(*e, 0.25, 0.25);
  EXPECT_NEAR(m.target.download()[top][2], rest[top][2] + 0.1, 1e-15);
  at(*e, 1.5, 0.5);
  EXPECT_NEAR(m.target.download()[top][2], rest[top][2], 1e-15);
  at(*e, 0, 0.25);  // the same step, tried again from an earlier time
  EXPECT_NEAR(m.target.download()[top][2], rest[top][2] + 0.05, 1e-15);
  EXPECT_EQ(m.target.download()[top][0], rest[top][0]);
}

TEST(Pin, StiffBodyTurnsAboutAnAxisAndMoves) {
  model::Model m(fd::box_and_ball());
  Params p = pinned("ball", where_side("all"));
  const Vec3 c(1, 0, 0), u(0, 0, 0.5);
  p.set("motion",
        fd::table(
            {{"time", fd::numbers({0, 1})},
             {"interpolation", Params::make_text("linear")},
             {"translation", Params::make_list({vec(Vec3::Zero()), vec(u)})},
             {"rotation", Params::make_list({fd::table({{"axis", vec({0, 0, 2})}, {"centre", vec(c)}, {"angle", fd::numbers({0, M_PI / 2})}})})}}));
  const auto e = make(m, {p});
  const Index b = m.bodies[1].block_begin;
  for (Index k = 0; k < 4; ++k) {
    EXPECT_EQ(m.held[b + k], 2);
    EXPECT_EQ(m.projector.download()[b + k], Mat3::Zero());
  }
  at(*e, 0.95, 0.05);
  const auto target = m.target.download();
  const Vec3 r = m.bodies[1].centre - c;
  EXPECT_LT((target[b] - (c + u + Vec3(-r[1], r[0], r[2]))).norm(), 1e-14);
  EXPECT_LT((target[b + 1] - Vec3(0, 1, 0)).norm(), 1e-15);
  EXPECT_LT((target[b + 2] - Vec3(-1, 0, 0)).norm(), 1e-15);
  EXPECT_LT((target[b + 3] - Vec3(0, 0, 1)).norm(), 1e-15);
  // exactly a rotation half-way, too: no stiff energy comes from the support
  at(*e, 0.25, 0.05);
  const auto half = m.target.download();
  EXPECT_NEAR(half[b + 1].dot(half[b + 2]), 0, 1e-15);
  EXPECT_NEAR(half[b + 1].norm(), 1, 1e-15);
}

// A quarter about z and then one about x, each about its own point; between keys at rest at both ends, faster in the middle.
// Where the prescribed way is not straight, what lies beside the chord would not be met: the step is too long.
TEST(Pin, StepsFollowThePrescribedWay) {
  model::Model m(fd::box_and_ball());
  Params turn = pinned("ball", where_side("all"));
  turn.set("motion",
           fd::table({{"time", fd::numbers({0, 1})},
                      {"interpolation", Params::make_text("linear")},
                      {"rotation", Params::make_list({fd::table(
                                       {{"axis", vec({0, 0, 1})}, {"centre", vec(m.bodies[1].centre)}, {"angle", fd::numbers({0, M_PI / 2})}})})}}));
  const auto e = make(m, {turn});
  EXPECT_NO_THROW(at(*e, 0, 0.05));
  EXPECT_THROW(at(*e, 0, 0.2), Failure);
  // There and back: the keys belong to the ends of steps.
  model::Model n(fd::box_and_ball());
  const auto back = make(n, {lifted(pinned("box", where_side("z_max")), {0, 1, 2}, {0, 0.2, 0})});
  EXPECT_NO_THROW(at(*back, 0, 1));
  EXPECT_NO_THROW(at(*back, 1, 1));
  EXPECT_THROW(at(*back, 0.5, 1), Failure);
}

TEST(Pin, TurnsOneAfterTheOtherAndSmoothly) {
  model::Model m(fd::box_and_ball());
  Params p = pinned("ball", where_side("all"));
  const auto turn = [](const Vec3& axis, const Vec3& centre) {
    return fd::table({{"axis", vec(axis)}, {"centre", vec(centre)}, {"angle", fd::numbers({0, M_PI / 2, M_PI / 2})}});
  };
  const Vec3 c(1, 0, 0), d(0, 2, 0);
  p.set("motion", fd::table({{"time", fd::numbers({0, 1, 3})},
                             {"interpolation", Params::make_text("smooth")},
                             {"rotation", Params::make_list({turn({0, 0, 1}, c), turn({1, 0, 0}, d)})}}));
  const auto e = make(m, {p});
  const Index b = m.bodies[1].block_begin;
  at(*e, 1.5, 0.5);  // both turns done, and held
  const Vec3 r = m.bodies[1].centre - c, once = c + Vec3(-r[1], r[0], r[2]), s = once - d;
  EXPECT_LT((m.target.download()[b] - (d + Vec3(s[0], -s[2], s[1]))).norm(), 1e-14);
  EXPECT_LT((m.target.download()[b + 1] - Vec3(0, 0, 1)).norm(), 1e-15);  // x -> y -> z
  const auto turned = [&](double t) {
    at(*e, t, 0);
    return std::acos(std::clamp(m.target.download()[b + 3].dot(Vec3(0, 0, 1)), -1., 1.));  // z turns about x only
  };
  EXPECT_NEAR(turned(0.5), M_PI / 4, 1e-12);
  EXPECT_LT(turned(0.01), 3.01e-4 * M_PI / 2);  // 3 t^2 instead of t
  EXPECT_NEAR(turned(0.99), M_PI / 2, 4e-4 * M_PI);
  EXPECT_LE(turned(2), M_PI / 2 + 1e-12);  // no overshoot
}

TEST(Pin, ReleaseFreesFromThatTimeOn) {
  model::Model m(fd::box_and_ball());
  Params p = pinned("box", where_side("z_min"));
  p.set("release", Params::make_number(0.3));
  const auto e = make(m, {p, pinned("box", where_side("z_max"), "y")});
  const auto rest = m.rest.download();
  Index low = 0, top = 0;
  while (rest[low][2] > -0.999) ++low;
  while (rest[top][2] < 0.999) ++top;
  at(*e, 0.1 + 0.1, 0.1);
  EXPECT_EQ(m.held[low], 2);
  at(*e, std::nextafter(0.3, 0), 0.1);  // times are sums of steps
  EXPECT_EQ(m.held[low], 0);
  EXPECT_EQ(m.projector.download()[low], Mat3::Identity());
  EXPECT_EQ(m.held[top], 1);
  at(*e, 0.2, 0.1);  // a run that went back holds again
  EXPECT_EQ(m.held[low], 2);
}

TEST(Pin, PinsOfDifferentAxesOfOneNodeCombine) {
  model::Model m(fd::box_and_ball());
  const auto e = make(m, {pinned("box", where_side("z_min"), "xy"), lifted(pinned("box", where_side("all"), "z"), {0, 1}, {0, 0.1}),
                          pinned("box", where_side("x_min"), "x")});
  const auto rest = m.rest.download();
  Index corner = 0;
  while (rest[corner][2] > -0.999 || rest[corner][0] > -0.499) ++corner;
  at(*e, 0.5, 0.5);
  EXPECT_EQ(m.held[corner], 2);
  EXPECT_LT((m.target.download()[corner] - rest[corner] - Vec3(0, 0, 0.1)).norm(), 1e-15);
}

TEST(Pin, ErrorsNameTheScenePlace) {
  model::Model m(fd::box_and_ball());
  EXPECT_THAT(message([&] { make(m, {pinned("cube", where_side("all"))}); }),
              ::testing::HasSubstr("scene.yaml:7:12: error: no soft or stiff body is named 'cube'"));
  Params empty = Params::make_table(SourceLoc{"scene.yaml", 8, 3});
  empty.set("sphere", fd::table({{"centre", vec({9, 9, 9})}, {"radius", Params::make_number(0.1)}}));
  EXPECT_THAT(message([&] { make(m, {pinned("box", empty)}); }), ::testing::HasSubstr("scene.yaml:8:3: error: selects no node of body 'box'"));
  EXPECT_THAT(message([&] {
                make(m, {pinned("box", where_side("z_min")), lifted(pinned("box", where_side("x_min"), "z"), {0, 1}, {0, 1})});
              }),
              ::testing::HasSubstr("moves points of body 'box' along z that the pin at scene.yaml:7:5 holds too"));
  EXPECT_THAT(message([&] { make(m, {pinned("ball", where_side("z_min"))}); }), ::testing::HasSubstr("can only be held as a whole"));
  EXPECT_THAT(message([&] { make(m, {pinned("box", where_side("all"), "xx")}); }), ::testing::HasSubstr("each at most once"));
  EXPECT_THAT(message([&] {
                make(m, {lifted(pinned("box", where_side("all")), {0, 1}, {0})});
              }),
              ::testing::HasSubstr("has 1 keys where 'time' has 2"));
  EXPECT_THAT(message([&] { make(m, {lifted(pinned("box", where_side("all")), {0, 0}, {0, 0})}); }), ::testing::HasSubstr("must ascend"));
}
