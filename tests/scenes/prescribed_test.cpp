// Bodies that go where supports say are obstacles like all others.
#include <gmock/gmock.h>

#include "scenes/rig.h"

using mortise::Error;
using mortise::Exit;
using mortise::testing::Rig;
using ::testing::HasSubstr;

namespace {

// A held cube of 20 mm at the origin (or a floor 10 mm below it), and one that comes from 25 mm above it; a crumb that falls beside them.
std::string scene(const std::string& mover, const std::string& obstacle, const std::string& pins, const std::string& more = "",
                  const std::string& time = "step: 5 ms, steps: 30") {
  return "mortise: 1\ntime: {" + time + R"(}
materials: {gel: {youngs_modulus: 0.1 MPa, poisson_ratio: 0.4, density: 1050}}
bodies:
  obstacle: )" +
         obstacle + R"(
  mover: {type: )" +
         mover + R"(, shape: {box: {size: [20 mm, 20 mm, 20 mm], edge_length: 20 mm}}, material: gel, position: [0, 0, 25 mm]}
  crumb: {type: soft, shape: {box: {size: [5 mm, 5 mm, 5 mm], edge_length: 5 mm}}, material: gel, position: [30 mm, 0, 25 mm]}
effects:
  elasticity: {}
  affine_body: {stiffness: 1 MPa}
  pin: [)" +
         pins + "]\n" + more;
}
const std::string kCube = "{type: stiff, shape: {box: {size: [20 mm, 20 mm, 20 mm], edge_length: 20 mm}}, material: gel}";
const std::string kSoftCube = "{type: soft, shape: {box: {size: [20 mm, 20 mm, 20 mm], edge_length: 20 mm}}, material: gel}";
const std::string kFloor = "{type: half_space, point: [0, 0, 10 mm]}";
const std::string kHold = "{body: obstacle, where: {side: all}}, ";
const std::string kDown = "{body: mover, where: {side: all}, motion: {time: [0, 0.1], translation: [[0, 0, 0], [0, 0, -30 mm]]}}";
const std::string kContact = "  inertia: {}\n  barrier_contact: {d_hat: 0.1 mm, stiffness: 0.1 MPa}\n";

// Steps until one fails; the message, "" if none did.
std::string failure(const std::string& yaml, int steps, int* done = nullptr) {
  Rig rig(yaml);
  for (int i = 0; i < steps; ++i) {
    if (done) *done = i;
    try {
      rig.step();
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), Exit::solve);
      return e.what();
    }
  }
  return "";
}

TEST(Prescribed, MeetsWhatIsHeldOrStill) {
  for (const std::string mover : {"stiff", "soft"})
    for (const auto& [obstacle, pins] : {std::pair{kCube, kHold}, {kSoftCube, kHold}, {kFloor, std::string()}}) {
      int done = 0;
      const std::string what = failure(scene(mover, obstacle, pins + kDown, kContact), 10, &done);  // 5 mm at 0.3 m/s: 16.7 ms
      EXPECT_EQ(done, 3) << what;
      EXPECT_THAT(what, HasSubstr("'obstacle'"));
      EXPECT_THAT(what, HasSubstr("'mover'"));
      EXPECT_THAT(what, HasSubstr("t = 0.01666"));
      EXPECT_THAT(what, HasSubstr("0.01) m"));  // the place: 10 mm up
    }
}

TEST(Prescribed, MeetsWithinOneStep) {
  const std::string through = "{body: mover, where: {side: all}, motion: {time: [0, 0.004], translation: [[0, 0, 0], [0, 0, -80 mm]]}}";
  for (const std::string& obstacle : {kCube, kSoftCube})
    EXPECT_THAT(failure(scene("stiff", obstacle, kHold + through, kContact), 1), HasSubstr("meets"));
}

TEST(Prescribed, MeetsWithMortarContactThoughNoPairNamesIt) {
  const std::string mortar = "  inertia: {}\n  mortar_contact: {pairs: [{slave: crumb, master: obstacle}]}\n";
  EXPECT_THAT(failure(scene("stiff", kCube, kHold + kDown, mortar), 10), HasSubstr("'mover'"));
}

TEST(Prescribed, MeetsInStaticsAndPartOfABodyCounts) {
  const std::string down =
      "{body: mover, where: {side: z_max}, motion: {time: [0, 1], translation: [[0, 0, 0], [0, 0, -30 mm]]}}, {body: crumb, where: {side: z_min}}";
  const std::string what =
      failure(scene("soft", kFloor, down, "  barrier_contact: {d_hat: 0.1 mm, stiffness: 0.1 MPa}\n", "mode: static, steps: 5"), 5);
  EXPECT_NE(what, "");  // its upper side is driven through the floor; the part below cannot give way for ever
  const std::string all =
      "{body: mover, where: {side: all}, motion: {time: [0, 1], translation: [[0, 0, 0], [0, 0, -30 mm]]}}, {body: crumb, where: {side: z_min}}";
  EXPECT_THAT(failure(scene("soft", kFloor, all, "  barrier_contact: {d_hat: 0.1 mm, stiffness: 0.1 MPa}\n", "mode: static, steps: 5"), 5),
              HasSubstr("pseudo-time 0.1666"));
}

TEST(Prescribed, MayPassWhereTheSceneSaysSo) {
  EXPECT_EQ(failure("pairs: [{bodies: [mover, obstacle], collide: false}]\n" + scene("stiff", kCube, kHold + kDown, kContact), 25), "");
  EXPECT_EQ(failure("pairs: [{bodies: [obstacle, mover], collide: false}]\n" + scene("soft", kFloor, kDown, kContact), 25), "");
  EXPECT_NE(failure("pairs: [{bodies: [crumb, mover], collide: false}]\n" + scene("stiff", kCube, kHold + kDown, kContact), 25), "");
}

// Bodies on one carriage may touch, as parts of one tool do; so may two that never move.
TEST(Prescribed, MovesAsOne) {
  const std::string together =
      "{body: obstacle, where: {side: all}, motion: {time: [0, 0.1], translation: [[0, 0, 5 mm], [0, 0, -25 mm]]}}, "
      "{body: mover, where: {side: all}, motion: {time: [0, 0.1], translation: [[0, 0, 5 mm], [0, 0, -25 mm]]}}";
  EXPECT_EQ(
      failure(scene("stiff", "{type: stiff, shape: {box: {size: [20 mm, 20 mm, 20 mm], edge_length: 20 mm}}, material: gel, position: [0, 0, 10 mm]}",
                    together, kContact),
              5),
      "");
  EXPECT_EQ(
      failure(scene("stiff", "{type: stiff, shape: {box: {size: [20 mm, 20 mm, 20 mm], edge_length: 20 mm}}, material: gel, position: [0, 0, 10 mm]}",
                    kHold + "{body: mover, where: {side: all}}", kContact),
              5),
      "");
}

// What is released later has been an obstacle all the time, and lands on what is still held.
TEST(Prescribed, LandsOnWhatIsHeldOnceItIsReleased) {
  Rig rig(scene("stiff", kCube, kHold + "{body: mover, where: {side: all}, release: 10 ms}", kContact + "  gravity: {}\n", "step: 5 ms, steps: 30"));
  rig.steps(30);  // free fall would end 88 mm lower
  const auto u = rig.fields().point["displacement"];
  const double fallen = u[3 * 8 + 2];  // of the mover's first vertex
  EXPECT_LT(fallen, -4e-3);
  EXPECT_GT(fallen, -5.01e-3);
}

// The step in which it begins to move is of first order for an eighth: by BDF2 alone it falls 14 % short.
TEST(Prescribed, WhatIsReleasedFallsFromThere) {
  Rig rig(R"(
mortise: 1
name: drop
time: {step: 5 ms, steps: 15}
bodies:
  cube: {type: stiff, shape: {box: {size: [20 mm, 20 mm, 20 mm], edge_length: 20 mm}}, mass: 0.1 kg}
effects:
  inertia: {integrator: bdf2}
  gravity: {}
  affine_body: {}
  pin: [{body: cube, where: {side: all}, release: 50 ms}]
)");
  rig.steps(10);
  rig.resume();
  EXPECT_EQ(rig.step().substeps, 4);
  EXPECT_EQ(rig.step().substeps, 1);
  rig.steps(3);
  const double fallen = -rig.fields().point["displacement"][2], due = 0.5 * 9.81 * 0.025 * 0.025;
  EXPECT_NEAR(fallen, due, 2e-3 * due);
}

}  // namespace
