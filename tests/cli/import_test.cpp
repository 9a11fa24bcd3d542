// A robot's file in, a scene out that runs as it is.
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "program.h"

namespace fs = std::filesystem;

namespace mortise::cli {
namespace {

class Import : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(path_); }
  void TearDown() override { fs::remove_all(path_); }
  const std::string path_ = (fs::temp_directory_path() / ("mortise_import_" + std::to_string(getpid()))).string();
  const std::string arm_ = quoted(kSource + "/tests/cli/arm.urdf");

  void runs(const std::string& scene, int steps) {
    const Result r = mortise("run " + scene + " -o out --no-render -q --set time.steps=" + std::to_string(steps), path_);
    EXPECT_EQ(r.code, 0) << r.err;
  }
};

TEST_F(Import, AnArmWithAGripperAndASoftTipRuns) {
  const Result r = mortise("import " + arm_ + " -o arm.yaml --soft tip --joint elbow='60 deg'", path_);
  EXPECT_EQ(r.code, 0) << r.err;
  EXPECT_NE(r.err.find("arm.urdf:55:3: warning: <transmission> in <robot> is not imported\n"), std::string::npos) << r.err;
  EXPECT_NE(r.out.find("arm.yaml: 8 bodies"), std::string::npos) << r.out;
  runs("arm.yaml", 20);
}

TEST_F(Import, AScenesFileIsReplacedOnlyWhenAsked) {
  EXPECT_EQ(mortise("import " + arm_ + " -o arm.yaml", path_).code, 0);
  const Result again = mortise("import " + arm_ + " -o arm.yaml", path_);
  EXPECT_EQ(again.code, 2);
  EXPECT_EQ(again.err, "error: 'arm.yaml' exists already; --overwrite replaces it\n");
  EXPECT_EQ(mortise("import " + arm_ + " -o arm.yaml --overwrite", path_).code, 0);
  // Nothing but scenes: not the robot's own file.
  fs::copy_file(kSource + "/tests/cli/arm.urdf", path_ + "/arm.urdf");
  const Result own = mortise("import arm.urdf -o arm.urdf --overwrite", path_);
  EXPECT_EQ(own.code, 2);
  EXPECT_EQ(own.err, "error: 'arm.urdf' is no scene: --overwrite replaces no other file\n");
  EXPECT_EQ(read_text(path_ + "/arm.urdf"), read_text(kSource + "/tests/cli/arm.urdf"));
  EXPECT_EQ(mortise("import " + arm_ + " -o - | " + quoted(kProgram) + " check - --quick", path_).code, 0);
}

TEST_F(Import, WhatIsAskedForAndIsNotThereIsOneMessage) {
  const auto says = [&](const std::string& arguments, int code, const std::string& what) {
    const Result r = mortise("import " + arm_ + " -o x.yaml " + arguments, path_);
    EXPECT_EQ(r.code, code);
    EXPECT_NE(r.err.find(what), std::string::npos) << r.err;
    EXPECT_FALSE(fs::exists(path_ + "/x.yaml"));
  };
  says("--joint elbw=1", 2, "--joint elbw: no joint that moves is called so; did you mean 'elbow'?");
  says("--joint elbow", 2, "--joint elbow: must be NAME=VALUE");
  says("--joint elbow=9", 2, "its limits are");
  says("--joint elbow=fast", 2, "'fast'");
  says("--joint elbow='50 mm'", 2, "--joint elbow: it turns, and is given an angle");
  says("--joint left='5 deg'", 2, "--joint left: it slides, and is given a length");
  says("--joint elbow='5 N'", 2, "must be an angle or a length");
  says("--joint right='5 mm'", 2, "--joint right: it mimics 'left', which says where both stand");
  says("--soft tp", 2, "--soft tp: the robot has no such link; did you mean 'tip'?");
  says("--soft palm", 2, "has joint 'wrist'");
  EXPECT_EQ(mortise("import none.urdf -o x.yaml", path_).code, 6);
}

TEST_F(Import, WhatMimicsKeepsToItsLimits) {
  std::string text = read_text(kSource + "/tests/cli/arm.urdf");
  text.replace(text.find("<mimic joint=\"left\"/>"), 21, "<mimic joint=\"left\" multiplier=\"-1\" offset=\"0.02\"/>");
  std::ofstream(path_ + "/arm.urdf") << text;
  EXPECT_EQ(mortise("import arm.urdf -o x.yaml --joint left='5 mm'", path_).code, 0);
  const Result beyond = mortise("import arm.urdf -o y.yaml --joint left='25 mm'", path_);
  EXPECT_EQ(beyond.code, 2);
  EXPECT_NE(beyond.err.find("--joint left: 'right', which mimics it, would stand at -0.005000: its limits are 0.000000 and 0.030000"),
            std::string::npos)
      << beyond.err;
}

TEST_F(Import, ARealRobotStands) {
  const std::string go2 = std::string(MORTISE_SHARED_DATA) + "/robots/go2/go2_description.urdf";
  if (!fs::exists(go2)) GTEST_SKIP() << go2 << " is not there";
  const Result missing = mortise("import " + quoted(go2) + " -o go2.yaml", path_);
  EXPECT_EQ(missing.code, 6);
  EXPECT_NE(missing.err.find("go2_description.urdf:12:9: error: there is no mesh 'package://go2_description/dae/base.dae', nor 10 more"),
            std::string::npos)
      << missing.err;
  EXPECT_EQ(mortise("import " + quoted(go2) + " -o go2.yaml --missing-meshes skip", path_).code, 0);
  const Result r = mortise("run go2.yaml -o out --no-render -q --set 'checks=[{quantity: position, body: base, axis: z, above: 0.3}]'", path_);
  EXPECT_EQ(r.code, 0) << r.err;
}

}  // namespace
}  // namespace mortise::cli
