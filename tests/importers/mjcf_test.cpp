// MJCF files as they come: classes of defaults, orientations, joints of one body, meshes, masses of geoms, includes, what is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "geometry/io/obj.h"
#include "geometry/primitives.h"
#include "geometry/topology.h"
#include "importers/import.h"
#include "importers/robot/draw.h"
#include "importers/robot/fit.h"
#include "importers/robot/meshes.h"
#include "importers/robot/passing.h"
#include "importers/robot/solid.h"
#include "importers/robot/weigh.h"
#include "importers/robot/write.h"

namespace mortise::importers {
namespace {

using testing::HasSubstr;

constexpr double kDegree = M_PI / 180;

Robot robot(const std::string& inside, Notes* notes = nullptr) {
  Notes own;
  return read_robot_text("<mujoco model='m'>\n" + inside + "</mujoco>", "m.xml", notes ? *notes : own);
}
Robot world(const std::string& inside, Notes* notes = nullptr) { return robot("<worldbody>" + inside + "</worldbody>", notes); }
Machine machine(const std::string& inside, const MachineOptions& options = {}, Notes* notes = nullptr) {
  Notes own;
  Notes& n = notes ? *notes : own;
  Robot r = robot(inside, &n);
  weigh(r);
  return assemble(r, options, n);
}
std::string refusal(const std::string& inside) {
  try {
    machine(inside);
  } catch (const Error& e) {
    return e.what();
  }
  return "nothing";
}
std::string all(const Notes& notes) {
  std::string out;
  for (const std::string& line : notes.lines()) out += line + "\n";
  return out;
}
const std::string kBall = "<geom size='0.05'/>";

TEST(Mjcf, OrientationsAreSaidInFiveWays) {
  const auto turn = [](const std::string& how, const std::string& compiler = "") {
    return robot(compiler + "<worldbody><body name='b' " + how + ">" + kBall + "</body></worldbody>").joints[0].origin.R;
  };
  const auto about = [](double degrees, int axis) { return Eigen::AngleAxisd(degrees * kDegree, Vec3::Unit(axis)).toRotationMatrix(); };
  const Mat3 z30 = about(30, 2);
  const double c = std::cos(15 * kDegree), s = std::sin(15 * kDegree);
  EXPECT_LT((turn("quat='" + std::to_string(2 * c) + " 0 0 " + std::to_string(2 * s) + "'") - z30).norm(), 1e-6) << "normalised";
  EXPECT_LT((turn("axisangle='0 0 2 30'") - z30).norm(), 1e-15) << "degrees, if nothing is said";
  EXPECT_LT((turn("axisangle='0 0 2 0.5235987755982988'", "<compiler angle='radian'/>") - z30).norm(), 1e-15);
  EXPECT_LT((turn("xyaxes='1 1 0 0 3 0'") - about(45, 2)).norm(), 1e-15) << "y is made square to x";
  EXPECT_LT((turn("zaxis='1 0 0'") - about(90, 1)).norm(), 1e-15);
  EXPECT_LT((turn("euler='10 20 30'") - about(10, 0) * about(20, 1) * about(30, 2)).norm(), 1e-15) << "axes that turn along";
  EXPECT_LT((turn("euler='10 20 30'", "<compiler eulerseq='XYZ'/>") - about(30, 2) * about(20, 1) * about(10, 0)).norm(), 1e-15) << "axes that stay";
  EXPECT_LT((turn("euler='10 20 30'", "<compiler eulerseq='zYx'/>") - about(20, 1) * about(10, 2) * about(30, 0)).norm(), 1e-15);
  EXPECT_THAT(refusal("<worldbody><body euler='0 0 1' quat='1 0 0 0'/></worldbody>"), HasSubstr("is turned by 'quat' and by 'euler'"));
}

TEST(Mjcf, ClassesOfDefaultsGiveWhatElementsDoNotSay) {
  const Robot r = robot(R"(
<default>
  <geom density='500'/>
  <joint damping='0.1'/>
  <default class='leg'>
    <geom type='capsule' size='0.02 0.1' rgba='1 0 0 1'/>
    <joint axis='0 1 0' range='-40 60'/>
    <default class='shin'><geom size='0.01 0.1'/></default>
  </default>
</default>
<worldbody>
  <body name='trunk'><freejoint/><geom type='box' size='0.1 0.2 0.3'/>
    <body name='thigh' childclass='leg'><joint name='knee'/><geom/>
      <body name='calf'><joint name='ankle' damping='0.7' range='0 0'/><geom class='shin' size='0.015 0.2'/></body>
      <body name='ball'><joint class='main'/><geom class='main' size='0.03'/></body>
    </body>
  </body>
</worldbody>)");
  ASSERT_EQ(r.links.size(), 5u);
  const Shape &trunk = r.links[1].collisions[0], &thigh = r.links[2].collisions[0], &calf = r.links[3].collisions[0],
              &ball = r.links[4].collisions[0];
  EXPECT_EQ(trunk.size, Vec3(0.2, 0.4, 0.6)) << "sizes are halves";
  EXPECT_EQ(thigh.kind, Shape::Kind::capsule);
  EXPECT_EQ(thigh.length, 0.2);
  EXPECT_EQ(thigh.colour, Vec3(1, 0, 0));
  EXPECT_EQ(thigh.density, 500) << "from the outermost class";
  EXPECT_EQ(calf.kind, Shape::Kind::capsule) << "a class has what the one around it has";
  EXPECT_EQ(calf.radius, 0.015) << "its own comes first";
  EXPECT_EQ(ball.kind, Shape::Kind::sphere) << "a class of its own goes before that of the body";
  const Joint &knee = r.joints[1], &ankle = r.joints[2], &plain = r.joints[3];
  EXPECT_EQ(r.joints[0].type, Joint::Type::floating);
  EXPECT_LT((knee.axis - Vec3::UnitY()).norm(), 1e-15);
  EXPECT_NEAR(knee.limits->first, -40 * kDegree, 1e-15);
  EXPECT_NEAR(knee.limits->second, 60 * kDegree, 1e-15);
  EXPECT_EQ(knee.damping, 0.1);
  EXPECT_EQ(ankle.damping, 0.7);
  EXPECT_FALSE(ankle.limits) << "a range of nothing is none";
  EXPECT_LT((plain.axis - Vec3::UnitZ()).norm(), 1e-15);
  EXPECT_FALSE(plain.limits);
}

// A pendulum whose hinge is away from its body's origin, and which the file shows at 30 deg.
TEST(Mjcf, HingesTurnAboutTheirPlaceFromWhereTheFileShowsThem) {
  MachineOptions o;
  o.stands = {{"h", 90 * kDegree}};
  const std::string text =
      "<worldbody><body name='p' pos='1 0 0'><joint name='h' pos='0 0 0.5' axis='0 1 0' ref='30' range='-180 180'/>" + kBall + "</body></worldbody>";
  const Machine m = machine(text, o);
  const double turned = 60 * kDegree;
  EXPECT_EQ(m.axes[0].to, -1) << "the world";
  EXPECT_LT((m.axes[0].place.head<2>() - Vec2(1, 0)).norm(), 1e-15) << "which stays where it is";
  EXPECT_LT((m.bodies[0].at.R - Eigen::AngleAxisd(turned, Vec3::UnitY()).toRotationMatrix()).norm(), 1e-15);
  EXPECT_LT((m.bodies[0].at.t - m.axes[0].place - Vec3(-0.5 * std::sin(turned), 0, -0.5 * std::cos(turned))).norm(), 1e-15);
  EXPECT_NEAR(machine(text).axes[0].stands, 30 * kDegree, 1e-15) << "if nobody asks for another place";
}

TEST(Mjcf, SeveralJointsOfABodyAreAChainInTheirOrder) {
  MachineOptions o;
  o.stands = {{"yaw", 0.3}, {"pitch", -0.5}};
  Notes notes;
  const Machine m = machine("<worldbody><body name='base' pos='0 0 1'>" + kBall +
                                "<body name='head' pos='0.1 0 0.2'><joint name='yaw' axis='0 0 1'/><joint name='pitch' axis='0 1 0'/><geom "
                                "size='0.02'/></body></body></worldbody>",
                            o, &notes);
  ASSERT_EQ(m.bodies.size(), 3u);
  EXPECT_TRUE(m.bodies[0].held) << "a body of the world without joint";
  EXPECT_TRUE(m.bodies[1].bearing);
  EXPECT_EQ(m.bodies[1].name, "head_yaw");
  EXPECT_EQ(m.axes[0].name, "yaw");
  EXPECT_EQ(m.axes[0].to, 0);
  EXPECT_EQ(m.axes[1].to, 1);
  const Mat3 yaw = Eigen::AngleAxisd(0.3, Vec3::UnitZ()).toRotationMatrix(), pitch = Eigen::AngleAxisd(-0.5, Vec3::UnitY()).toRotationMatrix();
  EXPECT_LT((m.bodies[2].at.R - yaw * pitch).norm(), 1e-15);
  EXPECT_LT((m.axes[1].direction - yaw * Vec3::UnitY()).norm(), 1e-15);
  EXPECT_THAT(all(notes), HasSubstr("m.xml:2:61: warning: a body with several joints: bearings of 1 g lie between them"));
}

TEST(Mjcf, SixJointsThatLetABodyGoAnywhereMakeItFree) {
  const std::string slides = "<joint name='x' type='slide' axis='1 0 0'/><joint type='slide' axis='0 1 0'/><joint type='slide' axis='0 0 1'/>";
  const std::string hinges = "<joint axis='1 0 0'/><joint axis='0 1 0'/>";
  MachineOptions held;
  held.held = true;
  const auto hand = [&](const std::string& joints, const MachineOptions& o) {
    return machine("<worldbody><body name='hand'>" + joints + kBall + "</body></worldbody>", o);
  };
  for (const std::string& last : {std::string("<joint axis='0 0 1'/>")}) {
    const Machine m = hand(slides + hinges + last, {});
    EXPECT_EQ(m.bodies.size(), 1u);
    EXPECT_TRUE(m.axes.empty());
    EXPECT_FALSE(m.bodies[0].held);
    EXPECT_TRUE(hand(slides + hinges + last, held).bodies[0].held);
  }
  EXPECT_EQ(hand(slides + "<joint type='ball'/>", {}).bodies.size(), 1u);
  EXPECT_EQ(hand(slides + hinges + "<joint axis='1 1 0'/>", {}).bodies.size(), 6u) << "three axes in a plane leave a turn out";
  EXPECT_THAT(refusal("<worldbody><body><freejoint/><joint/></body></worldbody>"), HasSubstr("a body that moves freely can have no other joint"));
  EXPECT_THAT(refusal("<worldbody><body name='a'><body name='b'><freejoint/></body></body></worldbody>"),
              HasSubstr("only a body of the world can move freely"));
}

TEST(Mjcf, FramesArePlacesAndBallsSphericalJoints) {
  const Machine m = machine(
      "<worldbody><frame pos='0 0 2' euler='0 0 90'><body name='a' pos='1 0 0'><freejoint/>" + kBall +
      "<frame pos='0 0 -0.5'><body name='b'><joint name='s' type='ball' pos='0 0 0.1'/><geom pos='0 0 -0.3' size='0.05'/></body></frame></body>"
      "</frame></worldbody>");
  ASSERT_EQ(m.axes.size(), 1u);
  EXPECT_EQ(m.axes[0].type, Joint::Type::spherical);
  EXPECT_LT((m.bodies[1].at.t - m.bodies[0].at.t - Vec3(0, 0, -0.5)).norm(), 1e-15);
  EXPECT_LT((m.bodies[0].at.t.head<2>() - Vec2(0, 1)).norm(), 1e-15);
  EXPECT_LT((m.axes[0].place - m.bodies[1].at.t - Vec3(0, 0, 0.1)).norm(), 1e-15);
  const std::string text = write_scene(m, {}, "m.yaml", "");
  EXPECT_THAT(text, HasSubstr("name: s, type: spherical, body: b, to: a, at: "));
  EXPECT_EQ(text.find("drive:"), std::string::npos) << "ball joints have no motors";
}

TEST(Mjcf, GeomsReachFromOnePointToAnother) {
  const auto geom = [](const std::string& more) { return world("<body name='b'><freejoint/><geom " + more + "/></body>").links[1].collisions[0]; };
  const Shape rod = geom("type='capsule' size='0.1' fromto='1 2 3  1 2 7' pos='9 9 9' euler='1 2 3'"),
              bar = geom("type='box' size='0.1' fromto='0 0 0 3 0 4'");
  EXPECT_EQ(rod.radius, 0.1);
  EXPECT_NEAR(rod.length, 4, 1e-15);
  EXPECT_LT((rod.at.t - Vec3(1, 2, 5)).norm(), 1e-14) << "the points say where it is";
  EXPECT_LT((rod.at.R.col(2) - Vec3::UnitZ()).norm(), 1e-14);
  EXPECT_LT((bar.size - Vec3(0.2, 0.2, 5)).norm(), 1e-15);
  EXPECT_LT((bar.at.R.col(2) - Vec3(0.6, 0, 0.8)).norm(), 1e-15);
}

// Against the integrals over fine meshes, which converge to them.
TEST(Mjcf, ShapesWeighWhatTheirIntegralsSay) {
  for (const char* geom : {"type='box' size='0.1 0.2 0.3'", "size='0.2'", "type='cylinder' size='0.1 0.3'", "type='capsule' size='0.1 0.3'",
                           "type='ellipsoid' size='0.1 0.2 0.3'"}) {
    Robot r = world("<body name='b'><freejoint/><geom density='700' pos='0.3 -0.2 0.1' euler='20 30 40' " + std::string(geom) + "/></body>");
    weigh(r);
    const Shape& s = r.links[1].collisions[0];
    const Inertial& in = *r.links[1].inertial;
    geometry::TriMesh mesh;
    const double h = 0.012;
    if (s.kind == Shape::Kind::box) mesh = geometry::surface_of(geometry::box(s.size, h));
    if (s.kind == Shape::Kind::sphere) mesh = geometry::surface_of(geometry::sphere(s.radius, h));
    if (s.kind == Shape::Kind::cylinder) mesh = geometry::surface_of(geometry::cylinder(s.radius, s.length, h));
    if (s.kind == Shape::Kind::capsule) mesh = geometry::surface_of(geometry::capsule(s.radius, s.length, h));
    if (s.kind == Shape::Kind::ellipsoid) {
      mesh = geometry::surface_of(geometry::sphere(0.5, 0.05));
      for (Vec3& x : mesh.points) x = x.cwiseProduct(s.size);
    }
    for (Vec3& x : mesh.points) x = s.at(x);
    const geometry::MassProperties fine = geometry::mass_properties(mesh);
    EXPECT_NEAR(in.mass, 700 * fine.volume, 0.01 * in.mass) << geom;
    EXPECT_LT((in.centre - fine.centroid).norm(), 1e-9) << geom;
    EXPECT_LT((in.tensor / in.mass - fine.inertia(1) / fine.volume).norm(), 0.01 * in.tensor.norm() / in.mass) << geom;
  }
}

TEST(Mjcf, WhatABodyWeighsIsSaidOrThatOfItsGeoms) {
  const std::string said = "<inertial pos='0 0 1' mass='3' fullinertia='1 2 2.5 0.1 0.2 0.3'/>",
                    geoms = "<geom size='0.1' mass='5'/><geom size='0.1' mass='1' group='4'/>";
  const auto body = [&](const std::string& compiler, const std::string& more) {
    Robot r = robot(compiler + "<worldbody><body name='b'><freejoint/>" + more + geoms + "</body></worldbody>");
    weigh(r);
    return r.links[1].inertial;
  };
  const auto in = body("", said);
  EXPECT_EQ(in->mass, 3);
  Mat3 I;
  I << 1, 0.1, 0.2, 0.1, 2, 0.3, 0.2, 0.3, 2.5;
  EXPECT_LT((in->tensor - I).norm(), 1e-15);
  EXPECT_EQ(body("", "")->mass, 6);
  EXPECT_EQ(body("<compiler inertiafromgeom='true'/>", said)->mass, 6);
  EXPECT_EQ(body("<compiler inertiagrouprange='0 3'/>", "")->mass, 5);
  EXPECT_FALSE(body("<compiler inertiafromgeom='false'/>", ""));
}

TEST(Mjcf, GeomsThatTouchNothingAreOnlySeenAndExcludesPassThrough) {
  const Machine m = machine(R"(
<contact><exclude body1='a' body2='c'/></contact>
<worldbody>
  <geom type='plane' size='1 1 1'/>
  <body name='a'><freejoint/><geom size='0.1'/><geom size='0.2' contype='0' conaffinity='0' rgba='0 1 0 1'/></body>
  <body name='b' pos='1 0 0'><freejoint/><geom size='0.1' contype='2' conaffinity='2'/></body>
  <body name='c' pos='2 0 0'><freejoint/><geom size='0.1' contype='1' conaffinity='2'/></body>
</worldbody>)");
  ASSERT_EQ(m.bodies.size(), 3u);
  EXPECT_EQ(m.bodies[0].shapes.size(), 1u);
  EXPECT_EQ(m.bodies[0].visuals.size(), 1u);
  EXPECT_EQ(m.bodies[0].colour, Vec3(0, 1, 0));
  const auto pairs = passing_pairs(m, 2);
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_EQ(pairs[0].b, 1u) << "no bit of one meets the other's";
  EXPECT_EQ(pairs[1].b, 2u) << "excluded";
  for (const PassingPair& p : pairs) EXPECT_EQ(p.why, PassingPair::Why::said);
}

TEST(Mjcf, ActuatorsSayWhatMotorsCanDo) {
  const std::string bodies = [] {
    std::string out = "<worldbody><body name='base'>" + kBall;
    for (const char* j : {"p", "g", "m", "t", "free"})
      out += "<body name='b" + std::string(j) + "' pos='1 0 0'><joint name='" + j + "' damping='0.2' range='-1 1'/>" + kBall + "</body>";
    return out + "</body></worldbody>";
  }();
  Notes notes;
  const Robot r = robot("<default><general forcerange='-30 40'/><default class='servo'><position kp='50' kv='3'/></default></default>" + bodies + R"(
<tendon><fixed name='both'><joint joint='t' coef='1'/></fixed></tendon>
<actuator>
  <position class='servo' joint='p' gear='2'/>
  <general joint='g' biastype='affine' gainprm='80' biasprm='0 -80 -4' forcerange='-5 5'/>
  <motor joint='m' ctrlrange='-2 1' gear='10' forcerange='0 0'/>
  <position tendon='both'/>
</actuator>)",
                        &notes);
  EXPECT_EQ(r.joints[1].kp, 200) << "both the force and the angle go through the gear";
  EXPECT_EQ(r.joints[1].kd, 12);
  EXPECT_EQ(r.joints[1].effort, 80);
  EXPECT_EQ(r.joints[2].kp, 80);
  EXPECT_EQ(r.joints[2].kd, 4);
  EXPECT_EQ(r.joints[2].effort, 5);
  EXPECT_EQ(r.joints[3].kp, 0) << "a motor has no gains";
  EXPECT_EQ(r.joints[3].effort, 20);
  EXPECT_FALSE(r.joints[4].passive);
  EXPECT_TRUE(r.joints[5].passive) << "no actuator drives it";
  EXPECT_THAT(all(notes), HasSubstr("joints that a tendon pulls have motors of their own"));
  EXPECT_FALSE(robot(bodies).joints[5].passive) << "of a robot without any actuator every joint is held";
  const std::string text = write_scene(assemble(r, {}, notes), {}, "m.yaml", "");
  EXPECT_THAT(text, HasSubstr("{joint: p, mode: pd, kp: 200, kd: 12, effort: 80, damping: 0.2, angle: 0 deg}"));
  EXPECT_THAT(text, HasSubstr("{joint: free, mode: passive, damping: 0.2}"));
}

// A scene's motors go where they are told to: what holds a speed is a damper where none is asked for.
TEST(Mjcf, MotorsThatHoldASpeedAreDampers) {
  const std::string bodies = [] {
    std::string out = "<worldbody><body name='base'>" + kBall;
    for (const char* j : {"v", "g", "i", "d", "m"})
      out += "<body name='b" + std::string(j) + "' pos='1 0 0'><joint name='" + j + "' damping='0.2'/>" + kBall + "</body>";
    return out + "</body></worldbody>";
  }();
  Notes notes;
  const Robot r = robot(bodies + R"(
<actuator>
  <velocity joint='v' kv='3' gear='2' forcerange='-1 1'/>
  <general joint='g' biastype='affine' gainprm='5' biasprm='0 0 -5'/>
  <intvelocity joint='i' kp='100' kv='2' actrange='-1 1'/>
  <damper joint='d' kv='1' ctrlrange='0 1'/>
  <motor joint='m' ctrlrange='-1 1'/>
</actuator>)",
                        &notes);
  const std::string text = write_scene(assemble(r, {}, notes), {}, "m.yaml", "");
  EXPECT_THAT(text, HasSubstr("{joint: v, mode: passive, damping: 12.2}"));
  EXPECT_THAT(text, HasSubstr("{joint: g, mode: passive, damping: 5.2}"));
  EXPECT_THAT(text, HasSubstr("{joint: i, mode: pd, kp: 100, kd: 2, damping: 0.2, angle: 0 deg}"));
  EXPECT_THAT(text, HasSubstr("{joint: d, mode: passive, damping: 0.2}"));
  EXPECT_THAT(text, HasSubstr("{joint: m, mode: pd, "));
  EXPECT_THAT(all(notes), HasSubstr("m.xml:4:3: warning: a motor that holds a speed has no equal: its joint is damped by its gain (kv)"));
  EXPECT_THAT(all(notes), HasSubstr("m.xml:6:3: warning: <intvelocity> becomes a position motor"));
  EXPECT_THAT(all(notes), HasSubstr("m.xml:7:3: warning: <damper> in <actuator> is not imported"));
  EXPECT_THAT(all(notes),
              HasSubstr("m.xml:8:3: warning: an actuator without gains of a position: its joint has a position motor whose gains are chosen"));
}

TEST(Mjcf, WhatResistsInABallJointIsTold) {
  Notes notes;
  world("<body name='a'>" + kBall + "<body name='b'>\n<joint type='ball' damping='0.1' armature='0.01' stiffness='0'/>" + kBall + "</body></body>",
        &notes);
  EXPECT_EQ(all(notes),
            "m.xml:3:1: warning: attribute 'damping' of a joint of type 'ball' is not imported\n"
            "m.xml:3:1: warning: attribute 'armature' of a joint of type 'ball' is not imported\n");
}

TEST(Mjcf, WhatTendonsDoBesidePullingIsTold) {
  Notes notes;
  robot("<worldbody><body name='a'><joint name='j' range='-1 1'/>" + kBall +
            "</body></worldbody>\n<tendon>\n<spatial name='s'><site site='x'/></spatial>\n<fixed name='f' stiffness='3' range='0 1'><joint joint='j' "
            "coef='1'/></fixed>\n"
            "<fixed name='g'><joint joint='j' coef='1'/></fixed>\n</tendon>\n<actuator><motor tendon='g'/></actuator>",
        &notes);
  EXPECT_THAT(all(notes), HasSubstr("m.xml:4:1: warning: <spatial> in <tendon> is not imported"));
  EXPECT_THAT(all(notes), HasSubstr("m.xml:5:1: warning: attribute 'stiffness' of <fixed> is not imported"));
  EXPECT_THAT(all(notes), HasSubstr("m.xml:5:1: warning: attribute 'range' of <fixed> is not imported"));
  EXPECT_THAT(all(notes), HasSubstr("m.xml:5:1: warning: a tendon that no actuator pulls is not imported"));
  EXPECT_THAT(all(notes), Not(HasSubstr("m.xml:6:1: warning: a tendon that no")));
}

TEST(Mjcf, AnEqualityOfJointsIsMimicry) {
  const Robot r = robot("<compiler angle='radian'/><worldbody><body name='o'>" + kBall + "<body name='a'><joint name='a' ref='0.5'/>" + kBall +
                        "</body><body name='b'><joint name='b' ref='0.1'/>" + kBall +
                        "</body></body></worldbody><equality><joint joint1='b' joint2='a' polycoef='0.2 -2 0 0 0'/></equality>");
  ASSERT_TRUE(r.joints[2].mimic);
  EXPECT_EQ(r.joints[2].mimic->leader, 1u);
  EXPECT_EQ(r.joints[2].mimic->multiplier, -2);
  EXPECT_NEAR(r.joints[2].mimic->offset, 0.1 + 0.2 + 2 * 0.5, 1e-15) << "both are counted from where the file shows them";
}

// Springs and rotors are what drives have.
TEST(Mjcf, SpringsAndRotors) {
  const std::string inside =
      "<worldbody><body name='a'>" + kBall +
      "<joint name='a' stiffness='0.5' springref='30' armature='0.01' damping='0.2'/><body name='b' pos='0 0 1'>" + kBall +
      "<joint name='b' type='slide' stiffness='40' springref='0.1'/></body></body></worldbody><actuator><position joint='a' kp='3'/></actuator>";
  const Machine m = machine(inside);
  EXPECT_EQ(m.axes[0].stiffness, 0.5);
  EXPECT_NEAR(m.axes[0].rest, 30 * kDegree, 1e-15);
  EXPECT_EQ(m.axes[0].armature, 0.01);
  const std::string text = write_scene(m, {}, "m.yaml", "");
  EXPECT_THAT(text, HasSubstr("joint: a, mode: pd, kp: 3, kd: 0.15, damping: 0.2, stiffness: 0.5, rest: 30 deg, armature: 0.01"));
  EXPECT_THAT(text, HasSubstr("joint: b, mode: passive, stiffness: 40, rest: 100 mm"));
}

// Loops stand as the file has them, whatever their limits, and are closed by a joint.
TEST(Mjcf, LoopsAreClosedByJoints) {
  const std::string inside = "<worldbody><body name='base'>" + kBall + "<body name='a' pos='1 0 0'>" + kBall +
                             "<joint name='a' axis='0 1 0' range='0 50'/><body name='b' pos='0 0 1'>" + kBall +
                             "<joint name='b' axis='0 1 0'/></body></body><body name='c' pos='2 0 0'>" + kBall +
                             "<joint name='c' axis='0 1 0'/></body><body name='d' pos='5 0 0'>" + kBall +
                             "<joint name='d' axis='0 1 0' range='10 50'/></body></body></worldbody>\n<equality><connect body1='b' body2='c' "
                             "anchor='1 0 0'/><weld name='w' body1='d'/></equality>";
  Notes notes;
  const Machine m = machine(inside, {}, &notes);
  ASSERT_EQ(m.loops.size(), 2u);
  EXPECT_EQ(m.loops[0].name, "b_c");
  EXPECT_FALSE(m.loops[0].fixed);
  const double lift = m.bodies[0].at.t[2];
  EXPECT_LT((m.loops[0].place - Vec3(2, 0, 1 + lift)).norm(), 1e-12);
  EXPECT_TRUE(m.loops[1].fixed);
  EXPECT_EQ(m.loops[1].to, -1);
  EXPECT_EQ(m.axes[0].stands, 0) << "at its limit, as in the file";
  ASSERT_TRUE(m.axes[0].limits);
  EXPECT_LT(m.axes[0].limits->first, -0.01);
  EXPECT_THAT(all(notes), HasSubstr("the limit is moved away from there"));
  EXPECT_THAT(write_scene(m, {}, "m.yaml", ""), HasSubstr("{name: b_c, type: spherical, body: b, to: c, at: [2, 0, "));
  EXPECT_THAT(write_scene(m, {}, "m.yaml", ""), HasSubstr("{name: w, type: fixed, body: d, at: "));
  MachineOptions asked;
  asked.stands = {{"a", 0.3}};
  EXPECT_THAT([&] { machine(inside, asked); }, testing::ThrowsMessage<Error>(HasSubstr("part of a loop of joints")));
  EXPECT_THAT(refusal("<worldbody><body name='a'>" + kBall + "</body></worldbody><equality><connect body1='a' body2='b' anchor='0 0 0'/></equality>"),
              HasSubstr("there is no body 'b'"));
}

TEST(Mjcf, KeyframesSayWhereJointsStand) {
  const std::string bodies = "<worldbody><body name='a' pos='0 0 9'><freejoint/>" + kBall + "<body name='b' pos='1 0 0'>" + kBall +
                             "<joint name='b' axis='0 1 0'/><body name='c' pos='1 0 0'>" + kBall +
                             "<joint name='c' axis='0 1 0' range='-20 20'/></body></body></body></worldbody>";
  const std::string home = "<key name='home' qpos='0 0 2 0.7071067811865476 0 0 0.7071067811865476 0.4 5'/>";
  const Machine m = machine(bodies + "<keyframe><key qpos='0 0 1 1 0 0 0 0.1 0.1'/>" + home + "</keyframe>");
  EXPECT_EQ(m.axes[0].stands, 0.4);
  EXPECT_LT(m.axes[1].stands, 20 * kDegree) << "within its limits";
  EXPECT_GT(m.axes[1].stands, 15 * kDegree);
  EXPECT_LT((m.bodies[0].at.R * Vec3::UnitX() - Vec3::UnitY()).norm(), 1e-12) << "the base is turned";
  MachineOptions asked;
  asked.stands = {{"b", -0.2}};
  EXPECT_EQ(machine(bodies + "<keyframe>" + home + "</keyframe>", asked).axes[0].stands, -0.2);
  EXPECT_THAT(refusal(bodies + "\n<keyframe><key qpos='1 2 3'/></keyframe>"),
              HasSubstr("m.xml:3:11: error: attribute 'qpos' of <key> has 3 numbers; the joints have 9"));
}

// A robot and a ball to play with: the robot is held.
TEST(Mjcf, HeldAreTheBasesOfRobots) {
  const std::string inside = "<worldbody><body name='toy' pos='3 0 0'><freejoint/>" + kBall + "</body><body name='left' pos='0 0 0'><freejoint/>" +
                             kBall + "<body name='arm' pos='0 0 1'>" + kBall + "<joint/></body></body><body name='right' pos='0 3 0'><freejoint/>" +
                             kBall + "<body name='hand' pos='0 0 1'>" + kBall + "<joint/></body></body></worldbody>";
  MachineOptions o;
  o.held = true;
  const Machine m = machine(inside, o);
  for (const Body& b : m.bodies) EXPECT_EQ(b.held, b.name == "left" || b.name == "right") << b.name;
  const Machine toys =
      machine("<worldbody><body name='a'><freejoint/>" + kBall + "</body><body name='b'><freejoint/>" + kBall + "</body></worldbody>", o);
  EXPECT_TRUE(toys.bodies[0].held) << "the first of what has no joints";
  EXPECT_FALSE(toys.bodies[1].held);
}

TEST(Mjcf, WhatIsLeftOutIsToldOnceWithItsPlace) {
  Notes notes;
  robot(
      "<option timestep='0.01'/>\n<worldbody>\n<body name='b' gravcomp='1'>\n<geom size='1' friction='1 1 1' colour='red'/><site/>\n<geom size='1' "
      "friction='2'/></body></worldbody>",
      &notes);
  EXPECT_EQ(all(notes),
            "m.xml:2:1: warning: <option> in <mujoco> is not imported\n"
            "m.xml:4:1: warning: attribute 'gravcomp' of <body> is not imported\n"
            "m.xml:5:1: warning: attribute 'friction' of <geom> is not imported (and 1 more)\n"
            "m.xml:5:1: warning: attribute 'colour' of <geom> is none of MJCF's, and not imported\n"
            "m.xml:5:47: warning: <site> in <body> is not imported\n");
}

TEST(Mjcf, RefusalsNameTheLine) {
  const auto says = [](const std::string& inside, const std::string& what) { EXPECT_THAT(refusal(inside), HasSubstr(what)); };
  says("<worldbody>\n<body name='a'/>\n<body name='a'/></worldbody>", "m.xml:4:1: error: a second body 'a'");
  says("<worldbody/>", "m.xml:2:1: error: there is no <body> in the world");
  says("<asset/>", "m.xml:1:1: error: there is no <worldbody>");
  says("<worldbody><body><geom class='foo' size='1'/></body></worldbody>", "there is no class of defaults 'foo'");
  says("<default><default class='foot'/></default><worldbody><body><geom class='foo' size='1'/></body></worldbody>", "did you mean 'foot'?");
  says("<worldbody><body><geom type='capsul' size='1'/></body></worldbody>", "did you mean 'capsule'?");
  says("<worldbody><body><geom type='box' size='1 1'/></body></worldbody>", "too few numbers above zero for a box");
  says("<worldbody><body><geom size='x'/></body></worldbody>", "which is not made of numbers");
  says("<worldbody><body><geom size='1' quat='0 0 0 0'/></body></worldbody>", "attribute 'quat' of <geom> is zero");
  says("<worldbody><body><geom size='1' quat='1 0 0'/></body></worldbody>", "must be 4 numbers");
  says("<worldbody><body><joint type='hing'/></body></worldbody>", "did you mean 'hinge'?");
  says("<worldbody><body><joint axis='0 0 0'/></body></worldbody>", "is zero");
  says("<worldbody><body><joint range='2 1'/></body></worldbody>", "is above the second");
  says("<compiler angle='degrees'/><worldbody/>", "did you mean 'degree'?");
  says("<compiler coordinate='global'/><worldbody/>", "global coordinates are not read");
  says("<worldbody><body><geom mesh='m'/></body></worldbody>", "there is no mesh 'm'");
  says("<worldbody><body name='arm'/></worldbody><contact><exclude body1='arm' body2='am'/></contact>", "there is no body 'am'; did you mean 'arm'?");
  says("<worldbody><body><joint name='j'/></body></worldbody><actuator><motor joint='k'/></actuator>", "there is no joint 'k'");
  says("<include file='none.xml'/><worldbody/>", "m.xml:2:1: error: ");
  says("<default><default><geom/></default></default><worldbody/>", "a <default> inside of another needs a 'class'");
  Notes notes;
  EXPECT_THROW(read_robot_text("<sdf/>", "m.sdf", notes), Error);
}

class Folder : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(path_ / "meshes"); }
  void TearDown() override { std::filesystem::remove_all(path_); }
  void write(const std::string& name, const std::string& text) { std::ofstream(path_ / name) << text; }
  Robot read(const std::string& name, Notes& notes) {
    const std::string file = (path_ / name).string();
    std::ifstream in(file);
    return read_robot_text(std::string(std::istreambuf_iterator<char>(in), {}), file, notes);
  }
  const std::filesystem::path path_ = std::filesystem::temp_directory_path() / ("mortise_mjcf_" + std::to_string(::getpid()));
};
using MjcfFolder = Folder;

// A box of 0.2, 0.4 and 1 m, written turned and off its middle: what is fitted to it is as large, where it is.
TEST_F(MjcfFolder, PrimitivesFitMeshes) {
  geometry::TriMesh box = geometry::surface_of(geometry::box(Vec3(1, 0.2, 0.4), 1));
  for (Vec3& x : box.points) x += Vec3(3, 0, 0);
  write("meshes/bar.obj", geometry::obj_text(box));
  const auto fitted = [&](const std::string& type, const std::string& compiler = "") {
    write("m.xml", "<mujoco><compiler meshdir='meshes'" + compiler + "/><asset><mesh file='bar.obj'/></asset><worldbody><body name='b'><geom type='" +
                       type + "' mesh='bar' pos='0 0 2'/></body></worldbody></mujoco>");
    Notes notes;
    Robot r = read("m.xml", notes);
    find_meshes(r, {}, notes);
    fit_primitives(r);
    EXPECT_EQ(all(notes), "");
    return r.links[1].collisions.at(0);
  };
  const Shape b = fitted("box");
  EXPECT_EQ(b.kind, Shape::Kind::box);
  EXPECT_LT((b.size - Vec3(0.2, 0.4, 1)).norm(), 1e-12);
  EXPECT_LT((b.at.t - Vec3(3, 0, 2)).norm(), 1e-12);
  EXPECT_NEAR(std::abs(b.at.R(0, 2)), 1, 1e-12) << "z is along the bar";
  EXPECT_NEAR(b.at.R.determinant(), 1, 1e-12);
  EXPECT_NEAR(fitted("sphere").radius, (0.1 + 0.2 + 0.5) / 3, 1e-12);
  const Shape c = fitted("capsule");
  EXPECT_NEAR(c.radius, 0.15, 1e-12);
  EXPECT_NEAR(c.length, 2 * (0.5 - 0.075), 1e-12);
  const Shape boxed = fitted("capsule", " fitaabb='true'");
  EXPECT_NEAR(boxed.radius, 0.2, 1e-12);
  EXPECT_NEAR(boxed.length, 2 * (0.5 - 0.2), 1e-12);
  EXPECT_NEAR(fitted("cylinder").length, 1, 1e-12);
}

// A picture on a mesh that says where it goes.
TEST_F(MjcfFolder, TexturesOfMaterials) {
  write("meshes/leaf.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n");
  write("meshes/leaf.png", "");
  write("m.xml",
        "<mujoco><compiler meshdir='meshes' texturedir='meshes'/><asset><texture name='t' type='2d' file='leaf.png'/><texture type='skybox' "
        "builtin='flat'/>"
        "<texture name='gone' type='2d' file='gone.png'/><material name='green' texture='t'/><material name='other' texture='gone'/><mesh "
        "file='leaf.obj'/>"
        "</asset><worldbody><body name='b'><geom size='0.1'/>\n<geom type='mesh' mesh='leaf' material='green' contype='0' conaffinity='0'/></body>"
        "<body name='c'><geom size='0.1' material='other'/></body></worldbody></mujoco>");
  Notes notes;
  Robot r = read("m.xml", notes);
  find_meshes(r, {}, notes);
  weigh(r);
  Machine m = assemble(r, {}, notes);
  draw_bodies(m, (path_ / "drawn").string());
  EXPECT_THAT(all(notes), HasSubstr("'meshes/gone.png', is not there"));
  ASSERT_TRUE(m.bodies[0].drawn);
  std::string mtl = m.bodies[0].drawn->file;
  mtl.replace(mtl.size() - 3, 3, "mtl");
  std::ifstream in(mtl);
  EXPECT_THAT(std::string(std::istreambuf_iterator<char>(in), {}), HasSubstr("map_Kd " + (path_ / "meshes/leaf.png").string()));
}

TEST_F(MjcfFolder, FilesAreIncludedAndErrorsNameThem) {
  write("scene.xml", "<mujoco><include file='robot.xml'/>\n<worldbody><light/><geom type='plane' size='1 1 1'/></worldbody></mujoco>");
  write("robot.xml",
        "<mujocoinclude>\n<include file='classes.xml'/><worldbody><body name='b'>\n<geom class='big'/></body></worldbody></mujocoinclude>");
  write("classes.xml", "<mujoco><default><default class='big'><geom size='3'/></default></default></mujoco>");
  Notes notes;
  const Robot r = read("scene.xml", notes);
  ASSERT_EQ(r.links.size(), 2u);
  EXPECT_EQ(r.links[1].collisions[0].radius, 3);
  EXPECT_THAT(r.links[1].where.text(), HasSubstr("robot.xml:2:"));
  EXPECT_THAT(all(notes), HasSubstr("scene.xml:2:12: warning: <light> in <worldbody> is not imported"));
  write("classes.xml", "<mujoco><default><default class='big'><geom size='x'/></default></default></mujoco>");
  try {
    read("scene.xml", notes);
    ADD_FAILURE();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), HasSubstr("classes.xml:1:39: error: attribute 'size' of <geom> is 'x'"));
  }
  write("classes.xml", "<mujoco><include file='robot.xml'/></mujoco>");
  EXPECT_THROW(read("scene.xml", notes), Error) << "a circle";
}

TEST_F(MjcfFolder, MeshesAreScaledTurnedWeighedAndDrawnTogether) {
  geometry::write_obj((path_ / "meshes/block.obj").string(), geometry::surface_of(geometry::box({0.1, 0.2, 0.3}, 1)));
  write("r.xml", R"(<mujoco><compiler meshdir='meshes' angle='radian'/>
<asset>
  <mesh file='block.obj' scale='2 2 2'/><mesh name='thin' file='block.obj' scale='1 1 0.1'/>
  <mesh name='turned' file='block.obj' refpos='0 0 0.15' refquat='0.7071067811865476 0.7071067811865476 0 0'/>
  <material name='red' rgba='1 0 0 1'/>
</asset>
<worldbody><body name='b'><freejoint/>
  <geom mesh='block' density='100'/><geom mesh='thin' mass='0' contype='0' conaffinity='0' material='red'/>
  <geom type='box' size='1 1 1' contype='0' conaffinity='0' mass='0'/>
</body><body name='t'><freejoint/><geom mesh='turned'/></body></worldbody></mujoco>)");
  Notes notes;
  Robot r = read("r.xml", notes);
  MeshOptions options;
  options.folder = (path_ / "out").string();
  find_meshes(r, options, notes);
  weigh(r);
  EXPECT_NEAR(r.links[1].inertial->mass, 100 * 8 * 0.1 * 0.2 * 0.3, 1e-12);
  mend_collision_meshes(r, options, notes);
  Machine m = assemble(r, {}, notes);
  draw_bodies(m, options.folder);
  ASSERT_TRUE(m.bodies[0].drawn);
  const geometry::ObjFile drawn = geometry::read_obj(m.bodies[0].drawn->file);
  EXPECT_EQ(drawn.materials.size(), 2u);
  EXPECT_NEAR(drawn.materials[0].base_color[0] + drawn.materials[1].base_color[0], 1 + std::pow((0.5 + 0.055) / 1.055, 2.4), 1e-6)
      << "linear red and grey";
  double thin = 0, reach = 0;
  for (std::size_t i = 0; i < 8; ++i) thin = std::max(thin, std::abs(drawn.points[i][2]));
  for (const Vec3& x : drawn.points) reach = std::max(reach, x.cwiseAbs().maxCoeff());
  EXPECT_NEAR(thin, 0.015, 1e-9);
  EXPECT_NEAR(reach, 1, 1e-9);
  // x -> R^T (x - t) with R a quarter turn about x: the middle goes to (0, -0.15, 0), and y and z change places
  const auto [lo, hi] = bounds(r.links[2].collisions[0], r.links[2].collisions[0].at);
  EXPECT_LT((lo - Vec3(-0.05, -0.3, -0.1)).norm(), 1e-12) << lo.transpose();
  EXPECT_LT((hi - Vec3(0.05, 0, 0.1)).norm(), 1e-12) << hi.transpose();
}

}  // namespace
}  // namespace mortise::importers
