// URDF files as they come: what is read, merged, placed, mended, refused.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "base/read_file.h"
#include "geometry/io/obj.h"
#include "geometry/primitives.h"
#include "geometry/topology.h"
#include "importers/import.h"
#include "importers/robot/gait.h"
#include "importers/robot/machine.h"
#include "importers/robot/meshes.h"
#include "importers/robot/passing.h"
#include "importers/robot/solid.h"
#include "importers/robot/weigh.h"
#include "importers/robot/write.h"

namespace mortise::importers {
namespace {

std::string link(const std::string& name, const std::string& more = "") { return "<link name='" + name + "'>" + more + "</link>\n"; }
std::string text(double x) {
  char out[40];
  std::snprintf(out, sizeof out, "%.9g", x);
  return out;
}
std::string inertial(double mass, const std::string& xyz, double i) {
  const std::string I = text(i);
  return "<inertial><origin xyz='" + xyz + "'/><mass value='" + text(mass) + "'/><inertia ixx='" + I + "' iyy='" + I + "' izz='" + I +
         "'/></inertial>";
}
const std::string kBall = "<collision><geometry><sphere radius='0.05'/></geometry></collision>";
std::string joint(const std::string& name, const std::string& type, const std::string& parent, const std::string& child, const std::string& more) {
  return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent + "'/><child link='" + child + "'/>" + more + "</joint>\n";
}
Robot robot(const std::string& inside, Notes* notes = nullptr) {
  Notes own;
  return read_robot_text("<robot name='r'>\n" + inside + "</robot>", "r.urdf", notes ? *notes : own);
}
std::string refusal(const std::string& inside, const MachineOptions& options = {}) {
  try {
    Notes notes;
    assemble(robot(inside), options, notes);
  } catch (const Error& e) {
    return e.what();
  }
  return "nothing";
}
Machine machine(const std::string& inside, const MachineOptions& options = {}, Notes* notes = nullptr) {
  Notes own;
  Notes& n = notes ? *notes : own;
  return assemble(robot(inside, &n), options, n);
}
bool told(const Notes& notes, const std::string& what) {
  for (const std::string& line : notes.lines())
    if (line.find(what) != std::string::npos) return true;
  return false;
}

TEST(Urdf, OriginsTurnAboutFixedAxes) {
  const Robot r = robot(link("a") + link("b") + joint("j", "fixed", "a", "b", "<origin xyz='1 2 3' rpy='0.1 -0.2 0.3'/>"));
  const Pose& p = r.joints[0].origin;
  const double cr = std::cos(0.1), sr = std::sin(0.1), cp = std::cos(-0.2), sp = std::sin(-0.2), cy = std::cos(0.3), sy = std::sin(0.3);
  Mat3 R;  // Rz(yaw) Ry(pitch) Rx(roll)
  R << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr, sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr, -sp, cp * sr, cp * cr;
  EXPECT_LT((p.R - R).norm(), 1e-15);
  EXPECT_EQ(p.t, Vec3(1, 2, 3));
}

// Two balls of a dumbbell and the rod between them as three links.
TEST(Urdf, FixedLinksAreOneBodyWithTheInertiaOfAll) {
  const Machine m = machine(link("rod", kBall + inertial(2, "0 0 0", 0.01)) + link("left", kBall + inertial(1, "0 0 0.1", 0.002)) +
                            link("right", kBall + inertial(3, "0 0 0", 0.003)) +
                            joint("l", "fixed", "rod", "left", "<origin xyz='-0.5 0 0' rpy='0 1.5707963267948966 0'/>") +
                            joint("r", "fixed", "rod", "right", "<origin xyz='0.5 0 0'/>"));
  ASSERT_EQ(m.bodies.size(), 1u);
  const Body& b = m.bodies[0];
  EXPECT_EQ(b.links, (std::vector<std::string>{"rod", "left", "right"}));
  EXPECT_EQ(b.shapes.size(), 3u);
  EXPECT_NEAR(b.inertial.mass, 6, 1e-15);
  const double left = -0.5 + 0.1, centre = (left + 3 * 0.5) / 6;
  EXPECT_LT((b.inertial.centre - Vec3(centre, 0, 0)).norm(), 1e-15);
  const double across = 0.015 + 2 * centre * centre + (left - centre) * (left - centre) + 3 * (0.5 - centre) * (0.5 - centre);
  EXPECT_LT((b.inertial.tensor - Vec3(0.015, across, across).asDiagonal().toDenseMatrix()).norm(), 1e-14);
  EXPECT_NEAR(b.at.t[2], 0.05 + 2e-3, 1e-15) << "clear of the floor";
}

// A planar arm of two links of 1 m and 0.5 m.
std::string arm(const std::string& limits = "lower='-2' upper='2' effort='5' velocity='3'") {
  return link("base", kBall + inertial(1, "0 0 0", 0.1)) + link("upper", kBall + inertial(1, "0 0 0", 0.1)) +
         link("Lower", kBall + inertial(1, "0 0 0", 0.1)) + joint("shoulder", "continuous", "base", "upper", "<axis xyz='0 2 0'/>") +
         joint("elbow", "revolute", "upper", "Lower", "<origin xyz='1 0 0'/><axis xyz='0 1 0'/><limit " + limits + "/>");
}

TEST(Urdf, JointsStandWhereTheyAreAskedTo) {
  MachineOptions o;
  o.stands = {{"*", 9}, {"shoulder", -0.6}, {"elb?w", 0.9}};
  const Machine m = machine(arm(), o);
  ASSERT_EQ(m.axes.size(), 2u);
  const Axis& elbow = m.axes[1];
  EXPECT_EQ(m.bodies[elbow.body].name, "lower");
  EXPECT_EQ(elbow.to, 1);
  const Vec3 base = m.bodies[0].at.t;
  EXPECT_LT((elbow.place - base - Vec3(std::cos(0.6), 0, std::sin(0.6))).norm(), 1e-14);
  EXPECT_LT((elbow.direction - Vec3(0, 1, 0)).norm(), 1e-15);
  EXPECT_LT((m.bodies[2].at.R - Eigen::AngleAxisd(0.3, Vec3::UnitY()).toRotationMatrix()).norm(), 1e-14);
  EXPECT_EQ(elbow.stands, 0.9);
  EXPECT_EQ(elbow.effort, 5);
}

TEST(Urdf, AJointThatMayNotBeAtZeroStandsInsideItsLimits) {
  const Machine m = machine(arm("lower='-2.7' upper='-0.8'"));
  EXPECT_LT(m.axes[1].stands, -0.8 - 0.017);
  EXPECT_GT(m.axes[1].stands, -0.9);
  EXPECT_NEAR(m.axes[0].stands, -0.5 * m.axes[1].stands, 1e-15) << "the parallel hinge before it takes half of the bend back";
  MachineOptions o;
  o.stands = {{"shoulder", 0.1}};
  EXPECT_EQ(machine(arm("lower='-2.7' upper='-0.8'"), o).axes[0].stands, 0.1);
}

TEST(Urdf, NeighboursAndWhatOverlapsPassThroughEachOther) {
  std::string chain = link("a0", kBall + inertial(1, "0 0 0", 0.1));
  for (int i = 1; i < 5; ++i) {
    const std::string me = "a" + std::to_string(i), before = "a" + std::to_string(i - 1);
    const std::string back = i == 4 ? "-0.45" : "0.2";  // the last link lies in the second
    chain += link(me, kBall + inertial(1, "0 0 0", 0.1)) + joint("j" + me, "continuous", before, me, "<origin xyz='" + back + " 0 0'/>");
  }
  const auto pairs = passing_pairs(machine(chain), 2);
  ASSERT_EQ(pairs.size(), 4u);
  for (const PassingPair& p : pairs) EXPECT_EQ(p.why == PassingPair::Why::overlap, p.b - p.a != 2) << p.a << " " << p.b;
  EXPECT_TRUE(
      std::any_of(pairs.begin(), pairs.end(), [](const PassingPair& p) { return p.a == 1 && p.b == 4 && p.why == PassingPair::Why::overlap; }));
  EXPECT_EQ(passing_pairs(machine(chain), 1).size(), 1u);
}

TEST(Urdf, MeshesThatNestMeet) {
  const geometry::TriMesh outer = geometry::surface_of(geometry::sphere(1, 0.4)), inner = geometry::surface_of(geometry::sphere(0.2, 0.1));
  EXPECT_TRUE(meet(outer, inner, 1e-3));
  EXPECT_TRUE(meet(inner, outer, 1e-3));
  geometry::TriMesh away = inner;
  for (Vec3& x : away.points) x[0] += 1.25;
  EXPECT_FALSE(meet(outer, away, 1e-3));
  EXPECT_TRUE(meet(outer, away, 0.1));
}

TEST(Urdf, WhatHasNoMassOrImpossibleMomentsGetsSome) {
  Notes notes;
  const Machine m = machine(link("a", kBall) + link("b", kBall + inertial(1e-6, "0 0 0", 1e-9)) + link("c") +
                                link("d", kBall + "<inertial><mass value='2'/><inertia ixx='1' iyy='1' izz='3'/></inertial>") +
                                link("e", kBall + "<inertial><mass value='2'/><inertia ixx='0' iyy='0' izz='0'/></inertial>") +
                                joint("1", "continuous", "a", "b", "") + joint("2", "continuous", "b", "c", "<origin xyz='0.3 0 0'/>") +
                                joint("3", "continuous", "c", "d", "") + joint("4", "continuous", "d", "e", ""),
                            {}, &notes);
  EXPECT_NEAR(m.bodies[0].inertial.mass, 1000 * 4 / 3.0 * M_PI * 0.05 * 0.05 * 0.05, 1e-12);
  EXPECT_TRUE(m.bodies[0].even);
  EXPECT_EQ(m.bodies[1].inertial.mass, 1e-3);
  EXPECT_NEAR(m.bodies[1].inertial.tensor(0, 0), 1e-6, 1e-18);
  ASSERT_EQ(m.bodies[2].shapes.size(), 1u);
  const Mat3 I = m.bodies[3].inertial.tensor;
  EXPECT_GT(I(0, 0) + I(1, 1) - I(2, 2), 1e-4);
  EXPECT_NEAR(I(2, 2), 3, 0.01);
  EXPECT_TRUE(m.bodies[4].even);
  for (const char* what : {"has no mass", "below 1 g", "ball of 10 mm", "are mended", "moments of inertia of zero"})
    EXPECT_TRUE(told(notes, what)) << what;
}

TEST(Urdf, ARootCalledWorldHoldsWhatIsFixedToIt) {
  const Machine m =
      machine(link("world") + link("stand", kBall) + link("arm", kBall + inertial(1, "0 0 0", 0.1)) +
              link("cart", kBall + inertial(1, "0 0 0", 0.1)) + joint("f", "fixed", "world", "stand", "<origin xyz='0 0 1'/>") +
              joint("t", "continuous", "stand", "arm", "") + joint("rail", "prismatic", "world", "cart", "<limit lower='-1' upper='1'/>"));
  ASSERT_EQ(m.bodies.size(), 3u);
  EXPECT_TRUE(m.bodies[0].held);
  EXPECT_FALSE(m.bodies[1].held);
  ASSERT_EQ(m.axes[0].name, "rail");
  EXPECT_EQ(m.axes[1].to, 0);
  EXPECT_EQ(m.axes[0].to, -1);
}

// It stays where its file has it, over the floor or through the scene's z = 0, and the floor is below; others stand on the floor.
TEST(Urdf, WhatIsFixedToTheWorldStaysAtItsHeight) {
  const auto at = [](double z, const std::string& root, Notes* notes = nullptr) {
    return machine(link(root) + link("stand", kBall) + link("arm", kBall + inertial(1, "0 0 0", 0.1)) +
                       joint("f", "fixed", root, "stand", "<origin xyz='0 0 " + text(z) + "'/>") +
                       joint("t", "continuous", "stand", "arm", "<origin xyz='0 0 -0.2'/>"),
                   {}, notes);
  };
  Notes notes;
  const Machine high = at(1, "world", &notes);
  EXPECT_EQ(high.bodies[0].at.t[2], 1);
  EXPECT_EQ(high.floor, 0);
  EXPECT_FALSE(told(notes, "the floor lies below it"));
  const Machine low = at(0.1, "world", &notes);
  EXPECT_EQ(low.bodies[0].at.t[2], 0.1);
  EXPECT_NEAR(low.floor, 0.1 - 0.2 - 0.05 - 2e-3, 1e-12);
  EXPECT_TRUE(told(notes, "r.urdf:2:1: warning: what the file ties to the world stays at its height: the floor lies below it"));
  EXPECT_NE(write_scene(low, {}, "r.yaml", "").find("floor: {type: half_space, point: [0, 0, -0.152]}"), std::string::npos);
  const Machine free = at(1, "base");
  EXPECT_NEAR(free.axes[0].place[2], 0.05 + 2e-3, 1e-12);
}

TEST(Urdf, JointsMimicExactly) {
  const std::string limits = "<limit lower='0' upper='0.04'/>";
  Notes notes;
  const Machine m = machine(
      link("hand", kBall + inertial(1, "0 0 0", 0.1)) + link("l", kBall + inertial(1, "0 0 0", 0.1)) + link("r", kBall + inertial(1, "0 0 0", 0.1)) +
          link("k", kBall + inertial(1, "0 0 0", 0.1)) + joint("left", "prismatic", "hand", "l", "<axis xyz='0 1 0'/>" + limits) +
          joint("right", "prismatic", "hand", "r", "<axis xyz='0 -1 0'/><mimic joint='left'/>" + limits) +
          joint("knuckle", "revolute", "hand", "k", "<mimic joint='left' multiplier='10' offset='0.3'/><limit lower='-1' upper='1'/>"),
      {{{"left", 0.02}}, {}, true, 2e-3, 0, 2, {}}, &notes);
  EXPECT_EQ(m.axes[1].mimics, 0);
  EXPECT_EQ(m.axes[1].stands, 0.02);
  EXPECT_LT((m.bodies[2].at.t - m.bodies[0].at.t - Vec3(0, -0.02, 0)).norm(), 1e-15);
  EXPECT_EQ(m.axes[2].mimics, 0);
  EXPECT_EQ(m.axes[2].ratio, 10);
  EXPECT_NEAR(m.axes[2].stands, 0.5, 1e-15);
  EXPECT_FALSE(m.axes[1].limits) << "the leader's are as narrow";
  EXPECT_FALSE(m.axes[2].limits) << "0.3 to 0.7 is all there is";
  const std::string text = write_scene(m, {}, "r.yaml", "");
  EXPECT_NE(text.find("mimic: {joint: left, ratio: 10}"), std::string::npos) << text;
  EXPECT_EQ(text.find("joint: knuckle, mode"), std::string::npos) << "it has no motor";
}

// Links without shapes (or with meshes that are not there) show the robot's skeleton.
// Of a calf whose mesh is missing and a foot that has one: what touches stands for what is not seen.
TEST(Urdf, ABodyThatMissesAMeshIsDrawnWhole) {
  const std::string seen = "<visual><geometry><box size='0.1 0.1 0.1'/></geometry></visual>", i = inertial(1, "0 0 0", 0.1);
  Robot r = robot(link("calf", kBall + i) + link("foot", kBall + seen + i) + joint("j", "fixed", "calf", "foot", "<origin xyz='0 0 -0.2'/>"));
  EXPECT_EQ(assemble(r, {}, *std::make_unique<Notes>()).bodies[0].visuals.size(), 1u) << "nothing is missing";
  r.links[0].undrawn = true;
  const Machine m = assemble(r, {}, *std::make_unique<Notes>());
  ASSERT_EQ(m.bodies[0].visuals.size(), 2u);
  EXPECT_EQ(m.bodies[0].visuals[1].kind, Shape::Kind::sphere);
  EXPECT_LT(m.bodies[0].visuals[1].at.t.norm(), 1e-15) << "the calf's, not the foot's";
}

TEST(Urdf, LinksWithoutShapesAreBars) {
  Notes notes;
  const std::string i = inertial(1, "0 0 0", 0.1);
  const Machine m =
      machine(link("a", i) + link("b", i) + link("c", i) + joint("j", "revolute", "a", "b", "<origin xyz='0 0 0.5'/><limit lower='-1' upper='1'/>") +
                  joint("k", "revolute", "b", "c", "<origin xyz='0.2 0 0'/><limit lower='-1' upper='1'/>"),
              {}, &notes);
  ASSERT_EQ(m.bodies[0].shapes.size(), 1u);
  EXPECT_EQ(m.bodies[0].shapes[0].kind, Shape::Kind::cylinder);
  EXPECT_EQ(m.bodies[0].shapes[0].length, 0.5);
  EXPECT_LT((m.bodies[1].shapes[0].at.R * Vec3::UnitZ() - Vec3::UnitX()).norm(), 1e-12);
  EXPECT_LT((m.bodies[1].shapes[0].at.t - Vec3(0.1, 0, 0)).norm(), 1e-12);
  EXPECT_EQ(m.bodies[2].shapes[0].kind, Shape::Kind::sphere) << "nothing hangs on it";
  EXPECT_TRUE(told(notes, "bars to the joints"));
}

TEST(Urdf, MimicryInACircleIsRefused) {
  const std::string l = "<limit lower='-1' upper='1'/>";
  EXPECT_THAT(
      [&] {
        machine(link("a", kBall) + link("b", kBall) + link("c", kBall) + joint("j", "revolute", "a", "b", "<mimic joint='k'/>" + l) +
                joint("k", "revolute", "b", "c", "<mimic joint='j'/>" + l));
      },
      testing::ThrowsMessage<Error>(testing::HasSubstr("they go in a circle")));
}

TEST(Urdf, SwayIsAboutWhereJointsStandWithinTheirLimits) {
  MachineOptions o;
  o.sway = 0.3;
  const MachineOptions free = o;
  o.held = true;
  EXPECT_EQ(machine(arm("lower='-2' upper='2'"), o).axes[1].swing, 0.3);
  const Axis tight = machine(arm("lower='-0.1' upper='2'"), o).axes[1], narrow = machine(arm("lower='-0.1' upper='0.3'"), o).axes[1];
  EXPECT_LT(machine(arm("lower='0' upper='2'"), free).axes[1].stands, 0.1) << "one that stands on the floor would fall";
  EXPECT_NEAR(tight.stands, -0.1 + 0.3 / 0.8, 1e-15) << "where there is room to swing";
  EXPECT_NEAR(tight.swing, 0.3, 1e-15);
  EXPECT_NEAR(narrow.stands, 0.1, 1e-15);
  EXPECT_NEAR(narrow.swing, 0.8 * 0.2, 1e-15);
  MachineOptions asked = o;
  asked.stands = {{"elbow", 0}};
  EXPECT_NEAR(machine(arm("lower='-0.1' upper='2'"), asked).axes[1].swing, 0.8 * 0.1, 1e-15);
  EXPECT_EQ(machine(arm()).axes[1].swing, 0) << "nobody asked for it";
  const std::string limits = "<limit lower='0' upper='0.4'/>", body = kBall + inertial(1, "0 0 0", 0.1);
  o.stands = {{"left", 0.2}};
  const Machine m =
      machine(link("hand", body) + link("l", body) + link("k", body) + joint("left", "prismatic", "hand", "l", "<axis xyz='0 1 0'/>" + limits) +
                  joint("knuckle", "revolute", "hand", "k", "<mimic joint='left' multiplier='-2'/><limit lower='-1' upper='1'/>"),
              o);
  EXPECT_NEAR(m.axes[0].swing, 0.03, 1e-15) << "slides: 0.1 m for a radian";
  EXPECT_EQ(m.axes[1].swing, 0) << "what mimics swings along";
  EXPECT_NE(write_scene(m, {}, "r.yaml", "").find("sine: {travel: 30 mm, frequency: 1}"), std::string::npos);
}

// A table on four legs of two hinges each, knees bent backwards; names say where they are.
std::string table_on_legs(const std::string& axis = "0 1 0", double rear = -0.3) {
  std::string out = link("body", kBall + inertial(5, "0 0 0", 0.1));
  for (const char* at : {"fl", "fr", "rl", "rr"}) {
    const std::string n = at, x = text(n[0] == 'f' ? 0.3 : rear), y = n[1] == 'l' ? "0.2" : "-0.2",
                      limit = "<axis xyz='" + axis + "'/><limit effort='9' velocity='5'";
    out += link(n + "_thigh", kBall + inertial(1, "0 0 0", 0.01)) +
           link(n + "_shank",
                "<collision><origin xyz='0 0 -0.2'/><geometry><sphere radius='0.02'/></geometry></collision>" + inertial(1, "0 0 0", 0.01));
    out += joint(n + "_hip", "revolute", "body", n + "_thigh", "<origin xyz='" + x + " " + y + " 0'/>" + limit + " lower='-2' upper='2'/>");
    out += joint(n + "_knee", "revolute", n + "_thigh", n + "_shank", "<origin xyz='0 0 -0.2'/>" + limit + " lower='-2' upper='-1'/>");
  }
  return out;
}

TEST(Urdf, FourLegsStepInTurn) {
  Machine m = machine(table_on_legs());
  GaitOptions o;
  o.stride = 0.08;
  const auto phases = [&](const char* type) {
    o.type = type;
    walk(m, o);
    std::string out;
    for (const Axis& a : m.axes) {
      EXPECT_TRUE(a.step) << a.name;
      if (a.name.find("hip") == std::string::npos) continue;
      EXPECT_EQ(&m.axes[a.step->upper], &a);
      EXPECT_EQ(m.axes[a.step->lower].name, a.name.substr(0, 3) + "knee");
      out += a.name.substr(0, 2) + " " + text(a.step->phase) + " ";
    }
    return out;
  };
  EXPECT_EQ(phases("pace"), "fl 0 fr 0.5 rl 0 rr 0.5 ");
  EXPECT_EQ(phases("bound"), "fl 0 fr 0 rl 0.5 rr 0.5 ");
  EXPECT_EQ(phases("walk"), "fl 0.75 fr 0.25 rl 0 rr 0.5 ");
  EXPECT_EQ(m.gait->duty, 0.8);
  EXPECT_EQ(phases("trot"), "fl 0 fr 0.5 rl 0.5 rr 0 ");
  const double h = m.axes[0].place[2] - m.axes[0].step->foot[2];
  EXPECT_NEAR(h, 0.4 * std::cos(0.5 * 1.035) + 0.02, 1e-3) << "two links of 0.2 m, bent a little more than the limit asks, and the ball they end in";
  EXPECT_NEAR(m.gait->period, 3 * std::sqrt(h / 9.81), 0.005);
  EXPECT_EQ(m.gait->stride, 0.08);
  EXPECT_NEAR(m.gait->clearance, 0.22 * h, 5e-4);
  const std::string scene = write_scene(m, {}, "r.yaml", "");
  EXPECT_NE(scene.find("gait: {<<: &steps {period: "), std::string::npos) << scene;
  EXPECT_NE(scene.find("gait: {<<: *steps, upper: rr_hip, lower: rr_knee, foot: ["), std::string::npos) << scene;
  const auto refusal_of = [&](const std::string& robot) {
    try {
      Machine other = machine(robot);
      walk(other, o);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), Exit::usage);
      return std::string(e.what());
    }
    return std::string("nothing");
  };
  EXPECT_NE(refusal_of(arm()).find("legs, and four are needed"), std::string::npos);
  EXPECT_NE(refusal_of(table_on_legs("1 0 0")).find("has 0 legs"), std::string::npos);
  EXPECT_NE(refusal_of(table_on_legs("0 1 0", 0.3)).find("not two before two"), std::string::npos);
}

TEST(Urdf, SoftLinksArePadsBondedToTheirBody) {
  MachineOptions o;
  o.soft = {"toe"};
  const std::string leg = arm() + link("toe", inertial(0.5, "0 0 0", 1e-5) + kBall) + joint("f", "fixed", "Lower", "toe", "<origin xyz='0.5 0 0'/>");
  const Machine m = machine(leg, o);
  ASSERT_EQ(m.pads.size(), 1u);
  EXPECT_EQ(m.pads[0].body, 2u);
  EXPECT_EQ(m.bodies[2].shapes.size(), 1u) << "its ball is no part of the link";
  EXPECT_NEAR(m.bodies[2].inertial.mass, 1, 1e-15);
  EXPECT_NEAR(m.pads[0].density * volume(m.pads[0].shape), 0.5, 1e-12);
  const std::string text = write_scene(m, passing_pairs(m, 2), "x.yaml", "test");
  EXPECT_NE(text.find("toe:\n    type: soft"), std::string::npos);
  EXPECT_NE(text.find("- {body: toe, to: lower, where: {sphere:"), std::string::npos) << text;
  o.soft = {"upper"};
  EXPECT_NE(refusal(leg, o).find("has joint 'shoulder'"), std::string::npos);
}

TEST(Urdf, WhatIsLeftOutIsToldOnceWithItsPlace) {
  Notes notes;
  robot("<link name='a' colour='red'>\n  <inertial><mass value='1' unit='kg'/></inertial></link>\n<transmission/>\n<transmission/><joints/>", &notes);
  const std::vector<std::string> lines = notes.lines();
  ASSERT_EQ(lines.size(), 4u);
  EXPECT_EQ(lines[0], "r.urdf:2:1: warning: attribute 'colour' of <link> is none of URDF's, and not imported");
  EXPECT_EQ(lines[1], "r.urdf:3:13: warning: attribute 'unit' of <mass> is none of URDF's, and not imported");
  EXPECT_EQ(lines[2], "r.urdf:4:1: warning: <transmission> in <robot> is not imported (and 1 more)");
  EXPECT_EQ(lines[3], "r.urdf:5:16: warning: <joints> in <robot> is none of URDF's, and not imported; did you mean 'joint'?");
}

TEST(Urdf, LimitsThatSayNothingOrSeemToBeDegreesAreTold) {
  const auto notes_of = [](const std::string& limit) {
    Notes notes;
    robot(link("a") + link("b") + joint("j", "revolute", "a", "b", "<limit lower='-1' " + limit + "/>"), &notes);
    return notes;
  };
  EXPECT_TRUE(told(notes_of("upper='90'"), "limits of more than a turn: angles of URDF are radians"));
  EXPECT_TRUE(notes_of("upper='6.2832' effort='1'").lines().empty());
  EXPECT_TRUE(told(notes_of("upper='1' effort='0'"), "a limit of 'effort' 0 is none"));
}

TEST(Urdf, RefusalsNameTheLine) {
  EXPECT_EQ(refusal("<link name='a'/>\n<link name='a'/>"), "r.urdf:3:1: error: a second link 'a'; the first is in line 2");
  EXPECT_NE(refusal(link("a") + link("b")).find("hangs on no other"), std::string::npos);
  EXPECT_NE(refusal(link("a") + link("foot") + joint("j", "fixed", "a", "foots", "")).find("there is no link 'foots'; did you mean 'foot'?"),
            std::string::npos);
  EXPECT_NE(refusal(link("a") + link("b") + joint("j", "planar", "a", "b", "")).find("'planar'"), std::string::npos);
  EXPECT_NE(refusal(link("a") + link("b") + joint("j", "revolute", "a", "b", "")).find("needs a <limit>"), std::string::npos);
  EXPECT_NE(refusal(link("a") + link("b") + joint("j", "continuous", "a", "b", "<dynamics damping='-1'/>")).find("'damping' is less than 0"),
            std::string::npos);
  EXPECT_NE(refusal(link("a") + link("b") + link("c") + joint("i", "fixed", "b", "c", "") + joint("j", "fixed", "c", "b", "")).find("in a circle"),
            std::string::npos);
  EXPECT_NE(refusal(link("a") + link("b") + joint("i", "fixed", "a", "b", "") + joint("j", "fixed", "a", "b", "")).find("second parent"),
            std::string::npos);
  EXPECT_NE(refusal("<link name='a'><collision><geometry><sphere radius='1..2'/></geometry></collision></link>").find("not made of numbers"),
            std::string::npos);
  EXPECT_NE(refusal("<link name='a'><collision><geometry><sphere radius='nan'/></geometry></collision></link>").find("not made of numbers"),
            std::string::npos);
  EXPECT_NE(refusal("<link name='a'").find("r.urdf:"), std::string::npos);
  EXPECT_NE(refusal("<xacro:macro/>").find("expand it first"), std::string::npos);
}

class Folder : public testing::Test {
 protected:
  void SetUp() override {
    path_ = std::filesystem::temp_directory_path() / ("mortise_urdf_" + std::to_string(::getpid()));
    std::filesystem::create_directories(path_ / "thing_description/meshes");
  }
  void TearDown() override { std::filesystem::remove_all(path_); }
  std::filesystem::path path_;
};

TEST_F(Folder, MeshesAreFoundInPackagesAndOnesThatNoBodyCanHaveBecomeHulls) {
  geometry::TriMesh sound = geometry::surface_of(geometry::box({0.1, 0.2, 0.3}, 1)), open = sound;
  open.triangles.pop_back();
  const std::filesystem::path meshes = path_ / "thing_description/meshes";
  geometry::write_obj((meshes / "sound.obj").string(), sound);
  geometry::write_obj((meshes / "open.obj").string(), open);
  for (Triangle& t : sound.triangles) std::swap(t.v[0], t.v[1]);
  geometry::write_obj((meshes / "inside_out.obj").string(), sound);
  const auto collision = [](const std::string& file, const std::string& scale) {
    return "<collision><geometry><mesh filename='" + file + "'" + scale + "/></geometry></collision>";
  };
  std::filesystem::create_directories(path_ / "thing_description/urdf");
  const std::string file = (path_ / "thing_description/urdf/r.urdf").string();
  std::ofstream(file) << "<robot name='r'>"
                      << link("a", collision("package://thing_description/meshes/sound.obj", " scale='2 2 2'") + collision("../meshes/open.obj", "") +
                                       collision("../meshes/sound.obj", " scale='1 -1 1'") + collision("../meshes/inside_out.obj", "") +
                                       collision("package://thing_description/meshes/none.stl", ""))
                      << "</robot>";
  Notes notes;
  const auto read = [&] { return read_robot_text(read_regular_file(file, max_bytes::scene), file, notes); };
  Robot r = read();
  MeshOptions options;
  options.folder = (path_ / "out_meshes").string();
  try {
    find_meshes(r, options, notes);
    ADD_FAILURE() << "a mesh is missing";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("there is no mesh 'package://thing_description/meshes/none.stl'"), std::string::npos) << e.what();
  }
  r = read();
  options.skip_missing = true;
  find_meshes(r, options, notes);
  ASSERT_EQ(r.links[0].collisions.size(), 4u);
  mend_collision_meshes(r, options, notes);
  const std::vector<Shape>& s = r.links[0].collisions;
  EXPECT_EQ(s[0].file, (meshes / "sound.obj").string());
  EXPECT_EQ(s[0].scale, Vec3::Constant(2));
  for (int i : {1, 2, 3}) {
    EXPECT_EQ(s[i].file, (path_ / "out_meshes" / ("a_" + std::to_string(i) + ".obj")).string());
    EXPECT_NEAR(volume(s[i]), 0.1 * 0.2 * 0.3, 1e-12);
  }
  EXPECT_TRUE(told(notes, "is no closed surface"));
  EXPECT_TRUE(told(notes, "mirrored along single axes"));
  EXPECT_TRUE(told(notes, "inside out: its triangles are turned round"));
  EXPECT_TRUE(told(notes, "is missing and left out"));
}

}  // namespace
}  // namespace mortise::importers
