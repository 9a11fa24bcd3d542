// `robot:` of a scene: what an import writes, under what the scene says.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>
#include <yaml-cpp/yaml.h>

#include "program.h"

namespace fs = std::filesystem;

namespace mortise::cli {
namespace {

using testing::HasSubstr;

class RobotBlock : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(path_);
    fs::copy_file(kSource + "/tests/cli/arm.urdf", path_ + "/arm.urdf", fs::copy_options::overwrite_existing);
  }
  void TearDown() override { fs::remove_all(path_); }
  const std::string path_ = (fs::temp_directory_path() / ("mortise_robot_" + std::to_string(getpid()))).string();

  Result check(const std::string& scene, const std::string& more = "") {
    std::ofstream(path_ + "/scene.yaml") << scene;
    return mortise("check scene.yaml --print-resolved " + more, path_);
  }
  YAML::Node resolved(const std::string& scene, const std::string& more = "") {
    const Result r = check(scene, more);
    EXPECT_EQ(r.code, 0) << r.err;
    return YAML::Load(r.out);
  }
};

TEST_F(RobotBlock, StandsForWhatAnImportWrites) {
  ASSERT_EQ(mortise("import arm.urdf -o imported.yaml --soft tip --joint elbow='60 deg' --sway '5 deg'", path_).code, 0);
  const Result imported = mortise("check imported.yaml --print-resolved", path_);
  const Result block =
      check("mortise: 1\nrobot: {file: arm.urdf, sway: 5 deg, joints: [{joint: elbow, angle: 60 deg}], override: [{link: tip, type: soft}]}\n");
  EXPECT_EQ(block.code, 0) << block.err;
  EXPECT_EQ(block.out, imported.out);
  EXPECT_THAT(block.err, HasSubstr("arm.urdf:55:3: warning: <transmission> in <robot> is not imported\n"));
}

TEST_F(RobotBlock, WhatTheSceneSaysGoesOverIt) {
  const YAML::Node s = resolved(R"(
mortise: 1
name: mine
robot:
  file: arm.urdf
  override: [{link: 'ti*', type: soft, youngs_modulus: 0.2 MPa, poisson_ratio: 0.4, edge_length: 3 mm, color: [1, 0, 0]}, {link: upper, color: [0, 1, 0]}]
time: {steps: 7}
bodies:
  upper: {mass: 2 kg}
  ball: {type: stiff, mass: 0.1 kg, shape: {sphere: {radius: 20 mm, edge_length: 10 mm}}, position: [0.3, 0, 0.1]}
  palm: {shape: {sphere: {radius: 15 mm, edge_length: 8 mm}}}
effects:
  friction: {mu: 0.3}
  drive: [{joint: elbow, kp: 33}]
  joint: {name: wrist, axis: [0, 1, 0]}
render: {cameras: {front: {fov: 20 deg}, close: {position: [0.2, -0.4, 0.3], look_at: [0, 0, 0.2]}}}
)",
                                "--set bodies.upper.velocity.0=0.25 --set robot.clearance=0.05");
  EXPECT_EQ(s["name"].as<std::string>(), "mine");
  EXPECT_EQ(s["time"]["steps"].as<int>(), 7);
  EXPECT_EQ(s["time"]["step"].as<double>(), 5e-3) << "as imported";
  EXPECT_EQ(s["bodies"]["upper"]["mass"].as<double>(), 2);
  EXPECT_TRUE(s["bodies"]["upper"]["inertia"]) << "as imported";
  EXPECT_EQ(s["bodies"]["upper"]["visual"]["color"][1].as<double>(), 1);
  EXPECT_EQ(s["bodies"]["upper"]["velocity"][0].as<double>(), 0.25);
  EXPECT_TRUE(s["bodies"]["ball"]);
  EXPECT_TRUE(s["bodies"]["palm"]["shape"]["sphere"]);
  EXPECT_FALSE(s["bodies"]["palm"]["shape"]["box"]) << "a shape takes the place of another";
  EXPECT_EQ(s["bodies"]["tip"]["type"].as<std::string>(), "soft");
  EXPECT_EQ(s["bodies"]["tip"]["visual"]["color"][0].as<double>(), 1);
  EXPECT_EQ(s["bodies"]["tip"]["shape"].begin()->second["edge_length"].as<double>(), 3e-3);
  EXPECT_EQ(s["materials"]["rubber"]["youngs_modulus"].as<double>(), 2e5);
  EXPECT_EQ(s["materials"]["rubber"]["poisson_ratio"].as<double>(), 0.4);
  EXPECT_EQ(s["effects"]["friction"]["mu"].as<double>(), 0.3);
  EXPECT_EQ(s["effects"]["friction"]["follows"].as<std::string>(), "barrier_contact");
  std::size_t drives = 0, joints = 0;
  for (const YAML::Node& d : s["effects"]["drive"]) {
    ++drives;
    if (d["joint"].as<std::string>() != "elbow") continue;
    EXPECT_EQ(d["kp"].as<double>(), 33);
    EXPECT_EQ(d["effort"].as<double>(), 4) << "as imported";
  }
  for (const YAML::Node& j : s["effects"]["joint"]) {
    ++joints;
    if (j["name"].as<std::string>() == "wrist") {
      EXPECT_EQ(j["axis"][1].as<double>(), 1);
    }
  }
  EXPECT_EQ(joints, 5u);
  EXPECT_EQ(drives, 4u) << "one of the fingers' slides follows the other";
  EXPECT_TRUE(s["render"]["cameras"]["close"]);
  EXPECT_NEAR(s["render"]["cameras"]["front"]["fov"].as<double>(), 0.349066, 1e-6);
  EXPECT_TRUE(s["render"]["cameras"]["side"]);
  EXPECT_FALSE(s["robot"]) << "resolved";
}

TEST_F(RobotBlock, WhatIsWrongIsSaidWithItsPlace) {
  const auto says = [&](const std::string& block, int code, const std::string& what) {
    const Result r = check("mortise: 1\nrobot: " + block + "\n");
    EXPECT_EQ(r.code, code) << r.err;
    EXPECT_THAT(r.err, HasSubstr(what));
    EXPECT_EQ(r.out, "");
  };
  says("{file: arm.urd}", 3, "scene.yaml:2:15: error: robot.file: no file 'arm.urd'");
  says("{file: arm.urd}", 3, "did you mean 'arm.urdf'?");
  says("{file: arm.urdf, overide: []}", 3, "did you mean 'override'?");
  says("{file: arm.urdf, override: [{link: tp, type: soft}]}", 3,
       "scene.yaml:2:1: error: robot.override: link tp: the robot has no such link; did you mean 'tip'?");
  says("{file: arm.urdf, override: [{link: tp, color: [1, 0, 0]}]}", 3, "the robot has no such link; did you mean 'tip'?");
  says("{file: arm.urdf, override: [{link: palm, type: soft}]}", 3, "has joint 'wrist'");
  says("{file: arm.urdf, override: [{link: tip, edge_length: 1 mm}]}", 3, "only soft links have 'edge_length'");
  says("{file: arm.urdf, joints: [{joint: elbow}]}", 3, "give the joint an angle, or a travel");
  says("{file: arm.urdf, joints: [{joint: elbw, angle: 1}]}", 3, "robot.joints: elbw: no joint that moves is called so; did you mean 'elbow'?");
  says("{file: arm.urdf}\nbodies: {uper: {mass: 1 kg}}", 3, "scene.yaml:3:10: error: bodies.uper");
  std::ofstream(path_ + "/arm.urdf") << "<robot name=\"a\"><link nam=\"b\"/></robot>";
  says("{file: arm.urdf}", 3, "arm.urdf:1:");
}

TEST_F(RobotBlock, ARobotsFileIsNoScene) {
  const Result r = mortise("run arm.urdf", path_);
  EXPECT_EQ(r.code, 3);
  EXPECT_THAT(r.err, HasSubstr("a robot's file becomes a scene by 'mortise import'"));
  EXPECT_LT(r.err.size(), 500u);
}

TEST_F(RobotBlock, RunsFromItsOwnRecord) {
  std::ofstream(path_ + "/scene.yaml") << "mortise: 1\nrobot: {file: arm.urdf, sway: 10 deg}\ntime: {steps: 4, frame_every: 2}\n";
  const Result r = mortise("run scene.yaml -o out --no-render -q", path_);
  EXPECT_EQ(r.code, 0) << r.err;
  fs::remove(path_ + "/arm.urdf");
  const Result exported = mortise("export out -o arm.glb", path_);
  EXPECT_EQ(exported.code, 0) << exported.err;
  EXPECT_THAT(exported.out, HasSubstr("arm.glb: 7 bodies, 3 frames"));
}

TEST_F(RobotBlock, AnExportOfSeveralEnvironmentsAsksWhose) {
  fs::create_directories(path_ + "/out/env_0000");
  for (const char* file : {"/out/fields.vtkhdf", "/out/env_0000/fields.vtkhdf"}) std::ofstream(path_ + file) << "x";
  const Result r = mortise("export out -o a.glb", path_);
  EXPECT_EQ(r.code, 2);
  EXPECT_EQ(r.err, "error: 'out' holds several environments: say whose, for example out/env_0000\n");
}

TEST_F(RobotBlock, TenLinesMoveARealRobotOnSoftFeet) {
  const std::string go2 = std::string(MORTISE_SHARED_DATA) + "/robots/go2/go2_description.urdf";
  if (!fs::exists(go2)) GTEST_SKIP() << go2 << " is not there";
  const Result missing = check("mortise: 1\nrobot: {file: " + go2 + "}\n");
  EXPECT_EQ(missing.code, 6);
  EXPECT_THAT(
      missing.err,
      HasSubstr("\n  robot.packages: [{name: go2_description, folder: FOLDER}] says where the package is\n  robot.missing_meshes: skip goes on"));
  std::ofstream(path_ + "/scene.yaml")
      << "mortise: 1\nrobot:\n  file: " << go2
      << "\n  missing_meshes: skip\n  sway: 5 deg\n  joints: [{joint: '*_thigh_joint', angle: 0.9}, {joint: '*_calf_joint', angle: -1.8}]\n"
         "  override: [{link: '*_foot', type: soft, edge_length: 12 mm}]\n"
         "checks: [{quantity: position, body: base, axis: z, above: 0.25}]\n";
  const Result r = mortise("run scene.yaml -o out --no-render -q --set time.steps=10", path_);
  EXPECT_EQ(r.code, 0) << r.err;
}

TEST_F(RobotBlock, ARealRobotTrotsInFiveLines) {
  const std::string robot = std::string(MORTISE_SHARED_DATA) + "/robots/go2/go2_description.urdf";
  if (!fs::exists(robot)) GTEST_SKIP() << robot << " is not there";
  std::ofstream(path_ + "/scene.yaml") << "mortise: 1\nrobot:\n  file: " << robot
                                       << "\n  missing_meshes: skip\n  gait: {type: trot, stride: 80 mm, duty: 0.6}\n";
  const Result r = mortise("check scene.yaml --print-resolved", path_);
  EXPECT_EQ(r.code, 0) << r.err;
  for (const char* what : {"stride: 0.08", "duty: 0.6", "phase: 0.5", "upper: rr_thigh_joint", "lower: rr_calf_joint"})
    EXPECT_NE(r.out.find(what), std::string::npos) << what;
  std::ofstream(path_ + "/far.yaml") << "mortise: 1\nrobot:\n  file: " << robot << "\n  missing_meshes: skip\n  gait: {type: trot, stride: 800 mm}\n";
  EXPECT_NE(mortise("check far.yaml", path_).err.find("the steps are too large for the leg"), std::string::npos);
}

// Robots that nobody prepared: every file of the data that is one, from the file to pictures of it moving.
TEST_F(RobotBlock, AnyRobotMovesAndIsDrawnInEightLines) {
  const std::string folder = std::string(MORTISE_SHARED_DATA) + "/robots";
  if (!fs::exists(folder)) GTEST_SKIP() << folder << " is not there";
  const auto bytes = [&](const std::string& file) {
    std::ifstream in(path_ + "/" + file, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  int robots = 0;
  for (const fs::directory_entry& e : fs::recursive_directory_iterator(folder)) {
    if (e.path().extension() != ".urdf" && e.path().extension() != ".xml") continue;
    ++robots;
    std::ofstream(path_ + "/scene.yaml") << "mortise: 1\nrobot:\n  file: " << e.path().string()
                                         << "\n  missing_meshes: skip\n  sway: 10 deg\n  base: fixed\n"
                                            "time: {steps: 50, frame_every: 25}\nrender: {width: 320, height: 240}\n";
    const Result r = mortise("run scene.yaml -o out --overwrite -q", path_);
    EXPECT_EQ(r.code, 0) << e.path() << r.err;
    EXPECT_NE(bytes("out/frames/front_0001.png"), bytes("out/frames/front_0000.png")) << e.path();
  }
  EXPECT_GE(robots, 2);
}

}  // namespace
}  // namespace mortise::cli
