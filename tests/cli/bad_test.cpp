// Every way to write a bad scene, and what the user then reads from `check`; bad_mesh: sound scenes with damaged meshes, and what one reads from
// `run`; bad_study: wrong studies, and what `study` says. <case>.txt holds the exit code and the expected stderr, without the folder of the sources;
// lines "# --set a.b=c" at the top of a scene become arguments. MORTISE_UPDATE_GOLDEN=1 rewrites the expectations.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <sstream>
#include <vector>

#include "program.h"

namespace mortise::cli {
namespace {

namespace fs = std::filesystem;
const std::string kScenes = kSource + "/tests/cli/bad", kMeshes = kSource + "/tests/cli/bad_mesh", kStudies = kSource + "/tests/cli/bad_study";

std::vector<std::string> cases(const std::string& folder) {
  std::vector<std::string> out;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".yaml") out.push_back(entry.path().stem());
  std::sort(out.begin(), out.end());
  return out;
}

void message_is_as_expected(const std::string& command, const std::string& folder, const std::string& name) {
  const std::string scene = name + ".yaml", golden = folder + "/" + name + ".txt";
  std::string arguments = command + " " + scene;
  std::istringstream lines(read_text(folder + "/" + scene));
  const std::string mark = "# --set ";
  for (std::string line; std::getline(lines, line) && line.rfind(mark, 0) == 0;) arguments += " --set " + quoted(line.substr(mark.size()));

  const Result r = mortise(arguments, folder);
  EXPECT_EQ(r.out, "") << "results only on stdout";
  EXPECT_NE(r.code, 0);
  std::string seen = std::to_string(r.code) + "\n" + r.err;
  for (std::size_t at; (at = seen.find(kSource + "/")) != std::string::npos;) seen.erase(at, kSource.size() + 1);
  if (std::getenv("MORTISE_UPDATE_GOLDEN")) std::ofstream(golden, std::ios::binary) << seen;
  EXPECT_EQ(seen, read_text(golden));
}

const auto kName = [](const auto& info) { return info.param; };

class Bad : public testing::TestWithParam<std::string> {};
TEST_P(Bad, MessageIsAsExpected) { message_is_as_expected("check", kScenes, GetParam()); }
INSTANTIATE_TEST_SUITE_P(Scene, Bad, testing::ValuesIn(cases(kScenes)), kName);

class BadMesh : public testing::TestWithParam<std::string> {};
TEST_P(BadMesh, MessageIsAsExpected) { message_is_as_expected("run", kMeshes, GetParam()); }
INSTANTIATE_TEST_SUITE_P(Scene, BadMesh, testing::ValuesIn(cases(kMeshes)), kName);

class BadStudy : public testing::TestWithParam<std::string> {};
TEST_P(BadStudy, MessageIsAsExpected) { message_is_as_expected("study --dry-run", kStudies, GetParam()); }
INSTANTIATE_TEST_SUITE_P(Study, BadStudy, testing::ValuesIn(cases(kStudies)), kName);

// assimp 5.2.5 crashes on this file; others may refuse it.
TEST(BadMeshes, WhatCrashesAReaderIsOneMessage) {
  const Result r = mortise("run damaged_stl.yaml --set bodies.pad.shape.mesh.file=crashing.dae", kMeshes);
  EXPECT_EQ(r.code, 3);
  EXPECT_EQ(r.out, "");
  EXPECT_NE(r.err.find("crashing.dae' cannot be read as .dae: "), std::string::npos) << r.err;
  EXPECT_EQ(std::count(r.err.begin(), r.err.end(), '\n'), 1) << r.err;
}

TEST(BadScenes, ThereAreMany) { EXPECT_GE(cases(kScenes).size(), 30u); }

}  // namespace
}  // namespace mortise::cli
